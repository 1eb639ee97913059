"""Map one head to another: similarity by landmarks, thin-plate warp, nearest places.

The warp takes the built-in head's landmarks exactly to those of another head, and bends the space
in between as little as possible. The nearest point of the warped skin then gives depth of bone,
weights and texture coordinates.

Source: Kähler, Haber, Yamauchi, Seidel 2002, "Head shop", section 4 (landmarks carry a head model
to another head by scattered data interpolation, here the biharmonic kernel r); Umeyama 1991
(similarity between point sets).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy

from risorius.geometry.closest import SurfacePoints, closest_points
from risorius.geometry.distances import distances_between
from risorius.geometry.read_only import make_read_only

from ...geometry.arrays import Floats64, Integers32


@dataclass(frozen=True, eq=False)
class Similarity:
    """x -> scale * rotation x + shift."""

    scale: float
    rotation: Floats64  # (3, 3)
    shift: Floats64  # (3,)

    def __post_init__(self) -> None:
        make_read_only(self)

    @classmethod
    def between(cls, source: Floats64, target: Floats64) -> Similarity:
        """The similarity that moves `source` nearest to `target`, both (n, 3).

        It mirrors if `target` is the mirror image of `source`.
        """
        middle = source.mean(axis=0)
        wanted = target.mean(axis=0)
        a = source - middle
        b = target - wanted
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
        """The inverse similarity."""
        back = self.rotation.T / self.scale
        return Similarity(1.0 / self.scale, self.rotation.T, -back @ self.shift)

    def points(self, points: npt.ArrayLike) -> Floats64:
        """Move points, shape (..., 3)."""
        return self.vectors(points) + self.shift

    def vectors(self, vectors: npt.ArrayLike) -> Floats64:
        """Turn and scale displacements, shape (..., 3)."""
        return self.scale * (np.asarray(vectors, dtype=np.float64) @ self.rotation.T)


class ThinPlateSpline:
    """The smoothest deformation of space that moves some points to others, or near them.

    It is a weighted sum of distances from the points, and a linear map.
    `scipy.interpolate.RBFInterpolator` with the kernel "linear" gives the same, but takes several
    times as long.
    """

    def __init__(self, source: Floats64, target: Floats64, give: float | Floats64 = 0.0) -> None:
        """Fit the deformation from `source` to `target`, both (n, 3), not in one plane.

        Of equal points in `source`, the first counts. give: smoothing, one number or (n,) [unit of
        `source`]; where it is larger, points may miss their targets by more. Raises LinAlgError for
        points in a plane.
        """
        first = np.sort(np.unique(source.round(6), axis=0, return_index=True)[1])
        self._source = np.asarray(source[first], dtype=np.float64)
        low = self._source.min(axis=0)
        high = self._source.max(axis=0)
        self._middle = (high + low) / 2.0
        half = (high - low) / 2.0
        self._half = np.where(half == 0.0, 1.0, half)
        rows = self._rows(self._source)
        count, width = rows.shape
        system = np.zeros((width, width))
        system[:count] = rows
        system[np.arange(count), np.arange(count)] += np.broadcast_to(give, len(source))[first]
        system[count:, :count] = rows[:, count:].T
        wanted = np.zeros((width, 3))
        wanted[:count] = target[first]
        *_, self._weights, failed = scipy.linalg.lapack.dgesv(system, wanted)
        if failed:
            raise np.linalg.LinAlgError("the points lie in a plane")

    def points(self, points: npt.ArrayLike) -> Floats64:
        """Move points (n, 3)."""
        places = np.asarray(points, dtype=np.float64)
        at_once = 128  # points whose rows fit into the caches
        parts = range(0, len(places), at_once)
        moved = [self._rows(places[k : k + at_once]) @ self._weights for k in parts]
        return np.concatenate([np.empty((0, 3)), *moved])

    def _rows(self, places: Floats64) -> Floats64:
        """The factors of the weights at places (n, 3), shape (n, count of points + 4)."""
        count = len(self._source)
        rows = np.empty((len(places), count + 4))
        np.negative(distances_between(places, self._source), out=rows[:, :count])
        rows[:, count] = 1.0
        rows[:, count + 1 :] = (places - self._middle) / self._half
        return rows


def nearest_on(
    points: Floats64, normals: Floats64, vertices: Floats64, faces: Integers32
) -> SurfacePoints:
    """Nearest places of points (n, 3) on a mesh; surfaces with opposite normals count as farther.

    So points of the lower lip find the lower lip even if the upper lip is nearer.
    """
    wrong_side_distance = 12.0  # [mm] added to the distance of a surface with an opposite normal
    return closest_points(points, vertices, faces, normals, wrong_side_distance)
