"""Distances between all points of one set and all points of another."""

import numpy as np

from ..jit import njit
from .arrays import Floats64


def distances_between(points: Floats64, others: Floats64) -> Floats64:
    """Return the distances of points (n, 3) from others (m, 3), shape (n, m)."""
    found = np.empty((len(points), len(others)))
    _fill(np.ascontiguousarray(points), np.ascontiguousarray(others.T), found)
    return found


@njit
def _fill(points: Floats64, others: Floats64, found: Floats64) -> None:
    """Fill distances; others: (3, m), because the compiler vectorises loops over these rows."""
    x = others[0]
    y = others[1]
    z = others[2]
    for n in range(len(points)):
        for m in range(len(x)):
            dx = points[n, 0] - x[m]
            dy = points[n, 1] - y[m]
            dz = points[n, 2] - z[m]
            found[n, m] = np.sqrt(dx * dx + dy * dy + dz * dz)
