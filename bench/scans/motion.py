"""How well the muscles move skin: simulated against scanned displacement, shape by shape.

Takes a folder of scans (reading.py), fits the rig to that head as to anybody's, by its 68 landmarks
(assets/fitting), and compares the fields, weighted by area. A field has the name of one of ARKit's
shapes in any spelling, and is compared with that row of the head's controls at 1. One side of a
shape that has no sides ("cheekPuff_L") is made by the muscles of that side.

    cosine      1 = same directions and proportions          magnitude   |simulated| / |scanned|
    residual    |simulated - scanned|^2 / |scanned|^2        half        share of the motion that
                                                                         half the controls give
Two yardsticks that know the scan stand beside them, each with its best gain: a *blob*, a rigid
bump at the scanned peak (best of 7 widths), and the purely geometric muscle of Waters 1987 laid
along the first fibre of each of the shape's muscles (best of 12 cones and ranges).

The rig was fitted to sixteen shapes of ICT-FaceKit, so for them this is a training score.
Other persons in the folder are faces of other forms, moved by the same fields.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import astuple, dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius import sim
from risorius.app.recordings.names import shape_of
from risorius.sim.coordinates import FaceSpace
from risorius.sim.landmarks import Side
from risorius.sim.rig import LinearMuscle, RingMuscle

from ..report import Target, at_least, table
from ..subjects import settled_positions
from .reading import Scans, read_scans

Array = npt.NDArray[np.float64]

LEAST_MEAN, LEAST_OF_A_SHAPE, LEAST_OF_OTHERS = 0.94, 0.88, 0.92  # cosines
SETTLE = 60  # frames of 1/60 s until a pose is still
SIDE = re.compile(r"_?(l|r|left|right)$", re.IGNORECASE)  # at the end of a field's name
ALSO_CALLED = {"cheekraiser": "cheekSquint"}  # ICT-FaceKit has AU6 twice
SEAM = 10.0  # mm beside the midline over which a one-sided shape fades, where we have but one whole
BLOB_WIDTHS = (6.0, 9.0, 13.0, 18.0, 25.0, 35.0, 50.0)  # mm
CONES = (25.0, 40.0, 60.0, 85.0)  # degrees about the fibre
RANGES = (1.2, 1.5, 2.0)  # of the fibre's length, from its origin
RING, RING_SHARE = 20.0, 0.3  # mm that a sphincter reaches, share of the way to its centre


@dataclass(frozen=True)
class Row:
    """Scores of one shape on one side; NaN where something does not apply."""

    shape: str
    cosine: float
    magnitude: float
    residual: float
    half: float
    blob: float  # cosine of the best rigid blob
    waters: float  # cosine of the best geometric muscle


@dataclass(frozen=True)
class Shape:
    """A field of the reference and the controls that make the same shape."""

    name: str  # of the field
    values: dict[str, float]  # full strength
    base: dict[str, float]  # the pose from which it is measured
    cut: Side | None  # the side of a one-sided field for which there is no one-sided control


def measure(directory: str | Path) -> tuple[list[Row], list[str], dict[str, list[Row]]]:
    """Score every shape of the reference in `directory` that the head's ARKit table knows.

    Returns the scores; the names of fields that have none: unknown ones, and those in which no skin
    moves; and the scores of other persons, by name. Raises ValueError, naming the file, if it is
    broken or no shape is left.
    """
    scans = read_scans(directory)
    rows, left_out = _scores(scans)
    if not rows:
        raise ValueError(f"{directory}: face.npz holds none of ARKit's shapes")
    others = {name: _scores(person)[0] for name, person in scans.persons()}
    return rows, left_out, others


def _scores(scans: Scans) -> tuple[list[Row], list[str]]:
    """Score one person; also the names of fields without a score."""
    head = scans.head
    simulation = sim.create(head)
    ruler = _Ruler(head.vertices, head.landmarks, simulation.areas, head.rig)
    rows, left_out = [], []
    for name in scans.names:
        shape = known_shape(name, simulation)
        scanned = None if shape is None else scans.field(name)
        if shape is None or scanned is None or not scanned.any():
            left_out.append(name)
        else:
            rows.append(ruler.row(simulation, shape, scanned))
    return rows, left_out


def mean_row(rows: list[Row]) -> Row:
    """The mean of each column."""
    columns = [each.name for each in fields(Row)][1:]
    return Row("mean", *(float(np.nanmean([getattr(r, c) for r in rows])) for c in columns))


def known_shape(name: str, simulation: sim.Simulation) -> Shape | None:
    """The shape that a field's name means, None where ARKit has none of that name."""
    half = SIDE.search(name)
    stem = name[: half.start()] if half else name
    stem = ALSO_CALLED.get(stem.lower(), stem)
    row, side = shape_of(stem + (half[0] if half else "")), None
    if row is None and half:  # one half of a shape without sides
        row, side = shape_of(stem), "left" if half[1][0] in "lL" else "right"
    tables = simulation.tables
    if row is None or row not in tables.shares:
        return None
    base = {}
    if row in tables.share_of:  # it makes good what another does
        base = _controls(tables.share_of[row], side, simulation)
    values = {**base, **_controls(row, side, simulation)}
    is_whole = any(not control.endswith(("_left", "_right")) for control in values)
    return Shape(name, values, base, Side(side) if side and is_whole else None)


def _controls(row: str, side: str | None, simulation: sim.Simulation) -> dict[str, float]:
    """What a row asks of the lowest controls; those of one side alone, where `side` is given."""
    asked = np.maximum(simulation.tables.shares[row], simulation.tables.floors[row])
    asked = np.where(asked == 0.0, simulation.tables.shares[row], asked)
    values = {}
    for control, value in zip(simulation.controls, asked.tolist(), strict=True):
        sided = f"{control}_{side}"
        if value == 0.0 or (side and control.endswith(("_left", "_right")) and side not in control):
            continue
        values[sided if sided in simulation.controls else control] = value
    return {name: float(np.clip(v, *simulation.limits[name])) for name, v in values.items()}


def _posed(simulation: sim.Simulation, values: Mapping[str, float]) -> Array:
    """Displacement [mm] of the settled pose, shape (V, 3)."""
    return settled_positions(simulation, values, SETTLE) - simulation.rest_positions


class _Ruler:
    """Compares displacement fields on one head."""

    def __init__(
        self, vertices: Array, landmarks: npt.NDArray[np.int32], areas: Array, rig: dict[str, Any]
    ) -> None:
        self._space = FaceSpace.from_landmarks(vertices[landmarks])
        self._x = self._space.to_standard(vertices)
        self._landmarks = self._x[landmarks]
        self._areas = areas
        self._muscles = {muscle.name: muscle for muscle in sim.read_rig(rig).muscles}

    def row(self, simulation: sim.Simulation, shape: Shape, scanned: Array) -> Row:
        """Pose one shape, fully and by half, and score it."""
        values, base = shape.values, shape.base
        start = _posed(simulation, base) if base else np.zeros_like(scanned)
        side = self._half_of_the_face(shape.cut)
        full = side * (_posed(simulation, values) - start)
        # A pose that is not there at the start comes in by half, what is there already stays.
        half = {c: base.get(c, 0.0) + (v - base.get(c, 0.0)) / 2.0 for c, v in values.items()}
        part = side * (_posed(simulation, half) - start)
        own, true = self._product(full, full), self._product(scanned, scanned)
        return Row(
            shape.name,
            self._cosine(full, scanned),
            float(np.sqrt(own / true)),
            self._product(full - scanned, full - scanned) / true,
            self._product(part, full) / own if own > 0.0 else float("nan"),
            max(self._cosine(blob, scanned) for blob in self._blobs(scanned)),
            self._waters(values, scanned),
        )

    def _half_of_the_face(self, side: Side | None) -> Array:
        """1 on a side of the face, 0 on the other, shape (V, 1); 1 everywhere without a side."""
        if side is None:
            return np.ones((len(self._x), 1))
        share: Array = np.clip((side.sign * self._x[:, :1] / SEAM + 1.0) / 2.0, 0.0, 1.0)
        return share

    def _product(self, a: Array, b: Array) -> float:
        return float((self._areas[:, None] * a * b).sum())

    def _cosine(self, a: Array, b: Array) -> float:
        size = self._product(a, a) * self._product(b, b)
        return self._product(a, b) / float(np.sqrt(size)) if size > 0.0 else 0.0

    def _blobs(self, scanned: Array) -> Iterator[Array]:
        """Rigid bumps at the scanned peak; at its mirror image, too, where the scan moves there."""
        size = np.linalg.norm(scanned, axis=1)
        peak = int(size.argmax())
        there = self._x[peak] * (-1.0, 1.0, 1.0)
        mirror = int(((self._x - there) ** 2).sum(axis=1).argmin())
        peaks = {peak} if size[mirror] < 0.5 * size[peak] else {peak, mirror}
        for width in BLOB_WIDTHS:
            blob = np.zeros_like(scanned)
            for at in sorted(peaks):
                squared = ((self._x - self._x[at]) ** 2).sum(axis=1)
                blob += np.exp(-squared / (2.0 * width**2))[:, None] * scanned[at]
            yield blob

    def _waters(self, values: Mapping[str, float], scanned: Array) -> float:
        """Cosine of the best geometric muscle, all that the shape names, NaN without one.

        Skin inside a cone about the line from origin to insertion, both on the skin, is drawn to
        the origin, most at the insertion and less toward the cone's surface (Waters 1987).
        """
        best = float("nan")
        for cone in CONES:
            for reach in RANGES:
                moved = np.zeros_like(self._x)
                for control, value in values.items():
                    moved += value * self._drawn(control, cone, reach)
                if moved.any():
                    field = self._space.vectors_to_head(moved)
                    best = float(np.fmax(best, self._cosine(field, scanned)))
        return best

    def _drawn(self, control: str, cone: float, reach: float) -> Array:
        """Displacement of skin by the muscle of one control, up to a gain."""
        muscle = self._muscles.get(control.removesuffix("_left").removesuffix("_right"))
        side = Side.RIGHT if control.endswith("_right") else Side.LEFT
        if isinstance(muscle, RingMuscle):
            to = muscle.centre.on(self._landmarks, side) - self._x
            near = np.exp(-((to[:, :2] ** 2).sum(axis=1)) / (2.0 * (RING * reach) ** 2))
            squeezed: Array = RING_SHARE * near[:, None] * to
            return squeezed
        if not isinstance(muscle, LinearMuscle):
            return np.zeros_like(self._x)
        ends = muscle.fibres[0].origin, muscle.fibres[0].insertion
        origin, insertion = (self._on_skin(end.on(self._landmarks, side)) for end in ends)
        along, off = insertion - origin, self._x - origin
        length = max(float(np.linalg.norm(along)), 1.0)
        distance = np.maximum(np.linalg.norm(off, axis=1), 1e-6)
        aligned = np.clip(off @ along / (distance * length), -1.0, 1.0)
        share = np.maximum(aligned - np.cos(np.radians(cone)), 0.0)
        ramp = np.where(
            distance < length, distance / length, (reach - distance / length) / (reach - 1.0)
        )
        share *= np.sin(np.clip(ramp, 0.0, 1.0) * np.pi / 2.0)
        drawn: Array = -muscle.contraction * length * share[:, None] * off / distance[:, None]
        return drawn

    def _on_skin(self, point: Array) -> Array:
        nearest: Array = self._x[int(((self._x - point) ** 2).sum(axis=1).argmin())]
        return nearest


def report(rows: list[Row], left_out: list[str], others: Mapping[str, list[Row]]) -> str:
    """The text to print."""
    columns = "shape:<20|cosine:7.3f|magnitude:9.2f|residual:8.3f|half:5.2f|blob:6.3f|Waters:6.3f"
    lines = [
        "Simulated against scanned displacement, area weighted: cosine 1 and magnitude 1 are equal",
        "fields, residual is the squared difference over the squared scan, half is the share of",
        "the motion that half the controls give. Yardsticks (cosine): a rigid blob at the scanned",
        "peak and the geometric muscle of Waters 1987, each the best of several.",
        "",
        *table(columns, [astuple(row) for row in [*rows, mean_row(rows)]]),
    ]
    if others:
        means = [(name, mean_row(each), min(each, key=_cosine)) for name, each in others.items()]
        persons = [(n, m.cosine, m.magnitude, m.residual, w.shape, w.cosine) for n, m, w in means]
        head = "person:<20|cosine:7.3f|magnitude:9.2f|residual:8.3f|least alike:>20|cosine:7.3f"
        lines += ["", "Other persons, moved by the same fields:", "", *table(head, persons)]
    if left_out:
        lines += ["", f"left out, no skin moves or ARKit has no such shape: {', '.join(left_out)}"]
    return "\n".join(lines)


def targets(rows: list[Row], others: Mapping[str, list[Row]]) -> list[Target]:
    """What the muscles are held to: the mean, the shape that is least alike, other persons."""
    worst = min(rows, key=_cosine)
    return [
        at_least("mean cosine", mean_row(rows).cosine, LEAST_MEAN),
        at_least(f"least cosine, {worst.shape}", worst.cosine, LEAST_OF_A_SHAPE),
        *(at_least(f"mean of {n}", mean_row(r).cosine, LEAST_OF_OTHERS) for n, r in others.items()),
    ]


def _cosine(row: Row) -> float:
    return row.cosine
