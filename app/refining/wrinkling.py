"""Wrinkles that come from the physics: how far the simulated skin is shortened, so far it folds.

    simulated mesh ─> refine.Shortening ─> amount at each vertex ─> rows of the refined mesh
                                                 │                        │
                              where edges split <┘                        ├─> moved by the relief
                     assets: map of furrows over the texture ─────────────┴─> render

The furrows stick to the skin, because their map does; only the amounts change from frame to frame.
What is broad enough for triangles is shape: rows are moved along their normals by the relief, which
is the map's height, smoothed. Rows are shared by triangles, and those along a seam of the texture,
which are not, stay where they are; so nothing can crack. Normals stay those of the smooth surface,
because the map, which holds all slopes, tilts them where pixels are drawn.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from risorius import assets, refine
from risorius.assets.model import HIGHEST_FOLD
from risorius.geometry.normals import vertex_normals

from ..scenes import Scene
from .presets import Refinement

Amounts = npt.NDArray[np.float32]
Points = npt.NDArray[np.float64]

# Chosen by eye. Skin gives way a little before it folds, and a fold does not deepen for ever.
ONSET, HALF = 0.015, 0.09  # loss of length at which furrows begin, and beyond which they are half
FLAT = 0.1  # gain of length at which furrows of age are half as deep: taut skin has none
LEAST_BEND = 0.07  # [mm] of a fold over an edge, above which it is split; the most that can pop
PLACES = np.linspace(0.0, 1.0, 17, dtype=np.float32)  # along an edge, where the relief is looked up


class Compression:
    """How far the skin of a scene that has wrinkles is compressed across them."""

    def __init__(self, scene: Scene) -> None:
        wrinkles = scene.wrinkles
        assert wrinkles is not None
        self._readiness = np.linalg.norm(wrinkles.across, axis=2)
        if scene.face_uv is not None:
            self._readiness[_seam_vertices(scene.faces, scene.face_uv)] = 0.0
        self._resting = wrinkles.resting * np.minimum(self._readiness, 1.0)
        self._shortening = refine.Shortening(scene.faces, scene.rest_positions, wrinkles.across)
        self._seen = np.empty((0, 3))  # what was asked for last,
        self._found = np.empty((0, 2), np.float32)  # and told: a frame asks twice

    def amounts(self, positions: Points) -> Amounts:
        """How far each vertex wrinkles in either slot, 0 (not at all) to 1, shape (V, 2).

        It begins and ends without a kink: nothing pops. Read only.
        """
        if not np.array_equal(positions, self._seen):
            self._seen, self._found = positions.copy(), self._measured(positions)
            self._found.flags.writeable = False
        return self._found

    def _measured(self, positions: Points) -> Amounts:
        """Of what was not asked for last."""
        lost = self._shortening.measure(positions)
        beyond = np.square(np.maximum(self._readiness * lost - ONSET, 0.0))
        amounts = beyond / (beyond + (HALF - ONSET) ** 2)
        resting = self._resting / (1.0 + np.square(np.minimum(lost, 0.0) / FLAT))
        shown: Amounts = np.maximum(amounts, resting).astype(np.float32)
        return shown


class Relief:
    """The shape of wrinkles: a height over the texture coordinates for either amount."""

    def __init__(self, wrinkles: assets.Wrinkles) -> None:
        self._steps = wrinkles.relief
        self._unit = np.float32(HIGHEST_FOLD / 127.0)

    def heights(self, uv: Amounts) -> Amounts:
        """The heights where all of a wrinkle shows [mm], between texels, for uv of (n, 2): same."""
        rows, columns = self._steps.shape[:2]
        x = np.clip(columns * uv[:, 0] - 0.5, 0.0, columns - 1.001)
        y = np.clip(rows * (1.0 - uv[:, 1]) - 0.5, 0.0, rows - 1.001)
        left, top = x.astype(np.int32), y.astype(np.int32)
        right_share, low_share = (x - left)[:, None], (y - top)[:, None]
        upper = _mixed(self._steps[top, left], self._steps[top, left + 1], right_share)
        lower = _mixed(self._steps[top + 1, left], self._steps[top + 1, left + 1], right_share)
        return self._unit * _mixed(upper, lower, low_share)

    def move(self, mesh: refine.RefinedMesh, rows: Amounts) -> None:
        """Move what was refined along its normals, by the amounts of its rows, shape (N, 2)."""
        assert mesh.uv is not None
        folded = np.flatnonzero(rows.any(axis=1))
        height = (rows[folded] * self.heights(mesh.uv[folded])).sum(axis=1, keepdims=True)
        mesh.positions[folded] += height * mesh.normals[folded]

    def carve(self, mesh: refine.RefinedMesh, rows: Amounts) -> None:
        """Move it and turn its normals, too, for programs that know nothing of the map."""
        smooth = vertex_normals(mesh.positions.astype(np.float64), mesh.triangles)
        self.move(mesh, rows)
        folded = vertex_normals(mesh.positions.astype(np.float64), mesh.triangles)
        turned = mesh.normals + folded - smooth
        length = np.linalg.norm(turned, axis=1, keepdims=True)
        np.divide(turned, length, out=mesh.normals, where=length > 0.0)


class FoldCriterion(refine.Criterion):
    """Splits edges over which the relief, as far as it shows, bends away from the straight line."""

    uses_normals = False

    def __init__(self, scene: Scene, compression: Compression) -> None:
        assert scene.wrinkles is not None and scene.uv is not None and scene.face_uv is not None
        self._compression, self._relief = compression, Relief(scene.wrinkles)
        self._uv = np.zeros((len(scene.rest_positions), 2), np.float32)
        self._uv[scene.faces] = scene.uv[scene.face_uv]  # any of those that a seam's vertex has

    def bind(
        self, connectivity: refine.Connectivity, rest_positions: Points, rest_normals: Amounts
    ) -> None:
        """Find how far the relief bends over every edge, and over its halves."""
        first, second = (self._uv[connectivity.edges[:, k], None] for k in (0, 1))
        along = _mixed(first, second, PLACES[:, None])
        heights = self._relief.heights(along.reshape(-1, 2)).reshape(*along.shape[:2], 2)
        middle = len(PLACES) // 2
        once = _bends(heights)
        twice = np.maximum(_bends(heights[:, : middle + 1]), _bends(heights[:, middle:]))
        self._folding = np.flatnonzero(once.sum(axis=1) > LEAST_BEND)  # no other is ever split
        self._edges = connectivity.edges[self._folding]
        self._once, self._twice = once[self._folding], twice[self._folding]

    def measure(self, positions: Points, normals: Amounts, metric: Amounts) -> None:
        """Write the refinement metric of every edge, shape (E,): above 0 one split, above 1 two."""
        shown = self._compression.amounts(positions)[self._edges].mean(axis=1) / LEAST_BEND
        once, twice = ((shown * bends).sum(axis=1) for bends in (self._once, self._twice))
        metric[:] = -np.inf
        metric[self._folding] = np.maximum(np.minimum(once - 1.0, 1.0), 2.0 * twice - 1.0)


def _mixed(first: npt.NDArray[Any], second: npt.NDArray[Any], share: npt.NDArray[Any]) -> Amounts:
    mixed: Amounts = (1.0 - share) * first + share * second
    return mixed


def _bends(heights: Amounts) -> Amounts:
    """How far heights along lines, (E, n, 2), are at most from the straight between their ends."""
    straight = _mixed(heights[:, :1], heights[:, -1:], np.linspace(0, 1, heights.shape[1])[:, None])
    bends: Amounts = np.abs(heights - straight).max(axis=1).astype(np.float32)
    return bends


def _seam_vertices(
    faces: npt.NDArray[np.int32], face_uv: npt.NDArray[np.int32]
) -> npt.NDArray[np.int32]:
    """The vertices with more than one texture coordinate."""
    pairs = np.unique(np.column_stack([faces.ravel(), face_uv.ravel()]), axis=0)
    vertices, counts = np.unique(pairs[:, 0], return_counts=True)
    return vertices[counts > 1]


def on_rows(amounts: Amounts, refiner: refine.Refiner) -> Amounts | None:
    """The amounts for what `refiner` made last, shape (N, 2); None where nothing wrinkles."""
    if not amounts.any():
        return None
    vertices, weights = refiner.origins()
    corners = [np.take(amounts, vertices[:, i], axis=0) * weights[:, i : i + 1] for i in range(3)]
    rows: Amounts = corners[0] + corners[1] + corners[2]
    return rows


def relief_of(scene: Scene, refinement: Refinement) -> Relief | None:
    """The shape of the scene's wrinkles; None where it has none, or the preset shows none."""
    if scene.wrinkles is None or not refinement.raises_wrinkles(scene.name):
        return None
    return Relief(scene.wrinkles)
