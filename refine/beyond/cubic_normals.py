"""Vertex normals for cubic edges: weighted as at rest, and moved away from their neighbours.

cubic.py explains both.
"""

import numpy as np

from ...geometry.arrays import Floats32, Floats64, Unsigned32
from ...geometry.vectors import ROW_WIDTH, ZERO, less, plus, row_of, times, write_row
from ...jit import njit
from ..kahler.look_up import SIDE_BITS, SIDE_MASK
from ..mesh.normals import cross_product, normalise


@njit
def cross_products(
    first: int, last: int, positions: Floats64, faces: Unsigned32, crosses: Floats32
) -> None:
    """Write the normals of triangles times twice their areas, shape (F, 3)."""
    for t in range(first, last):
        write_row(crosses, t, cross_product(positions, faces[t, 0], faces[t, 1], faces[t, 2]))


@njit
def weighted_normals(
    first: int,
    last: int,
    starts: Unsigned32,
    corners: Unsigned32,
    weights: Floats32,
    crosses: Floats32,
    normals: Floats32,
) -> None:
    """Write unit vertex normals, each corner weighted as at rest, shape (V, 3).

    starts, corners: the corners of triangles at each vertex, as in mesh/fans.py.
    """
    assert weights.shape[1] == crosses.shape[1] == normals.shape[1] == ROW_WIDTH
    for k in range(first, last):
        v = np.uint32(k)
        total = ZERO, ZERO, ZERO
        for corner in corners[starts[v] : starts[v + 1]]:
            t = corner >> SIDE_BITS
            weight = weights[t, corner & SIDE_MASK]
            total = plus(total, times(weight, row_of(crosses, t)))
        write_row(normals, v, total)
    normalise(normals[first:last])


@njit
def steepen_normals(
    first: int,
    last: int,
    starts: Unsigned32,
    neighbours: Unsigned32,
    normals: Floats32,
    steeper: Floats32,
    off: Floats32,
) -> None:
    """Write unit normals minus `off` times the sum around them, normalised, shape (V, 3)."""
    assert normals.shape[1] == steeper.shape[1] == ROW_WIDTH
    for k in range(first, last):
        v = np.uint32(k)
        total = ZERO, ZERO, ZERO
        for neighbour in neighbours[starts[v] : starts[v + 1]]:
            total = plus(total, row_of(normals, neighbour))
        write_row(steeper, v, less(row_of(normals, v), off[v], total))
    normalise(steeper[first:last])
