"""Shape the ears of persons: their size, how far they stand off, how they lean, and their lobes.

Ears of men are longer, and ears grow by 0.22 mm a year (Heathcote 1995, "Why do old men have big
ears?", BMJ 311:1668). Other numbers are chosen by eye.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from ...geometry.arrays import Floats64, Integers32
from ...geometry.sides import edges_of
from ...geometry.steps import smoothstep
from ..loading import load
from ..model import Segment


@dataclass(frozen=True)
class Ears:
    """How the ears of a person differ from those of the built-in head.

    length, breadth: factors. angle: how much farther they stand off the head [rad]. lean: how much
    farther they lean backward [rad]. lobe: how much longer the lobes are [mm].
    """

    length: float = 1.0
    breadth: float = 1.0
    angle: float = 0.0
    lean: float = 0.0
    lobe: float = 0.0


USUAL_EARS = Ears()


def drawn_ears(is_man: bool, age: float, random: np.random.Generator) -> Ears:
    """Choose random ears for a sex and an age [years]."""
    built_in_length = 59.0  # [mm]
    longer, wider, off, back, low = np.clip(random.normal(size=5), -2.0, 2.0).tolist()
    length = (61.5 if is_man else 58.0) + 0.22 * (age - 30.0) + 3.0 * longer
    return Ears(
        length=length / built_in_length,
        breadth=1.0 + 0.05 * wider,
        angle=0.04 + 0.08 * off,
        lean=0.06 * back,
        lobe=1.5 * low,
    )


class _Ear(NamedTuple):
    """One ear of the built-in head: its vertices, and how far each follows, 0 to 1, both (n,)."""

    vertices: Integers32
    shares: Floats64


def with_ears(vertices: Floats64, ears: Ears) -> Floats64:
    """Shape the ears on a person's skin; takes and returns vertices [mm], (V, 3)."""
    anatomy = load("head").anatomy
    turn = Rotation.from_euler("xy", [-ears.lean, -ears.angle])
    shaped = vertices.copy()
    for name, side in (("left", 1.0), ("right", -1.0)):
        ear = _ear(name)
        pivot = vertices[anatomy[f"tragion_{name}"]]
        as_left = (vertices[ear.vertices] - pivot) * [side, 1.0, 1.0]
        larger = as_left * [ears.breadth, ears.length, ears.breadth]
        lobe_start, lobe_end = 10.0, 28.0  # [mm] below the tragion
        larger[:, 1] -= ears.lobe * smoothstep(-as_left[:, 1], lobe_start, lobe_end)
        moved = turn.apply(larger) - as_left
        shaped[ear.vertices] += ear.shares[:, None] * moved * [side, 1.0, 1.0]
    return shaped


def ear_vertices(name: str) -> Integers32:
    """Return the vertices of the left or right ear, which all persons share, (n,)."""
    return _ear(name).vertices


@lru_cache(maxsize=2)
def _ear(name: str) -> _Ear:
    """Return the left or right ear; its root on the head stays."""
    head = load("head")
    size = len(head.segments)
    columns, rows = np.clip((head.uv * [1.0, -1.0] + [0.0, 1.0]) * size, 0, size - 1).T.astype(int)
    is_ear = head.segments[rows, columns] == Segment[f"{name.upper()}_EAR"]
    edges = edges_of(head.faces)
    beside = edges[is_ear[edges[:, 0]] != is_ear[edges[:, 1]]]
    root = np.setdiff1d(beside, np.flatnonzero(is_ear))
    numbers = np.flatnonzero(is_ear)
    apart = head.vertices[numbers][:, None] - head.vertices[root]
    distances = np.linalg.norm(apart, axis=2).min(axis=1)
    rooted_length = 14.0  # [mm] from the root over which skin stays more and more
    return _Ear(numbers.astype(np.int32), smoothstep(distances, 0.0, rooted_length))
