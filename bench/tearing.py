"""Does the skin tear: every control of each layer alone and hundreds of random mixtures, settled.

Of each pose are counted the inverted triangles, those that turned by more than a right angle
against the skin around them, and how deep skin sits in the other lip, an eyeball or the teeth.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from risorius import assets, sim
from risorius.geometry.normals import cross_products

from .report import Target, at_most
from .subjects import settled_positions

Array = npt.NDArray[np.float64]

SEED = 2001
MOST_CONTROLS = 8  # in a mixture
SETTLE = 40  # frames of 1/60 s
MOST_TORN, MOST_IN_A_POSE, DEEPEST = 2.0, 3, 0.1  # [% of poses]; triangles; [mm]
AROUND = 12.0  # mm around a triangle whose mean turn it is compared with


class PoseDefects(NamedTuple):
    """What one pose does to the skin."""

    name: str
    inverted: int  # triangles
    lips: float  # mm deep in the other lip
    lids: float  # mm deep in an eyeball
    teeth: float  # mm deep in the teeth


def measure(mixtures: int) -> list[PoseDefects]:
    """Put the built-in head into each pose, and into `mixtures` random ones."""
    head = assets.load("head")
    simulation = sim.create(head)
    poses = []
    for name, values in _values(simulation, mixtures, np.random.default_rng(SEED)):
        now = settled_positions(simulation, values, SETTLE)
        deep = simulation.penetrations()
        inverted = _inverted(simulation.rest_positions, now, head.faces)
        poses.append(PoseDefects(name, inverted, deep["lips"], deep["lids"], deep["teeth"]))
    return poses


def _values(
    simulation: sim.Simulation, mixtures: int, generator: np.random.Generator
) -> Iterator[tuple[str, dict[str, float]]]:
    """Name and values of every action unit, expression and so on, then of random mixtures."""
    for names_of_layer in simulation.layers.values():
        yield from ((name, {name: 1.0}) for name in names_of_layer)
    # The pose of the head turns all triangles alike; it is left out.
    limits = {n: simulation.limits[n] for n in simulation.controls if not n.startswith("head_")}
    names = np.array(list(limits))
    for number in range(mixtures):
        chosen = generator.choice(
            names, size=generator.integers(2, MOST_CONTROLS + 1), replace=False
        )
        values = {str(name): float(generator.uniform(*limits[str(name)])) for name in chosen}
        yield f"mixture {number}: {', '.join(values)}", values


def _inverted(rest: Array, now: Array, faces: npt.NDArray[np.int32]) -> int:
    """How many triangles turned by more than a right angle against the skin around them."""
    before, after = cross_products(rest, faces), cross_products(now, faces)
    count = 0
    for face in np.flatnonzero((before * after).sum(axis=1) < 0.0):
        away = np.linalg.norm(rest - rest[faces[face]].mean(axis=0), axis=1)
        near = away < max(AROUND, 2.0 * away[faces[face]].max())  # never the triangle alone
        a, b = rest[near] - rest[near].mean(axis=0), now[near] - now[near].mean(axis=0)
        left, _, right = np.linalg.svd(a.T @ b)
        turn = right.T @ np.diag([1.0, 1.0, np.linalg.det(right.T @ left.T)]) @ left.T
        count += int((turn @ before[face]) @ after[face] < 0.0)
    return count


def report(poses: Sequence[PoseDefects]) -> str:
    """The text to print: how many poses, and which is the worst in each way."""
    torn = [pose for pose in poses if pose.inverted]
    lines = [
        f"{len(poses)} poses: every row of the layers, and random mixtures of muscles; triangles",
        f"turned by more than a right angle: {sum(p.inverted for p in torn)} in {len(torn)} poses.",
    ]
    for part in ("inverted", "lips", "lids", "teeth"):
        worst = max(poses, key=lambda pose: float(getattr(pose, part)))
        lines.append(f"most {part}: {worst.name if getattr(worst, part) > 0.0 else '-'}")
    return "\n".join(lines)


def targets(poses: Sequence[PoseDefects]) -> list[Target]:
    """What skin and contacts are held to; a triangle turns over in a wink or a yawn."""
    torn = sum(pose.inverted > 0 for pose in poses) / len(poses)
    return [
        at_most("poses with a triangle turned", 100.0 * torn, MOST_TORN, " %"),
        at_most("triangles turned in one pose", max(p.inverted for p in poses), MOST_IN_A_POSE),
        *(
            at_most(part, max(getattr(pose, part) for pose in poses), DEEPEST, " mm")
            for part in ("lips", "lids", "teeth")
        ),
    ]
