"""How well the rig foretells a shape that its fit did not see: `risorius bench left-out`.

Shape by shape of a folder of scans (motion.py), a rig is fitted to all the others, and the shape is
posed with it and scored. Each fit starts from anatomy.toml, where muscles, jaw and lids are as
books have them and all muscles of a kind are equally strong, and which tells who makes a shape
(FACS). All numbers of all muscles may change, places too, those of jaw and lids, and the shares of
the muscles in the shapes that are seen, each tied to its start. What muscles have in common is a
shared change (muscle_numbers.py): so a muscle that only the left-out shape would show has the place
of its anatomy and the strength and width of the others. Of the built-in rig stay tissue, muscles
that none of these shapes uses, and which muscles the row of a seen shape may have.

Fitted are positions of rest (statics.py) on a coarse mesh, by Gauss and Newton; scored are
simulated poses. How far a wrong mixture of muscles is to blame for a miss, the left-out shape tells
when the shares of its own row, and nothing else, are fitted to it.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import astuple, dataclass, fields
from functools import lru_cache, partial
from pathlib import Path

import numpy as np
import numpy.typing as npt
from tqdm import tqdm

from risorius import sim

from ..report import table
from .bones_and_lids import framed
from .motion import SIDE, known_shape
from .muscle_numbers import Numbers, Parts, anatomical, moved_by, parts_of, with_parts
from .reading import Scans, read_coarse_scans
from .statics import Balance, Effect, Statics

Array = npt.NDArray[np.float64]
Vector = Array  # changes of numbers, shared ones, and shares

OWN_TIE, SHARED_TIE, SHARE_TIE = 0.1, 0.02, 0.03  # to the start against a whole scan
SHARE_SCALE = 0.3  # how far a share may easily go
STEPS = 6  # of Gauss and Newton at most
FEW = 0.003  # share of the error that a step must win
DAMPING = 0.02
LONGEST = 2.0  # scales that a number goes in one step
SLIGHT = 0.1  # scales, for derivatives
PROCESSES = 4  # at most; each takes 1.5 GB
SETTLE = 30  # frames of 1/60 s until a pose is still enough


@dataclass(frozen=True)
class Row:
    """Cosines of one shape with five rigs."""

    shape: str
    rig: float  # as it is
    anatomy: float  # before any fit
    left_out: float  # fitted to the other shapes
    mixed: float  # the same, but the shares of its muscles are fitted to the shape
    fitted: float  # fitted to all in the same way


@dataclass(frozen=True)
class _Task:
    """A shape of the scans as a fit sees it."""

    scanned: Array  # (V, 3) mm
    known: Mapping[str, float]  # controls after anatomy
    start: Mapping[str, float]  # the same, with those at 0 that the built-in row has, too
    built_in: Mapping[str, float]


def measure(directory: str | Path) -> list[Row]:
    """Leave out one shape after the other. Raises ValueError for a folder that is none."""
    face = _face(directory)
    everything = face.fit(face.tasks)
    with ProcessPoolExecutor(min(os.cpu_count() or 1, PROCESSES)) as pool:
        foretold = pool.map(partial(_foretold, directory), face.tasks)
        progress = tqdm(foretold, desc="left out", total=len(face.tasks), leave=False)
        return [
            Row(
                name,
                face.cosine(face.built_in, task.built_in, task.scanned),
                face.cosine(face.anatomy.parts, task.known, task.scanned),
                *cosines,
                face.cosine(everything.parts, everything.rows[name], task.scanned),
            )
            for (name, task), cosines in zip(face.tasks.items(), progress, strict=True)
        ]


@lru_cache(1)
def _face(directory: str | Path) -> _Face:
    return _Face(read_coarse_scans(directory))


def _foretold(directory: str | Path, name: str) -> tuple[float, float]:
    """Cosines of a shape with a rig fitted to all others: by its row after anatomy, and mixed."""
    face = _face(directory)
    task = face.tasks[name]
    others = face.fit([other for other in face.tasks if other != name])
    mixed = face.mixed(name, others)
    return (
        face.cosine(others.parts, task.known, task.scanned),
        face.cosine(mixed.parts, mixed.rows[name], task.scanned),
    )


@dataclass(frozen=True)
class _Point:
    """Where a fit is."""

    changes: Vector
    parts: Parts
    rows: Mapping[str, Mapping[str, float]]
    balances: Mapping[str, Balance]
    error: float


class _Face:
    """Scans, and muscles on that head; only the left half of shapes that have two."""

    def __init__(self, scans: Scans) -> None:
        self._trial = sim.Trial(scans.head)
        self.built_in, self.anatomy = parts_of(self._trial.rig), anatomical(scans.head.rig)
        rig = with_parts(self._trial.rig, self.anatomy.parts)
        self._statics = Statics(framed(self._trial.anatomy, rig))
        self._root = np.sqrt(self._trial.areas)[:, None]
        simulation, self.tasks = self._trial.simulation(self._trial.rig), dict[str, _Task]()
        for name in scans.names:
            shape, row = known_shape(name, simulation), self._row(name)
            if shape and row and not name.lower().endswith(("_r", "right")):
                standard = self._trial.anatomy.space.vectors_to_standard(scans.field(name))
                start = dict.fromkeys(shape.values, 0.0) | row
                self.tasks[name] = _Task(np.asarray(standard), row, start, shape.values)
        parts, tasks = self.anatomy.parts, self.tasks.values()
        used = {moved_by(control, parts) for task in tasks for control in task.start}
        self._numbers = Numbers(parts, sorted(used))
        self._shares = [(name, c) for name, task in self.tasks.items() for c in task.start]
        self._started = np.array([self.tasks[name].start[c] for name, c in self._shares])
        own, shared = self._numbers.sharing.shape
        ties = (OWN_TIE, SHARED_TIE, SHARE_TIE)
        self._ties = np.repeat(ties, (own, shared, len(self._shares)))
        self._first: dict[str, tuple[Array, Array]] = {}

    def _row(self, name: str) -> dict[str, float]:
        """Who makes a shape after anatomy, on its side; nothing where it does not say."""
        rows = {key.lower(): row for key, row in self.anatomy.rows.items()}
        if name.lower() in rows:
            return dict(rows[name.lower()])
        row = rows.get(SIDE.sub("", name).lower(), {})
        return {f"{muscle}_left": share for muscle, share in row.items()}

    def cosine(self, parts: Parts, values: Mapping[str, float], scanned: Array) -> float:
        """Pose a rig and compare."""
        rig = with_parts(self._trial.rig, parts)
        self._trial.anatomy = framed(self._trial.anatomy, rig)
        simulation = self._trial.simulation(rig)
        simulation.set_all(values)
        for _ in range(SETTLE):
            simulation.step(1.0 / 60.0)
        moved = simulation.positions - simulation.rest_positions
        a = self._root * self._trial.anatomy.space.vectors_to_standard(moved)
        b = self._root * scanned
        return float((a * b).sum() / max(np.linalg.norm(a) * np.linalg.norm(b), 1e-12))

    def mixed(self, name: str, muscles: _Point) -> _Point:
        """Fit only the shares of one shape's own row."""
        count = self._numbers.count
        own = [count + n for n, (of, _) in enumerate(self._shares) if of == name]
        return self.fit([name], muscles.changes, own)

    def fit(
        self, names: Iterable[str], start: Vector | None = None, free: Sequence[int] | None = None
    ) -> _Point:
        """Fit a rig to some of the shapes, from anatomy on; or only the changes in `free`."""
        seen, every = list(names), range(len(self._ties))
        point = self._at(np.zeros(len(every)) if start is None else start, seen)
        damping, little, free = DAMPING, 0, every if free is None else free
        for step in range(STEPS):
            found = self._derivatives(point, seen, first=step == 0 and start is None)
            matrix = np.diag(self._ties**2) + sum(found[name][0] for name in seen)
            slope = self._ties**2 * point.changes + sum(found[name][1] for name in seen)
            matrix, better = matrix[np.ix_(free, free)], None
            while better is None and damping < 100.0:
                way = np.zeros(len(every))
                way[free] = np.linalg.solve(matrix + damping * np.eye(len(free)), -slope[free])
                tried = self._at(point.changes + np.clip(way, -LONGEST, LONGEST), seen)
                better = tried if tried.error < point.error else None
                damping = damping / 4.0 if better else damping * 8.0
            if better is None:
                break
            little = little + 1 if point.error - better.error < FEW * point.error else 0
            point = better
            if little == 2:
                break
        return point

    def _at(self, changes: Vector, seen: Sequence[str]) -> _Point:
        """Pose all shapes that a fit sees."""
        count, changes = self._numbers.count, changes.copy()
        shares = np.clip(self._started + SHARE_SCALE * changes[count:], 0.0, 1.0)
        changes[count:] = (shares - self._started) / SHARE_SCALE
        parts = self._numbers.parts(changes[:count])
        rows: dict[str, dict[str, float]] = {name: {} for name in self.tasks}
        for (name, control), share in zip(self._shares, shares, strict=True):
            rows[name][control] = float(share)
        balances = {name: self._statics.balance(parts, rows[name]) for name in seen}
        error = float(((self._ties * changes) ** 2).sum())
        error += sum(float((self._off(name, balances[name]) ** 2).sum()) for name in seen)
        return _Point(changes, parts, rows, balances, error)

    def _off(self, name: str, balance: Balance) -> Array:
        """How far a pose is off, against its scan, shape (V, 3)."""
        scanned = self.tasks[name].scanned
        off: Array = self._root * (balance.moved - scanned)
        return off / np.linalg.norm(self._root * scanned)

    def _derivatives(
        self, point: _Point, seen: Sequence[str], *, first: bool
    ) -> dict[str, tuple[Array, Array]]:
        """Gauss and Newton's matrix and slope of each shape; those at anatomy serve every fit."""
        missing = [name for name in seen if not (first and name in self._first)]
        found = {name: self._of_shape(point, name) for name in missing}
        if first:
            self._first |= found
        return {name: self._first[name] if first else found[name] for name in seen}

    def _of_shape(self, point: _Point, name: str) -> tuple[Array, Array]:
        """The same of one shape."""
        changes, columns = list[Effect](), list[int]()
        for control, share in point.rows[name].items():
            name_of_part = moved_by(control, point.parts)
            part = point.parts[name_of_part]
            now = self._statics.effect(part, control, share)
            further = share + 0.05 if share < 0.9 else share - 0.05
            then = self._statics.effect(part, control, further)
            changes.append(_slope(now, then, (further - share) / SHARE_SCALE))
            columns.append(self._numbers.count + self._shares.index((name, control)))
            for j, number in enumerate(self._numbers.all if share > 0.0 else ()):
                if number.part == name_of_part:
                    other = number.put(part, number.of(part) + SLIGHT * number.scale)
                    then = self._statics.effect(other, control, share)
                    changes.append(_slope(now, then, SLIGHT))
                    columns.append(j)
        balance = point.balances[name]
        size = np.linalg.norm(self._root * self.tasks[name].scanned)
        moved = balance.derivatives(changes) * (self._root / size)[:, :, None]
        return self._normal(moved.reshape(-1, len(columns)), columns, self._off(name, balance))

    def _normal(self, moved: Array, columns: Sequence[int], off: Array) -> tuple[Array, Array]:
        """Matrix and slope for all changes, from derivatives after some, shape (3V, n)."""
        own, count = len(self._numbers.all), len(self._ties)
        spread = np.zeros((count, len(columns)))
        spread[columns, np.arange(len(columns))] = 1.0
        spread[own : self._numbers.count] = self._numbers.sharing.T @ spread[:own]
        few = np.flatnonzero(spread.any(axis=1))  # most changes are of muscles that do not act
        spread, matrix, slope = spread[few], np.zeros((count, count)), np.zeros(count)
        matrix[np.ix_(few, few)] = spread @ (moved.T @ moved) @ spread.T
        slope[few] = spread @ (moved.T @ off.ravel())
        return matrix, slope


def _slope(now: Effect, then: Effect, step: float) -> Effect:
    """How an effect changes for each unit of a step."""
    more = then.plus(now, -1.0)
    return Effect(*(each / step for each in more))


def report(rows: Sequence[Row]) -> str:
    """The text to print."""
    columns = "shape:<20|rig:7.3f|anatomy:7.3f|left out:8.3f|mixed:7.3f|fitted:7.3f"
    keys = [each.name for each in fields(Row)][1:]
    mean = Row("mean", *(float(np.mean([getattr(row, key) for row in rows])) for key in keys))
    lines = [
        "Cosine of simulated to scanned displacement: with the built-in rig, with muscles, jaw and",
        "lids as anatomy alone has them, with those fitted from there to all other shapes, with",
        "the same in a mixture fitted to the shape, and with those fitted to all.",
        "",
        *table(columns, [astuple(row) for row in [*rows, mean]]),
    ]
    return "\n".join(lines)
