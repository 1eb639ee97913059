"""Large meshes in motion: grids with uneven valences and holes, under waves that travel.

Cells are jittered squares cut along a random diagonal, so valences run from 4 to 8; three holes
give inner borders. Flat at rest, so that every edge bends. Lengths are in cells: a wave is as many
triangles long in a small mesh as in a large one, and edges bend alike.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Points = npt.NDArray[np.float64]
Faces = npt.NDArray[np.int32]

SEED = 2003
WAVES = ((13.0, 0.4), (29.0, 1.1), (9.0, 2.5))  # length [cells], direction [radians]
HEIGHT = 1.0  # of the waves [cells]; bends most edges by 2 to 20 degrees
HOLE = 0.06  # radius of the holes over the length of the mesh
HOLES = ((0.3, 0.7), (0.7, 0.7), (0.5, 0.25))  # their centres: two eyes and a mouth


@dataclass(frozen=True)
class Load:
    """A mesh and the frames that it goes through."""

    name: str
    faces: Faces
    rest: Points
    frames: Sequence[Points]


def waving_mesh(name: str, triangle_count: int, *, frame_count: int = 4) -> Load:
    """Make a grid of about `triangle_count` triangles, in scan order.

    So neighbours in the mesh are neighbours in memory.
    """
    generator = np.random.default_rng(SEED)
    side = max(4, round((0.5 * triangle_count / (1.0 - len(HOLES) * np.pi * HOLE**2)) ** 0.5))
    rest = _jittered(side, generator)
    faces = _cut_cells(side, generator)
    centres = rest[faces].mean(axis=1)[:, :2] / side
    is_solid = np.ones(len(faces), dtype=bool)
    for hole in HOLES:
        is_solid &= np.linalg.norm(centres - hole, axis=1) > HOLE
    faces = faces[is_solid]
    used, faces = np.unique(faces, return_inverse=True)
    rest, faces = rest[used], faces.reshape(-1, 3)
    frames = [_waved(rest, phase) for phase in np.arange(frame_count) / frame_count]
    return Load(name, faces.astype(np.int32), rest, frames)


def _jittered(side: int, generator: np.random.Generator) -> Points:
    x, y = np.meshgrid(np.arange(side + 1.0), np.arange(side + 1.0))
    points = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    points[:, :2] += generator.uniform(-0.3, 0.3, (len(points), 2))
    return points


def _cut_cells(side: int, generator: np.random.Generator) -> npt.NDArray[np.int64]:
    a = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).ravel()
    b, c, d = a + 1, a + side + 2, a + side + 1
    rising = np.stack([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)], axis=1)
    falling = np.stack([np.stack([a, b, d], axis=1), np.stack([b, c, d], axis=1)], axis=1)
    is_rising = generator.random(len(a)) < 0.5
    return np.where(is_rising[:, None, None], rising, falling).reshape(-1, 3)


def _waved(rest: Points, phase: float) -> Points:
    """The mesh at a moment of its waves, stronger in some places than in others."""
    x, y = rest[:, 0], rest[:, 1]
    strength = 0.15 + np.sin(x / 61.0) ** 2 * np.sin(y / 47.0) ** 2
    height = np.zeros(len(rest))
    for length, direction in WAVES:
        along = np.cos(direction) * x + np.sin(direction) * y
        height += np.sin(2.0 * np.pi * (along / length - phase))
    moved = rest.copy()
    moved[:, 2] += HEIGHT * strength * height
    return moved
