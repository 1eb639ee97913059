"""How well the muscles move skin: simulated against scanned displacement, shape by shape.

Takes a folder with a neutral face and displacement fields (ICT-FaceKit's layout, `face.npz`:
`vertices` (V, 3), `triangles` (F, 3), `landmarks68` (68,), then one (V, 3) field per shape), fits
the rig to that head as to anybody's, by its 68 landmarks (assets/fitting), and compares the fields,
weighted by area. A field has the name of one of ARKit's
shapes in any spelling, and is compared with that row of the head's controls at 1. One side of a
shape that has no sides ("cheekPuff_L") is made by the muscles of that side.

    cosine      1 = same directions and proportions          magnitude   |simulated| / |scanned|
    residual    |simulated - scanned|^2 / |scanned|^2        half        share of the motion that
                                                                         half the controls give

The rig was fitted to sixteen shapes of ICT-FaceKit, so for them this is a training score.
Other persons may lie beside it as `identities.npz`, vertices (V, 3) of each: faces of other forms,
moved by the same fields.
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
from risorius.assets.fitting import FittedHead, fit
from risorius.assets.meshes import Mesh
from risorius.sim.coordinates import FaceSpace
from risorius.sim.landmarks import Side

from .report import Target, at_least, table
from .subjects import DENSE, NOT_MOTION, PERSONS, read_arrays, settled_positions

Array = npt.NDArray[np.float64]

LEAST_MEAN, LEAST_OF_A_SHAPE, LEAST_OF_OTHERS = 0.94, 0.88, 0.92  # cosines
SETTLE = 60  # frames of 1/60 s until a pose is still
SIDE = re.compile(r"_?(l|r|left|right)$", re.IGNORECASE)  # at the end of a field's name
ALSO_CALLED = {"cheekraiser": "cheekSquint"}  # ICT-FaceKit has AU6 twice
SEAM = 10.0  # mm beside the midline over which a one-sided shape fades, where we have but one whole


@dataclass(frozen=True)
class Row:
    """Scores of one shape on one side; NaN where something does not apply."""

    shape: str
    cosine: float
    magnitude: float
    residual: float
    half: float


@dataclass(frozen=True)
class Shape:
    """A field of the reference and the controls that make the same shape."""

    name: str  # of the field
    values: dict[str, float]  # full strength
    base: dict[str, float]  # the pose from which it is measured
    cut: Side | None  # the side of a one-sided field for which there is no one-sided control


@dataclass(frozen=True)
class Scans:
    """A folder of scans, and the head that was fitted to the neutral one of them."""

    directory: str | Path
    head: FittedHead
    arrays: Mapping[str, npt.NDArray[Any]]

    @property
    def names(self) -> tuple[str, ...]:
        """What the fields are called."""
        return tuple(name for name in self.arrays if name not in NOT_MOTION)

    def field(self, name: str) -> npt.NDArray[np.float64]:
        """How far the scan moved the head's vertices [mm], shape (V, 3).

        Raises ValueError, naming the file, where it is no motion of them.
        """
        field = self.arrays[name]
        if field.shape != self.arrays["vertices"].shape or not np.isfinite(field).all():
            raise ValueError(
                f"{self.directory}: {name} in {DENSE} must be finite displacements of all vertices"
            )
        return self.head.to_millimetres.vectors(field[self.head.file_vertices])

    def persons(self) -> Iterator[tuple[str, Scans]]:
        """Other persons in the folder, each with a head of their own that moves alike."""
        file = Path(self.directory) / PERSONS
        if file.is_file():
            for name, vertices in read_arrays(file, ()).items():
                yield name, _scans(self.directory, {**self.arrays, "vertices": vertices}, PERSONS)


def read_scans(directory: str | Path) -> Scans:
    """The scans in a folder. Raises ValueError, naming the file, if it is broken."""
    return _scans(directory, read_arrays(Path(directory) / DENSE, NOT_MOTION), DENSE)


def _scans(directory: str | Path, arrays: Mapping[str, npt.NDArray[Any]], file: str) -> Scans:
    """Fit the rig to the head in some arrays; `file`: where its vertices are from."""
    mesh = Mesh(arrays["vertices"].astype(np.float64), arrays["triangles"].astype(np.int32))
    landmarks = arrays["landmarks68"].astype(np.int32)
    if not _is_sound(mesh, landmarks):
        raise ValueError(
            f"{directory}: in {file}, vertices must be finite, (V, 3), triangles (F, 3) and "
            "landmarks68 (68,) numbers of them"
        )
    return Scans(directory, fit(mesh, landmarks), arrays)


def _is_sound(mesh: Mesh, landmarks: npt.NDArray[np.int32]) -> bool:
    """Whether vertices, triangles and landmarks have their shapes and name vertices there are."""
    return (
        mesh.vertices.ndim == mesh.faces.ndim == 2
        and mesh.vertices.shape[1] == mesh.faces.shape[1] == 3
        and landmarks.shape == (68,)
        and bool(np.isfinite(mesh.vertices).all())
        and all(
            bool(((numbers >= 0) & (numbers < len(mesh.vertices))).all())
            for numbers in (mesh.faces, landmarks)
        )
    )


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
    space = FaceSpace.from_landmarks(head.vertices[head.landmarks])
    ruler = _Ruler(space.to_standard(head.vertices)[:, :1], simulation.areas[:, None])
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


@dataclass(frozen=True)
class _Ruler:
    """Compares displacement fields on one head."""

    x: Array
    """How far vertices are to the subject's left [mm], shape (V, 1)."""
    areas: Array
    """Shape (V, 1)."""

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
        )

    def _half_of_the_face(self, side: Side | None) -> Array:
        """1 on a side of the face, 0 on the other, shape (V, 1); 1 everywhere without a side."""
        if side is None:
            return np.ones_like(self.x)
        share: Array = np.clip((side.sign * self.x / SEAM + 1.0) / 2.0, 0.0, 1.0)
        return share

    def _product(self, a: Array, b: Array) -> float:
        return float((self.areas * a * b).sum())

    def _cosine(self, a: Array, b: Array) -> float:
        size = self._product(a, a) * self._product(b, b)
        return self._product(a, b) / float(np.sqrt(size)) if size > 0.0 else 0.0


def report(rows: list[Row], left_out: list[str], others: Mapping[str, list[Row]]) -> str:
    """The text to print."""
    columns = "shape:<20|cosine:7.3f|magnitude:9.2f|residual:8.3f|half:5.2f"
    lines = [
        "Simulated against scanned displacement, area weighted: cosine 1 and magnitude 1 are equal",
        "fields, residual is the squared difference over the squared scan, half is the share of",
        "the motion that half the controls give.",
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


def targets(rows: list[Row], _: list[str], others: Mapping[str, list[Row]]) -> list[Target]:
    """What the muscles are held to: the mean, the shape that is least alike, other persons."""
    worst = min(rows, key=_cosine)
    return [
        at_least("mean cosine", mean_row(rows).cosine, LEAST_MEAN),
        at_least(f"least cosine, {worst.shape}", worst.cosine, LEAST_OF_A_SHAPE),
        *(at_least(f"mean of {n}", mean_row(r).cosine, LEAST_OF_OTHERS) for n, r in others.items()),
    ]


def _cosine(row: Row) -> float:
    return row.cosine
