"""How well the muscles move skin: simulated against scanned displacement, shape by shape.

Takes a folder of scans (subjects.py), fits the rig to that head as to anybody's, and compares its
fields, weighted by area. A field has the name of one of ARKit's shapes in any spelling, a pair of
them without side, and is compared with what the head's rows of that name do at 1.

    cosine      1 = same directions and proportions          magnitude   |simulated| / |scanned|
    residual    |simulated - scanned|^2 / |scanned|^2

The rig was fitted to sixteen shapes of ICT-FaceKit, so for them this is a training score.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from risorius import sim
from risorius.app.errors import UserError
from risorius.app.recordings.names import shape_of

from .report import Target, at_least, table
from .subjects import Points, Scans, settled_positions

LEAST_MEAN = 0.94  # cosine
LEAST_OF_A_SHAPE = 0.88  # cosine
SETTLE = 60  # frames of 1/60 s until a pose is still
ALSO_CALLED = {"cheekraiser": "cheekSquint"}  # ICT-FaceKit has AU6 twice


class Row(NamedTuple):
    """Scores of one shape."""

    shape: str
    cosine: float
    magnitude: float
    residual: float


def measure(directory: Path) -> tuple[list[Row], list[str]]:
    """Score every shape of the reference in `directory` that the head's ARKit table knows.

    Also the names of fields without a score: unknown ones, and those in which no skin moves.
    Raises UserError, naming the file, if it is broken or no shape is left.
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
        rows.append(_row(name, moved, scans.field(name), simulation.areas[:, None]))
    if not rows:
        raise UserError(f"{directory}: face.npz holds none of ARKit's shapes")
    return rows, left_out


def _shapes(name: str, simulation: sim.Simulation) -> list[str]:
    """The shapes of ARKit that a field's name means, both of a pair; none where it is unknown."""
    name = ALSO_CALLED.get(name.lower(), name)
    for ways in ([name], [f"{name}Left", f"{name}Right"]):
        shapes = [shape_of(each) or "" for each in ways]
        if set(shapes) <= set(simulation.controls.tables.shares):
            return shapes
    return []


def _moved(simulation: sim.Simulation, shapes: list[str]) -> Points:
    """How far shapes at 1 move the skin [mm], (V, 3), beyond what they make good of another."""
    share_of = simulation.controls.tables.share_of
    base = {share_of[each]: 1.0 for each in shapes if each in share_of}
    start = settled_positions(simulation, base, SETTLE) if base else simulation.rest_positions
    return settled_positions(simulation, {**base, **dict.fromkeys(shapes, 1.0)}, SETTLE) - start


def _row(name: str, moved: Points, scanned: Points, areas: Points) -> Row:
    """Score one shape."""

    def product(a: Points, b: Points) -> float:
        return float((areas * a * b).sum())

    own = product(moved, moved)
    true = product(scanned, scanned)
    cosine = product(moved, scanned) / np.sqrt(own * true) if own > 0.0 else 0.0
    off = moved - scanned
    return Row(name, float(cosine), float(np.sqrt(own / true)), product(off, off) / true)


def mean_row(rows: list[Row]) -> Row:
    """The mean of each column."""
    return Row("mean", *np.mean([row[1:] for row in rows], axis=0).tolist())


def report(rows: list[Row], left_out: list[str]) -> str:
    """The text to print."""
    lines = [
        "Simulated against scanned displacement, area weighted: cosine 1 and magnitude 1 are equal",
        "fields, residual is the squared difference over the squared scan.",
        "",
        *table("shape:<20|cosine:7.3f|magnitude:9.2f|residual:8.3f", [*rows, mean_row(rows)]),
    ]
    if left_out:
        lines += ["", f"left out, no skin moves or ARKit has no such shape: {', '.join(left_out)}"]
    return "\n".join(lines)


def targets(rows: list[Row], _: list[str]) -> list[Target]:
    """What the muscles are held to: the mean, and the shape that is least alike."""
    worst = min(rows, key=lambda row: row.cosine)
    return [
        at_least("mean cosine", mean_row(rows).cosine, LEAST_MEAN),
        at_least(f"least cosine, {worst.shape}", worst.cosine, LEAST_OF_A_SHAPE),
    ]
