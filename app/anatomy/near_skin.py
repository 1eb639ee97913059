"""Where the skin is, seen from places under it: how muscles know how deep they lie."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import scipy

from risorius.geometry.normals import vertex_normals
from risorius.jit import njit

Floats = npt.NDArray[np.float64]
Numbers = npt.NDArray[np.int64]
NEIGHBOURS = 8  # vertices that say where the skin is


class Skin:
    """The skin as it is now, near places."""

    def __init__(
        self, x: Floats, faces: npt.NDArray[np.int32], bone: Floats, middle: Floats
    ) -> None:
        """bone: how deep it is below each vertex of x; middle: from where a face looks outward."""
        self.x, self._bone, self._middle = x, bone, middle
        self.normals = vertex_normals(x, faces)
        self._tree = scipy.spatial.cKDTree(x)

    def near(self, points: Floats) -> Numbers:
        """The vertices near points (..., 3), NEIGHBOURS of each."""
        numbers: Numbers = self._tree.query(points, k=NEIGHBOURS)[1]
        return numbers

    def at(self, points: Floats, near: Numbers) -> tuple[Floats, Floats, Floats]:
        """How far outside points (..., 3) are, which way is out, and how deep the bone is there.

        near: vertices near them, for all points or for all of the last of their rows.
        """
        rows, numbers = points.reshape(-1, 3), near.reshape(-1, NEIGHBOURS)
        found = _on_skin(rows, numbers, self.x, self.normals, self._bone, self._middle)
        found = found.reshape(*points.shape[:-1], 5)
        return found[..., 0], found[..., 1:4], found[..., 4]


@njit
def _on_skin(
    points: Floats, near: Numbers, x: Floats, normals: Floats, bone: Floats, middle: Floats
) -> Floats:
    """For each point how far outside it is, the skin's normal, and the depth of bone, (n, 5)."""
    result = np.zeros((len(points), 5))
    count = near.shape[1]
    off, square = np.zeros((count, 3)), np.zeros(count)
    for n in range(len(points)):
        numbers, own = near[n % len(near)], result[n]
        out_x, out_y, out_z = points[n] - middle
        for k in range(count):
            square[k] = 0.0
            for c in range(3):
                off[k, c] = points[n, c] - x[numbers[k], c]
                square[k] += off[k, c] ** 2
        reach, total = 0.35 * square.max(), 0.0
        for k in range(count):
            v = numbers[k]
            nx, ny, nz = normals[v]
            # What turns away, as the inner side of lips, lids and nostrils does, is not meant.
            is_faced = nx * out_x + 0.25 * ny * out_y + nz * out_z > 0.0
            weight = 1e-9 + (np.exp(-square[k] / reach) if is_faced else 0.0)
            own[0] += weight * (off[k, 0] * nx + off[k, 1] * ny + off[k, 2] * nz)
            own[1] += weight * nx
            own[2] += weight * ny
            own[3] += weight * nz
            own[4] += weight * bone[v]
            total += weight
        length = np.sqrt(own[1] ** 2 + own[2] ** 2 + own[3] ** 2)
        own[0] /= total
        own[4] /= total
        for c in range(1, 4):
            own[c] /= max(length, 1e-9 * total)
    return result
