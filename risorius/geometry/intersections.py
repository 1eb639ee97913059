"""Self-intersections of a surface.

Source of `near_pairs`: Cohen, Lin, Manocha, Ponamgi 1995, "I-COLLIDE", Symposium on Interactive 3D
Graphics: boxes are sorted along one axis, and each box is compared with the boxes that begin before
it ends.
"""

import numpy as np
import numpy.typing as npt

from ..jit import njit
from .arrays import Floats64, Integers32, Integers64
from .rays import cutting
from .read_only import read_only


def self_intersections(vertices: npt.NDArray[np.floating], faces: Integers32) -> Integers32:
    """Pairs of faces (F, 3) without a common vertex that cut through each other, shape (k, 2)."""
    corners = np.asarray(vertices, dtype=np.float64)[faces]
    pairs = near_pairs(corners)
    return np.asarray(pairs[cutting(corners, read_only(faces), pairs)], np.int32)


def near_pairs(corners: Floats64) -> Integers64:
    """Pairs of triangles (F, 3, 3) with touching boxes, each once, lower number first, (k, 2)."""
    low = corners.min(axis=1)
    high = corners.max(axis=1)
    order = np.argsort(low[:, 0])
    low = low[order]
    high = high[order]
    pairs = np.empty((8 * len(corners), 2), np.int64)  # more than on most surfaces
    found = _sweep_boxes(low, high, pairs)
    if found > len(pairs):
        pairs = np.empty((found, 2), np.int64)
        _sweep_boxes(low, high, pairs)
    return np.sort(order[pairs[:found]], axis=1)


@njit
def _sweep_boxes(low: Floats64, high: Floats64, pairs: Integers64) -> int:
    """Count touching pairs of boxes (n, 3), sorted by low x, and fill `pairs` up to its size."""
    found = 0
    for one in range(len(low)):
        for other in range(one + 1, len(low)):
            if low[other, 0] > high[one, 0]:
                break
            if low[other, 1] > high[one, 1] or high[other, 1] < low[one, 1]:
                continue
            if low[other, 2] > high[one, 2] or high[other, 2] < low[one, 2]:
                continue
            if found < len(pairs):
                pairs[found, 0] = one
                pairs[found, 1] = other
            found += 1
    return found
