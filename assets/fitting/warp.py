"""Map one head to another: similarity by landmarks, thin-plate warp, nearest points.

The warp moves the landmarks of the built-in head exactly to those of another head, and bends the
space between them as little as possible. For a vertex of the other head, the nearest point on the
warped skin then gives depth of bone, weights and texture coordinates.

Source: Kähler, Haber, Yamauchi, Seidel 2002, "Head shop", section 4 (landmarks carry a head model
to another head by interpolation of scattered data; the biharmonic kernel r is used here). Umeyama
1991 (similarity between point sets).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy

from ...geometry.arrays import Floats64, Integers32
from ...geometry.closest import SurfacePoints, closest_points
from ...geometry.distance_sums import subtract_distances
from ...geometry.read_only import make_read_only


@dataclass(frozen=True, eq=False)
class Similarity:
    """The map x -> scale * rotation x + shift; the rotation may also mirror."""

    scale: float
    rotation: Floats64  # (3, 3)
    shift: Floats64  # (3,)

    def __post_init__(self) -> None:
        make_read_only(self)

    @classmethod
    def between(cls, source: Floats64, target: Floats64) -> Similarity:
        """Find the similarity that moves `source` closest to `target`, both (n, 3).

        If `target` is a mirror image of `source`, the similarity mirrors.
        """
        centre = source.mean(axis=0)
        target_centre = target.mean(axis=0)
        a = source - centre
        b = target - target_centre
        u, stretch, v = np.linalg.svd(b.T @ a)
        rotation = u @ v
        scale = float(stretch.sum() / (a * a).sum())
        return cls(scale, rotation, target_centre - scale * rotation @ centre)

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
        """Map points, (..., 3)."""
        return self.vectors(points) + self.shift

    def vectors(self, vectors: npt.ArrayLike) -> Floats64:
        """Rotate and scale displacements, (..., 3)."""
        return self.scale * (np.asarray(vectors, dtype=np.float64) @ self.rotation.T)


class ThinPlateSpline:
    """The smoothest deformation of space that moves given points onto, or close to, other points.

    It is the sum of an affine map and of weighted distances from the given points. The class
    `scipy.interpolate.RBFInterpolator` with the kernel "linear" computes the same, several times
    slower.
    """

    def __init__(self, source: Floats64, target: Floats64, give: float | Floats64 = 0.0) -> None:
        """Fit the deformation from `source` to `target`, both (n, 3).

        If points in `source` are equal, only the first is used. give: smoothing, a number or (n,)
        [unit of `source`]; with more smoothing, points may miss their targets by more. If all
        points lie in one plane, raises LinAlgError.
        """
        _, first = np.unique(source.round(6), axis=0, return_index=True)
        first = np.sort(first)
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
        diagonal = np.arange(count)
        system[diagonal, diagonal] += np.broadcast_to(give, len(source))[first]
        system[count:, :count] = rows[:, count:].T
        wanted = np.zeros((width, 3))
        wanted[:count] = target[first]
        *_, weights, failed = scipy.linalg.lapack.dgesv(system, wanted)
        if failed:
            raise np.linalg.LinAlgError("the points lie in a plane")
        self._points = tuple(self._source.T.copy())
        self._pulls = tuple(weights[:count].T.copy())
        self._affine = weights[count:]

    def points(self, points: npt.ArrayLike) -> Floats64:
        """Deform points (n, 3)."""
        places = np.array(points, dtype=np.float64, order="C")
        relative = (places - self._middle) / self._half
        moved: Floats64 = self._affine[0] + relative @ self._affine[1:]
        subtract_distances(places, self._points, self._pulls, moved)
        return moved

    def _rows(self, places: Floats64) -> Floats64:
        """Evaluate the basis functions at points (n, 3); shape (n, number of given points + 4)."""
        count = len(self._source)
        rows = np.empty((len(places), count + 4))
        rows[:, :count] = -scipy.spatial.distance.cdist(places, self._source)
        rows[:, count] = 1.0
        rows[:, count + 1 :] = (places - self._middle) / self._half
        return rows


def nearest_on(
    points: Floats64, normals: Floats64, vertices: Floats64, faces: Integers32
) -> SurfacePoints:
    """Find the nearest points of a mesh for points (n, 3) with normals (n, 3).

    Surfaces with opposite normals count as farther, so points of the lower lip find the lower lip
    even if the upper lip is nearer.
    """
    wrong_side_distance = 12.0  # [mm] added to the distance of surfaces with opposite normals
    return closest_points(points, vertices, faces, normals, wrong_side_distance)


def landmark_warp(
    source: Floats64, target: Floats64, give: float | Floats64 = 0.0
) -> ThinPlateSpline:
    """Return the deformation from the landmarks of one face to those of another, both (68, 3) [mm].

    Brows keep their height where they lie lower over the eyes: points above and below them stay as
    far away. Without these, a brow would be pressed together as much as the skin down to the lid.

    give: smoothing at each landmark, see ThinPlateSpline.
    """
    brows = np.arange(17, 27)
    upper_lids = [36, 37, 37, 38, 39, 42, 43, 44, 44, 45]  # landmarks below those of brows
    up = np.array([0.0, 1.0, 0.0])
    height = 5.0  # [mm]: a little more than half the height of a brow
    most_share = 0.6  # of the way from brow to lid
    over_lid = target[brows, 1] - target[upper_lids, 1]
    below = np.clip(most_share * over_lid, 0.0, height)[:, None]
    gives = np.broadcast_to(give, len(source)).copy()
    gives[brows] *= 3.0  # three points with one error count as one
    return ThinPlateSpline(
        np.vstack([source, source[brows] + height * up, source[brows] - height * up]),
        np.vstack([target, target[brows] + height * up, target[brows] - below * up]),
        np.concatenate([gives, gives[brows], gives[brows]]),
    )
