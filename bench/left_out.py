"""How well the rig foretells a shape that its fit did not see: `risorius bench left-out`.

For each shape of a folder of scans (motion.py), the muscles that it uses lose all that was ever
fitted: strengths, widths and bulges fall back to the median of the muscles of their kind that the
shape does not use, and the shares of the shape to 1 for prime movers and 0.3 for helpers. Then
NUMBERS of those muscles are fitted to the other shapes that use them, with a pull towards where
they started, and the shape that was left out is posed and scored.

What remains of it is anatomy, which the rig's file has in millimetres: where a muscle begins and
ends, where the ring of a sphincter lies and to which point it draws, which lip it moves; and which
muscles make the shape. Both were written with the scans at hand, the places within 7 mm of anatomy.
A shape whose muscles no other one uses is posed with typical muscles. Jaw and lids have no numbers
of this kind, and their shapes are not asked.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.optimize import least_squares
from tqdm import tqdm

from risorius import sim
from risorius.sim.rig import Fibre, LinearMuscle, Muscle, Rig, RingMuscle

from .motion import Shape, known_shape
from .report import table
from .scans import Scans, read_scans

Array = npt.NDArray[np.float64]

PLACES = ("origin", "insertion", "fibres", "centre", "shape", "radii", "arc_deg", "opening")
NATURE = ("name", "action", "group", "pair", "halves", "crosses", "tone", "bone", "gate")
KEPT = {*PLACES, *NATURE, "opens_lips", "lies_on"}  # all else of a muscle was fitted
NUMBERS = {  # what is fitted, and how far it goes for the pull of a start to count as one
    "contraction": 0.15, "width": 5.0, "bulge": 3.0, "push": 8.0, "flare": 4.0,
}  # fmt: skip
PULL = 0.1  # of the start against a whole scan
PRIME = 0.5  # share from which a muscle is a prime mover
HELPER = 0.3  # typical share of the others
SETTLE = 30  # frames of 1/60 s until a pose is still enough
TRIES = 2  # steps of Gauss and Newton


@dataclass(frozen=True)
class Row:
    """One shape: cosine with the rig as it is, with it left out, and how many shapes were left."""

    shape: str
    fitted: float
    left_out: float
    others: int


@dataclass(frozen=True)
class _Number:
    """One number of one muscle."""

    muscle: str
    key: str
    place: int | None  # in a list
    scale: float

    def of(self, muscle: Muscle) -> float:
        value = getattr(muscle, self.key)
        return float(value if self.place is None else value[self.place])

    def put(self, muscle: Muscle, value: float) -> Muscle:
        """The muscle with another value here, within what a rig file may say."""
        rule = next(each for each in fields(muscle) if each.name == self.key).metadata
        changed: Any = float(np.clip(value, rule["low"], rule["high"]))
        if self.place is not None:
            values = list(getattr(muscle, self.key))
            values[self.place] = changed
            changed = tuple(values)
        found: Muscle = replace(muscle, **{self.key: changed})
        return found


def measure(directory: str | Path) -> list[Row]:
    """Leave out one shape after the other. Raises ValueError for a folder that is none."""
    face = _Face(read_scans(directory))
    return [face.without(name) for name in tqdm(face.shapes, desc="left out", leave=False)]


def typical(muscle: Muscle, others: Sequence[Muscle]) -> Muscle:
    """A muscle of which only place and nature are known: in all else it is as the others are.

    others: of its kind, one at least; each number becomes their median.
    """
    typical_of: dict[str, Any] = {}
    for rule in fields(muscle):
        if rule.name not in KEPT and rule.metadata["rule"] in ("number", "vector"):
            median = np.median([getattr(each, rule.name) for each in others], axis=0)
            typical_of[rule.name] = tuple(median.tolist()) if median.ndim else float(median)
    if isinstance(muscle, LinearMuscle):
        typical_of["fibres"] = tuple(Fibre(each.origin, each.insertion) for each in muscle.fibres)
    found: Muscle = replace(muscle, **typical_of)
    return found


class _Face:
    """The scans, and the rig on that head; only the left half of shapes that have two."""

    def __init__(self, scans: Scans) -> None:
        self._trial = sim.Trial(scans.head)
        simulation = self._trial.simulation(self._trial.rig)
        self._muscles = {muscle.name: muscle for muscle in self._trial.rig.muscles}
        self.shapes: dict[str, Shape] = {}
        self._fields: dict[str, Array] = {}
        for name in scans.names:
            shape = known_shape(name, simulation)
            if shape and not name.lower().endswith(("_r", "right")) and self._used(shape):
                self.shapes[name], self._fields[name] = shape, scans.field(name)
        self._root = np.sqrt(self._trial.areas)[:, None]

    def _used(self, shape: Shape) -> dict[str, Muscle]:
        """The linear muscles and sphincters of a shape; none if bones or lids take part."""
        names = {_whole(control): control for control in shape.values}
        found = {name: self._muscles[name] for name in names if name in self._muscles}
        numbered = all(isinstance(m, LinearMuscle | RingMuscle) for m in found.values())
        return found if numbered and len(found) == len(names) else {}

    def _typical(self, muscle: Muscle, used: Mapping[str, Muscle]) -> Muscle:
        """What the muscles that are not used tell of one that is."""
        unused = [each for each in self._muscles.values() if each.name not in used]
        return typical(muscle, [each for each in unused if type(each) is type(muscle)])

    def without(self, name: str) -> Row:
        """Score a shape with the rig as it is, and with a rig that was fitted to the others."""
        shape, rig = self.shapes[name], self._trial.rig
        used = self._used(shape)
        others = [n for n, s in self.shapes.items() if n != name and used.keys() & self._used(s)]
        bare = {each: self._typical(muscle, used) for each, muscle in used.items()}
        numbers = [each for muscle in bare.values() for each in _numbers(muscle)]
        start = np.array([each.of(bare[each.muscle]) for each in numbers])
        scale = np.array([each.scale for each in numbers])

        def rig_of(x: Array) -> Rig:
            """The rig with these numbers, in units of their scales."""
            changed = dict(bare)
            for number, value in zip(numbers, start + scale * x, strict=True):
                changed[number.muscle] = number.put(changed[number.muscle], float(value))
            whole: Rig = replace(rig, muscles=tuple(changed.get(m.name, m) for m in rig.muscles))
            return whole

        def off(x: Array) -> Array:
            """How far the other shapes are off, and the numbers from their start."""
            simulation = self._trial.simulation(rig_of(x))
            parts = []
            for other in others:
                scanned = self._root * self._fields[other]
                posed = self._root * self._posed(simulation, self.shapes[other].values)
                parts.append(((posed - scanned) / np.linalg.norm(scanned)).ravel())
            return np.concatenate([*parts, PULL * x])

        x = np.zeros(len(numbers))
        if others:
            x = least_squares(off, x, diff_step=0.1, x_scale=1.0, max_nfev=TRIES).x
        shares = {c: 1.0 if v >= PRIME else HELPER for c, v in shape.values.items()}
        as_is, foretold = self._trial.simulation(rig), self._trial.simulation(rig_of(x))
        return Row(
            name,
            self._cosine(self._posed(as_is, shape.values), name),
            self._cosine(self._posed(foretold, shares), name),
            len(others),
        )

    def _posed(self, simulation: sim.Simulation, values: Mapping[str, float]) -> Array:
        simulation.set_all(values)
        for _ in range(SETTLE):
            simulation.step(1.0 / 60.0)
        moved: Array = simulation.positions - simulation.rest_positions
        simulation.reset()
        return moved

    def _cosine(self, moved: Array, name: str) -> float:
        a, b = self._root * moved, self._root * self._fields[name]
        return float((a * b).sum() / max(np.linalg.norm(a) * np.linalg.norm(b), 1e-12))


def _numbers(muscle: Muscle) -> list[_Number]:
    """What is fitted of a muscle."""
    found = []
    for key, scale in NUMBERS.items():
        value: Any = getattr(muscle, key, None)
        if isinstance(value, tuple):
            found += [_Number(muscle.name, key, place, scale) for place in range(len(value))]
        elif value is not None:
            found.append(_Number(muscle.name, key, None, scale))
    return found


def _whole(control: str) -> str:
    return control.removesuffix("_left").removesuffix("_right")


def report(rows: Sequence[Row]) -> str:
    """The text to print."""
    means = [float(np.mean([getattr(row, c) for row in rows])) for c in ("fitted", "left_out")]
    columns = "shape:<20|fitted:7.3f|left out:8.3f|others:6d"
    lines = [
        "Cosine of simulated to scanned displacement: with the rig as it is, and with a rig whose",
        "muscles of this shape start like the others and are fitted to the shapes that share them.",
        "",
        *table(columns, [(r.shape, r.fitted, r.left_out, r.others) for r in rows]),
        *table("mean:<20|fitted:7.3f|left out:8.3f", [("mean", *means)])[1:],
    ]
    return "\n".join(lines)
