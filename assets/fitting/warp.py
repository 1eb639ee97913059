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

from risorius.geometry.closest import SurfacePoints, closest_points

from ..model import FloatArray, IndexArray

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


def nearest_on(
    points: FloatArray, normals: FloatArray, vertices: FloatArray, faces: IndexArray
) -> SurfacePoints:
    """Feet of points (n, 3) on a mesh; a surface that faces away from a point's normal is farther.

    So the lower lip's points find the lower lip though the upper one is nearer.
    """
    return closest_points(points, vertices, faces, normals, WRONG_SIDE)
