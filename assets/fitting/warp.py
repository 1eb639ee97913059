"""From head to head: similarity by landmarks, thin-plate warp, and what lies where on a surface.

The warp takes the built-in head's landmarks exactly to those of another head and bends space in
between as little as possible; depth of bone, weights and texture coordinates are then read off at
the nearest point of the warped skin.

Source: Kähler, Haber, Yamauchi, Seidel 2002, "Head shop", section 4 (landmarks carry a head model
to another head by scattered data interpolation, here the biharmonic kernel r); Umeyama 1991
(similarity between point sets).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt
import scipy

from ..model import FloatArray, IndexArray
from ..topology import cross_products

CANDIDATES = 12  # triangles whose centres are nearest: the nearest triangle is one of them
WRONG_SIDE = 12.0  # [mm] that a point seems farther away where the surface faces the other way


@dataclass(frozen=True)
class Similarity:
    """x -> scale * rotation x + shift."""

    scale: float
    rotation: FloatArray  # (3, 3)
    shift: FloatArray  # (3,)

    @classmethod
    def between(cls, source: FloatArray, target: FloatArray) -> Similarity:
        """The one that brings points (n, 3) nearest to others; its determinant may be negative.

        That happens where `target` is the mirror image of `source`.
        """
        middle, wanted = source.mean(axis=0), target.mean(axis=0)
        a, b = source - middle, target - wanted
        u, stretch, v = np.linalg.svd(b.T @ a)
        rotation = u @ v
        scale = float(stretch.sum() / (a * a).sum())
        return cls(scale, rotation, wanted - scale * rotation @ middle)

    @property
    def is_mirrored(self) -> bool:
        """Whether left and right are exchanged."""
        return bool(np.linalg.det(self.rotation) < 0.0)

    @property
    def inverse(self) -> Similarity:
        """The way back."""
        back = self.rotation.T / self.scale
        return Similarity(1.0 / self.scale, self.rotation.T, -back @ self.shift)

    def points(self, points: npt.ArrayLike) -> FloatArray:
        """Points moved, shape (..., 3)."""
        return self.vectors(points) + self.shift

    def vectors(self, vectors: npt.ArrayLike) -> FloatArray:
        """Displacements turned and scaled, shape (..., 3)."""
        return self.scale * (np.asarray(vectors, dtype=np.float64) @ self.rotation.T)


class Deformation(Protocol):
    """Anything that says where the points of space come to lie."""

    def points(self, points: npt.ArrayLike) -> FloatArray:
        """Where points (n, 3) come to lie."""
        ...


class Warp:
    """The smoothest deformation of space that takes some points to others, or near them."""

    def __init__(
        self, source: FloatArray, target: FloatArray, give: float | FloatArray = 0.0
    ) -> None:
        """Both (n, 3), in no plane; of equal points of `source` the first one counts.

        give: how readily points miss their targets where the deformation is less smooth, of all or
        each (n,) [unit of `source`].
        """
        give = np.full(len(source), give)
        first = np.sort(np.unique(source.round(6), axis=0, return_index=True)[1])
        source, target, give = source[first], target[first], give[first]
        count = len(source)
        self._centres = source
        ones = np.hstack([np.ones((count, 1)), source])
        system = np.zeros((count + 4, count + 4))
        # The kernel r is negative where others are positive: so is what makes it give.
        system[:count, :count] = _distances(source, source) - np.diag(give)
        system[:count, count:] = ones
        system[count:, :count] = ones.T
        right = np.vstack([target, np.zeros((4, 3))])
        self._weights: FloatArray = np.asarray(np.linalg.solve(system, right), np.float64)
        self._bent: FloatArray = system[:count, :count] @ self._weights[:count]

    @property
    def bending(self) -> float:
        """How much it bends, in squares of the target's unit over the source's; 0: not at all."""
        return -float((self._weights[: len(self._centres)] * self._bent).sum())

    def points(self, points: npt.ArrayLike) -> FloatArray:
        """Where points (n, 3) come to lie."""
        x = np.asarray(points, dtype=np.float64)
        count = len(self._centres)
        bent: FloatArray = _distances(x, self._centres) @ self._weights[:count]
        bent = bent + (self._weights[count] + x @ self._weights[count + 1 :])
        return bent


def _distances(a: FloatArray, b: FloatArray) -> FloatArray:
    distances: FloatArray = np.sqrt(((a[:, None] - b[None]) ** 2).sum(axis=2))
    return distances


@dataclass(frozen=True)
class SurfacePoints:
    """For each of n points, where on a triangle mesh it lies nearest."""

    corners: IndexArray  # (n, 3) vertices of the triangle
    weights: FloatArray  # (n, 3) barycentric coordinates in it

    def interpolate(self, values: npt.NDArray[np.floating]) -> FloatArray:
        """Values of the mesh's vertices, (V,) or (V, k), at the points."""
        carried: FloatArray = np.einsum(
            "nc,nc...->n...", self.weights, np.asarray(values, dtype=np.float64)[self.corners]
        )
        return carried


def nearest_on(
    points: FloatArray, normals: FloatArray, vertices: FloatArray, faces: IndexArray
) -> SurfacePoints:
    """Feet of points (n, 3) on a mesh; a surface that faces away from a point's normal is farther.

    So the lower lip's points find the lower lip though the upper one is nearer.
    """
    corners = vertices[faces]
    directions = cross_products(vertices, faces)
    directions /= np.maximum(np.linalg.norm(directions, axis=1, keepdims=True), 1e-12)
    count = min(CANDIDATES, len(faces))
    near = (
        scipy.spatial.cKDTree(corners.mean(axis=1))
        .query(points, k=count)[1]
        .reshape(len(points), count)
    )
    best = np.full(len(points), np.inf)
    chosen = np.zeros(len(points), dtype=np.int64)
    weights = np.zeros((len(points), 3))
    for column in near.T:
        found = _barycentric(points, corners[column])
        foot = np.einsum("nc,ncd->nd", found, corners[column])
        facing = (directions[column] * normals).sum(axis=1)
        cost = np.linalg.norm(points - foot, axis=1) + WRONG_SIDE * np.clip(0.3 - facing, 0.0, 1.0)
        is_better = cost < best
        best = np.where(is_better, cost, best)
        chosen = np.where(is_better, column, chosen)
        weights = np.where(is_better[:, None], found, weights)
    return SurfacePoints(faces[chosen], weights)


def _barycentric(points: FloatArray, corners: FloatArray) -> FloatArray:
    """Coordinates of the nearest point of one triangle (n, 3, 3) for each point, shape (n, 3)."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    inside = _in_plane(points, a, b - a, c - a)
    edges = [_on_edge(points, corners, i, (i + 1) % 3) for i in range(3)]
    distances = np.stack(
        [np.linalg.norm(points - np.einsum("nc,ncd->nd", w, corners), axis=1) for w in edges]
    )
    on_edge = np.stack(edges)[distances.argmin(axis=0), np.arange(len(points))]
    is_inside = (inside >= 0.0).min(axis=1, keepdims=True)
    return np.where(is_inside, inside, on_edge)


def _in_plane(points: FloatArray, a: FloatArray, u: FloatArray, v: FloatArray) -> FloatArray:
    """Barycentric coordinates of the foot in the triangle's plane; slivers are left to edges."""
    to = points - a
    uu, uv, vv = (u * u).sum(axis=1), (u * v).sum(axis=1), (v * v).sum(axis=1)
    tu, tv = (to * u).sum(axis=1), (to * v).sum(axis=1)
    area = uu * vv - uv * uv
    is_sliver: npt.NDArray[np.bool_] = area <= 1e-12 * np.maximum(uu * vv, 1e-30)
    area = np.where(is_sliver, 1.0, area)
    second = np.where(is_sliver, -1.0, (vv * tu - uv * tv) / area)
    third = np.where(is_sliver, -1.0, (uu * tv - uv * tu) / area)
    return np.stack([1.0 - second - third, second, third], axis=1)


def _on_edge(points: FloatArray, corners: FloatArray, start: int, end: int) -> FloatArray:
    """Barycentric coordinates of the nearest point of one edge."""
    along = corners[:, end] - corners[:, start]
    length = np.maximum((along * along).sum(axis=1), 1e-30)
    share = np.clip(((points - corners[:, start]) * along).sum(axis=1) / length, 0.0, 1.0)
    weights = np.zeros((len(points), 3))
    weights[:, start], weights[:, end] = 1.0 - share, share
    return weights
