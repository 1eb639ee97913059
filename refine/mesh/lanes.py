"""Vectors in rows of four numbers, the last of which is zero.

A processor reads, adds and writes four single-precision numbers at once, but three numbers one by
one. Kernels compiled with `njit(lanes=True)` take vectors from such rows. They read all inputs of a
result before they write it. The results equal computations with three numbers to the last bit.
"""

import numpy as np

from ...geometry.arrays import Floats32
from ...geometry.vectors import ONE, ROW_WIDTH, Number, is_representable
from ...jit import njit

LANE_WIDTH = 4
"""Columns of a row. A kernel that asserts this width is faster, because the compiler knows the row
stride.
"""

Lanes = tuple[np.float32, np.float32, np.float32, np.float32]
"""Three numbers and zero."""


@njit
def copy_into_lanes(first: int, last: int, vectors: Floats32, rows: Floats32) -> None:
    """Copy vectors, shape (N, 3), into rows of lanes, shape (N, 4), whose last column is zero."""
    assert vectors.shape[1] == ROW_WIDTH and rows.shape[1] == LANE_WIDTH
    for k in range(first, last):
        rows[k, 0] = vectors[k, 0]
        rows[k, 1] = vectors[k, 1]
        rows[k, 2] = vectors[k, 2]


@njit(lanes=True)
def lanes_of(rows: Floats32, k: Number) -> Lanes:
    """Row k of rows of lanes, shape (N, 4)."""
    return rows[k, 0], rows[k, 1], rows[k, 2], rows[k, 3]


@njit(lanes=True)
def sum_of(u: Lanes, v: Lanes) -> Lanes:
    """Sum of two vectors."""
    return u[0] + v[0], u[1] + v[1], u[2] + v[2], u[3] + v[3]


@njit(lanes=True)
def scaled(factor: np.float32, v: Lanes) -> Lanes:
    """Product of a vector and a number."""
    return factor * v[0], factor * v[1], factor * v[2], factor * v[3]


@njit(lanes=True)
def unit_if_representable(v: Lanes, squared: np.float32) -> Lanes:
    """Normalise a vector if single precision holds its square; other vectors stay."""
    return scaled(ONE / np.sqrt(squared if is_representable(squared) else ONE), v)


@njit(lanes=True)
def write_point(rows: Floats32, k: Number, position: Lanes, normal: Lanes) -> None:
    """Write position and normal of row k of the output."""
    rows[k, 0] = position[0]
    rows[k, 1] = position[1]
    rows[k, 2] = position[2]
    rows[k, 3] = normal[0]
    rows[k, 4] = normal[1]
    rows[k, 5] = normal[2]
