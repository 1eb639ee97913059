"""What `risorius bench refine` prints: times of refinement beside its peers, and the targets."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, astuple
from itertools import groupby
from typing import Any

from .refine import Report, Row
from .report import processor, table, verdict

NANOSECONDS = {
    "20k": {10: 16.0, 50: 12.0, 100: 9.0},
    "200k": {10: 22.0, 50: 14.0, 100: 11.0},
    "1M": {10: 24.0},
}
"""Targets: at most so many ns per output triangle, by mesh and per cent of the edges split."""
FACE_MILLISECONDS = 0.06
FASTER = {"VTK adaptive, whole frame": 10.0, "trimesh Loop 1x": 60.0}
"""How much faster than each of these a frame of the face is."""
BINDING_SECONDS = 1.5  # for a million triangles
LATER_START_SECONDS = 0.5  # over numpy's import


def text(report: Report) -> str:
    """The tables and the targets."""
    lines = [
        f"Refinement, serial, one core of {processor()}: medians of interleaved rounds;",
        "positions in, filled render buffers out (normals, criterion, points, table, output).",
        "Compare rows of one mesh only. * is somebody else's; uniform ones make every triangle 4 "
        "or 16.",
    ]
    for mesh, rows in groupby(report.rows, key=lambda row: row.mesh):
        lines += ["", *_table(report, mesh, list(rows))]
    columns = "bound:<14|triangles:9d|seconds:8.3f|buffers MB:10.1f|peak MB:8.0f"
    lines += ["", *table(columns, map(astuple, report.bindings))]
    if report.starts is not None:
        lines += [
            "",
            "From numpy's import to the first refined frame: "
            f"{report.starts.first:.1f} s when kernels compile, once; then "
            f"{report.starts.later:.2f} s (best {report.starts.best_later:.2f} s).",
        ]
    lines += ["", *report.missing] if report.missing else []
    targets = list(_targets(report))
    lines += ["", "Targets, by medians:", *targets] if targets else []
    return "\n".join(lines)


def figures(report: Report) -> dict[str, Any]:
    """The same for programs."""
    return {"processor": processor(), **asdict(report)}


def _table(report: Report, mesh: str, rows: list[Row]) -> list[str]:
    columns = "method:<27|out:9.0f|ms:9.4f|best:9.4f|ns/tri:7.1f|memcpys:7.1f"
    cells = [
        (
            row.method + (" *" if row.is_peer else ""),
            row.triangles_out,
            row.milliseconds,
            row.best_milliseconds,
            row.nanoseconds_per_triangle,
            report.copies(row),
        )
        for row in rows
    ]
    return [f"{mesh}, {rows[0].triangles_in} triangles", *table(columns, cells, indent="  ")]


def _targets(report: Report) -> Iterator[str]:
    """One line for each target whose rows were measured."""
    face = report.row("face", "kahler")
    if face is not None:
        took = face.milliseconds
        yield verdict(
            took <= FACE_MILLISECONDS,
            f"face: {FACE_MILLISECONDS} ms at most; took {took:.4f}, "
            f"shortest {face.best_milliseconds:.4f}",
        )
        for peer, factor in FASTER.items():
            theirs = report.row("face", peer)
            if theirs is not None:
                faster = theirs.milliseconds / took
                at_best = theirs.best_milliseconds / face.best_milliseconds
                yield verdict(
                    faster >= factor,
                    f"face: {factor:g} x faster than {peer}; is {faster:.1f} x, "
                    f"by shortest times {at_best:.1f} x",
                )
    for mesh, limits in NANOSECONDS.items():
        for share, limit in limits.items():
            row = report.row(mesh, f"kahler {share} %")
            if row is not None:
                took = row.nanoseconds_per_triangle
                yield verdict(
                    took <= limit,
                    f"{mesh}, {share} %: {limit:g} ns per triangle at most; took {took:.1f}, "
                    f"shortest {1e6 * row.best_milliseconds / row.triangles_out:.1f}",
                )
    for bound in report.bindings:
        if bound.mesh == "1M":
            yield verdict(
                bound.seconds <= BINDING_SECONDS,
                f"1M: bound in {BINDING_SECONDS} s; took {bound.seconds:.2f} s",
            )
    if report.starts is not None:
        yield verdict(
            report.starts.later <= LATER_START_SECONDS,
            f"a later start: {LATER_START_SECONDS} s over numpy's import; "
            f"took {report.starts.later:.2f} s",
        )
