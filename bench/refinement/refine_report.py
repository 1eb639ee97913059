"""What `risorius bench refine` prints: times of refinement beside its peers."""

from __future__ import annotations

from dataclasses import asdict
from itertools import groupby
from typing import Any

from ..report import processor, table
from .refine import Report, Row


def text(report: Report) -> str:
    """All that is printed."""
    lines = [
        f"Refinement, serial, one core of {processor()}: medians of interleaved rounds;",
        "positions in, filled render buffers out (normals, criterion, points, table, output).",
        "Compare rows of one mesh only. * is somebody else's; uniform ones make every triangle 4 "
        "or 16.",
    ]
    for mesh, rows in groupby(report.rows, key=lambda row: row.mesh):
        lines += ["", *_table(mesh, list(rows))]
    if report.starts is not None:
        lines += [
            "",
            "From numpy's import to the first refined frame: "
            f"{report.starts.first:.1f} s when kernels compile, once; then "
            f"{report.starts.later:.2f} s (best {report.starts.best_later:.2f} s).",
        ]
    lines += ["", *report.missing] if report.missing else []
    return "\n".join(lines)


def figures(report: Report) -> dict[str, Any]:
    """The same for programs."""
    return {"processor": processor(), **asdict(report)}


def _table(mesh: str, rows: list[Row]) -> list[str]:
    columns = "method:<27|out:9.0f|ms:9.4f|best:9.4f|ns/tri:7.1f"
    cells = [
        (
            row.method + (" *" if row.is_peer else ""),
            row.triangles_out,
            row.milliseconds,
            row.best_milliseconds,
            row.nanoseconds_per_triangle,
        )
        for row in rows
    ]
    return [f"{mesh}, {rows[0].triangles_in} triangles", *table(columns, cells, indent="  ")]
