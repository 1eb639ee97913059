"""Measure the error of a fine mesh that is moved by a coarse mesh.

Surfaces with a formula are bent by maps with a formula, so the true position of every fine vertex
is known. The vertices of both meshes lie on the surface at rest. `refine.Embedding` is compared
with two usual ways to bind a fine mesh to a coarse simulation. Both attach each point to the flat
triangle that is nearest at rest: the first at the triangle itself, the second with an offset in the
triangle's own axes. All three methods use the same coarse triangles.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import trimesh

from risorius import refine
from risorius.assets.sheets import make_grid
from risorius.assets.topology import grid_faces
from risorius.geometry.arrays import Floats64, Integers32
from risorius.geometry.closest import SurfacePoints, closest_points
from risorius.geometry.directions import unit_vectors

from .report import Target, at_least, processor, table

PointsAndFaces = tuple[Floats64, Integers32]
Map = Callable[[Floats64], Floats64]

ROUND_COUNT = 20  # rounds of timing a frame


class EmbeddingRow(NamedTuple):
    """The RMS errors of three ways to move a fine mesh [units of the surface]."""

    surface: str
    map: str
    triangles: int
    points: int
    ours: float
    with_offset: float
    without_offset: float
    milliseconds: float
    """Time of a frame of ours, median [ms]."""


def sheet(cells: int) -> PointsAndFaces:
    """A square of side 2 in the plane z = 0."""
    return make_grid(cells, cells, 2.0 / cells)


def sphere(levels: int) -> PointsAndFaces:
    """A sphere of radius 1 with nearly equal triangles."""
    ball = trimesh.creation.icosphere(levels)
    return np.array(ball.vertices), np.array(ball.faces, dtype=np.int32)


def tube(around: int, along: int) -> PointsAndFaces:
    """An open cylinder along x, with radius 0.5 and length 4, that faces outward."""
    angles = 2.0 * np.pi * np.arange(around) / around
    stations = np.linspace(-2.0, 2.0, along + 1)
    x, angle = np.meshgrid(stations, angles, indexing="ij")
    y = 0.5 * np.cos(angle)
    z = 0.5 * np.sin(angle)
    rings = np.stack([x, y, z], axis=2)
    number = np.arange(x.size).reshape(x.shape)
    return rings.reshape(-1, 3), grid_faces(number[:, ::-1], closed=True)


def rolled(points: Floats64) -> Floats64:
    """Roll a plane along x into a cylinder, whose axis lies 1.5 below the plane."""
    radius = 1.5 + points[:, 2]
    angle = points[:, 0] / 1.5
    return np.stack([radius * np.sin(angle), points[:, 1], radius * np.cos(angle) - 1.5], axis=1)


def waved(points: Floats64) -> Floats64:
    """Bend a plane along the x axis, and a little across it."""
    moved = points.copy()
    moved[:, 2] += 0.15 * np.sin(3.0 * points[:, 0] + points[:, 1])
    return moved


def twisted(points: Floats64) -> Floats64:
    """Turn all points about the x axis, more at larger x."""
    angle = 0.8 * points[:, 0]
    y = np.cos(angle) * points[:, 1] - np.sin(angle) * points[:, 2]
    z = np.sin(angle) * points[:, 1] + np.cos(angle) * points[:, 2]
    return np.stack([points[:, 0], y, z], axis=1)


def stretched(points: Floats64) -> Floats64:
    """Stretch a sphere into an ellipsoid."""
    return points * [1.3, 0.8, 1.0]


def swollen(points: Floats64) -> Floats64:
    """Make a tube one and a half times as thick."""
    return points * [1.0, 1.5, 1.5]


EMBEDDING_CASES: tuple[tuple[str, PointsAndFaces, PointsAndFaces, tuple[Map, ...]], ...] = (
    ("plane", sheet(16), sheet(160), (rolled, waved, twisted)),
    ("sphere", sphere(2), sphere(5), (stretched, rolled, twisted)),
    ("cylinder", tube(16, 20), tube(128, 160), (rolled, twisted, swollen)),
)


class FlatBinding:
    """A point on the flat triangle nearest at rest, and the offset in the triangle's own axes."""

    def __init__(self, faces: Integers32, rest: Floats64, points: Floats64) -> None:
        """Bind `points` at rest."""
        self._places: SurfacePoints = closest_points(points, rest, faces)
        away = points - self._places.interpolate(rest)
        self._offsets = np.einsum("nij,ni->nj", self._axes(rest), away)

    def evaluate(self, positions: Floats64, *, offset: bool) -> Floats64:
        """The moved points, with or without their offsets."""
        places = self._places.interpolate(positions)
        if not offset:
            return places
        return np.asarray(places + np.einsum("nij,nj->ni", self._axes(positions), self._offsets))

    def _axes(self, positions: Floats64) -> Floats64:
        a, b, c = positions[self._places.corners].swapaxes(0, 1)
        first = unit_vectors(b - a)
        normal = unit_vectors(np.cross(b - a, c - a))
        return np.stack([first, np.cross(normal, first), normal], axis=2)


def measure() -> list[EmbeddingRow]:
    """Move the fine mesh of every surface by every map, and measure the errors."""
    rows = []
    for name, (rest, faces), (fine, _), maps in EMBEDDING_CASES:
        ours = refine.Embedding(faces, rest, fine)
        flat = FlatBinding(faces, rest, fine)
        for bend in maps:
            positions = bend(rest)
            truth = bend(fine)
            size = float(np.ptp(truth, axis=0).max())
            found = ours.evaluate(positions).positions
            flatly = flat.evaluate(positions, offset=True)
            without = flat.evaluate(positions, offset=False)
            rows.append(
                EmbeddingRow(
                    surface=name,
                    map=bend.__name__,
                    triangles=len(faces),
                    points=len(fine),
                    ours=_root_mean_square(found - truth) / size,
                    with_offset=_root_mean_square(flatly - truth) / size,
                    without_offset=_root_mean_square(without - truth) / size,
                    milliseconds=_milliseconds(ours, positions),
                )
            )
    return rows


def report(rows: list[EmbeddingRow]) -> str:
    """A table of errors."""
    columns = (
        "surface:<9|map:<10|coarse:7d|fine:7d|ours:8.0f|flat + offset:14.0f|flat:8.0f|"
        "flat + offset by ours:22.1f|ms:6.2f"
    )
    cells = [
        (
            *row[:4],
            *(1e6 * error for error in row[4:7]),
            row.with_offset / row.ours,
            row.milliseconds,
        )
        for row in rows
    ]
    title = "Distance of fine vertices from their true places, root mean square,"
    unit = "in millionths of the size of the surface"
    return "\n".join([title, unit, "", *table(columns, cells), "", f"on {processor()}"])


def targets(rows: list[EmbeddingRow]) -> list[Target]:
    """The targets: where the surface bends, a third of the error of flat binding with an offset."""
    least = min(row.with_offset / row.ours for row in rows)
    return [at_least("flat binding with offset by ours", least, 3.0)]


def _milliseconds(embedding: refine.Embedding, positions: Floats64) -> float:
    times = []
    for _ in range(ROUND_COUNT):
        start = time.perf_counter()
        embedding.evaluate(positions)
        times.append(time.perf_counter() - start)
    return 1e3 * float(np.median(times))


def _root_mean_square(vectors: Floats64) -> float:
    return float(np.sqrt((vectors**2).sum(axis=1).mean()))
