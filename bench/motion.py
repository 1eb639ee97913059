"""Compare simulated with scanned displacement of the skin, shape by shape.

The benchmark reads a folder of scans (subjects.py), fits the rig to the scanned head as to any
other, and compares displacement fields, weighted by area. A scanned field is named after one of
ARKit's shapes in any spelling, or after a pair without its side. It is compared with the simulated
displacement when the shapes of this name are at 1.

    cosine      1 = equal directions and proportions         magnitude   |simulated| / |scanned|
    residual    |simulated - scanned|^2 / |scanned|^2        blob        cosine of a smooth bump

A blob is the scanned displacement at its peak, spread over the skin by a Gaussian; it is added at
the mirrored point too if the scan moves there. A blob uses the scan but no anatomy, and the best of
several widths counts. Every shape must be better than its blob. A blob of the best magnitude has a
residual of 1 - blob^2, so a shape with a larger residual has a wrong direction or too much motion.

The rig was fitted to sixteen shapes of ICT-FaceKit, so the score of these shapes is a training
score.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from risorius import sim
from risorius.app.errors import UserError
from risorius.app.recordings.names import shape_of
from risorius.geometry.arrays import Floats64

from .report import Target, at_least, at_most, table
from .subjects import Scans, settled_positions


class MotionRow(NamedTuple):
    """Scores of one shape."""

    shape: str
    cosine: float
    magnitude: float
    residual: float
    blob: float


def measure(directory: Path) -> tuple[list[MotionRow], list[str]]:
    """Score each shape of the reference in `directory` that the head's ARKit table contains.

    Also returns the names of fields without a score: fields with an unknown name or without motion.
    Raises UserError, which names the file, if it is broken or contains no shape.
    """
    scans = Scans.read(directory)
    simulation = sim.create(scans.head)
    rows = []
    left_out = []
    for name, field in scans.fields.items():
        shapes = _shapes(name, simulation)
        if not shapes or not field.any():
            left_out.append(name)
            continue
        moved = _moved(simulation, shapes)
        rows.append(_row(name, moved, scans.field(name), simulation))
    if not rows:
        raise UserError(f"{directory}: face.npz holds none of ARKit's shapes")
    return rows, left_out


def _shapes(name: str, simulation: sim.Simulation) -> list[str]:
    """ARKit's shapes for a field's name: one, both of a pair, or none for an unknown name."""
    other_names = {"cheekraiser": "cheekSquint"}  # ICT-FaceKit has AU6 twice
    name = other_names.get(name.lower(), name)
    for spellings in ([name], [f"{name}Left", f"{name}Right"]):
        shapes = [shape_of(each) or "" for each in spellings]
        if set(shapes) <= set(simulation.controls.tables.shares):
            return shapes
    return []


def _moved(simulation: sim.Simulation, shapes: list[str]) -> Floats64:
    """Displacement by shapes at 1 [mm], (V, 3).

    A shape that is a fraction of another shape is measured from the pose of that shape.
    """
    share_of = simulation.controls.tables.share_of
    base = {share_of[each]: 1.0 for each in shapes if each in share_of}
    settling_frames = 60  # frames of 1/60 s until a pose is still
    start = (
        settled_positions(simulation, base, settling_frames) if base else simulation.rest_positions
    )
    return (
        settled_positions(simulation, {**base, **dict.fromkeys(shapes, 1.0)}, settling_frames)
        - start
    )


def _row(name: str, moved: Floats64, scanned: Floats64, simulation: sim.Simulation) -> MotionRow:
    """Score one shape by its simulated and scanned displacements, (V, 3) [mm]."""
    areas = simulation.areas[:, None]

    def product(a: Floats64, b: Floats64) -> float:
        return float((areas * a * b).sum())

    def cosine(a: Floats64) -> float:
        own = product(a, a)
        return product(a, scanned) / float(np.sqrt(own * true)) if own > 0.0 else 0.0

    true = product(scanned, scanned)
    off = moved - scanned
    return MotionRow(
        shape=name,
        cosine=cosine(moved),
        magnitude=float(np.sqrt(product(moved, moved) / true)),
        residual=product(off, off) / true,
        blob=max(cosine(blob) for blob in blobs_of(simulation.rest_positions, scanned)),
    )


def blobs_of(skin: Floats64, scanned: Floats64) -> Iterator[Floats64]:
    """Smooth bumps of each width where a scan moves skin (V, 3) farthest, shape (V, 3)."""
    size = np.linalg.norm(scanned, axis=1)
    peak = int(size.argmax())
    there = skin[peak] * (-1.0, 1.0, 1.0)
    mirrored = int(((skin - there) ** 2).sum(axis=1).argmin())
    peaks = {peak}
    if size[mirrored] >= 0.5 * size[peak]:
        peaks.add(mirrored)
    blob_widths = (6.0, 9.0, 13.0, 18.0, 25.0, 35.0, 50.0)  # [mm]
    for width in blob_widths:
        blob = np.zeros_like(scanned)
        for at in sorted(peaks):
            squared = ((skin - skin[at]) ** 2).sum(axis=1)
            blob += np.exp(-squared / (2.0 * width**2))[:, None] * scanned[at]
        yield blob


def mean_row(rows: list[MotionRow]) -> MotionRow:
    """The mean of each column."""
    return MotionRow("mean", *np.mean([row[1:] for row in rows], axis=0).tolist())


def report(rows: list[MotionRow], left_out: list[str]) -> str:
    """The text to print."""
    lines = [
        "Simulated against scanned displacement, area weighted: cosine 1 and magnitude 1 are equal",
        "fields, residual is the squared difference over the squared scan. Blob is the cosine of a",
        "smooth bump at the scanned peak; its own residual, 1 - blob^2, is the most of a shape.",
        "",
        *table(
            "shape:<20|cosine:7.3f|magnitude:9.2f|residual:8.3f|blob:6.3f", [*rows, mean_row(rows)]
        ),
    ]
    if left_out:
        lines += ["", f"left out, no skin moves or ARKit has no such shape: {', '.join(left_out)}"]
    return "\n".join(lines)


def targets(rows: list[MotionRow], _: list[str]) -> list[Target]:
    """The targets of the muscles: the mean, the worst shape, and every blob."""
    worst = min(rows, key=lambda row: row.cosine)
    below = [row for row in rows if not row.residual < 1.0 - row.blob**2]
    nearest = max(rows, key=lambda row: row.residual / (1.0 - row.blob**2))
    least_mean = 0.94  # cosine
    least_of_a_shape = 0.88  # cosine
    return [
        at_least("mean cosine", mean_row(rows).cosine, least_mean),
        at_least(f"least cosine, {worst.shape}", worst.cosine, least_of_a_shape),
        *(
            at_most(f"residual beside its blob, {row.shape}", row.residual, 1.0 - row.blob**2)
            for row in below or [nearest]
        ),
    ]
