"""Rows of the output that stand for vertices of the input.

A row is x y z, nx ny nz[, attributes]. The output of every built-in refiner begins with one row per
wedge (mesh/seams.py), so that vertex v of the input is row v.
"""

import numpy as np

from ...geometry.arrays import Floats32, Integers32, Unsigned32
from ...jit import njit
from ..mesh.connectivity import Connectivity

GEOMETRY_COLUMNS = 6
"""x y z, nx ny nz: columns of a row before attributes."""


@njit
def copy_along_seams(wedge_vertices: Unsigned32, first: int, rows: Floats32) -> None:
    """Copy position and normal of vertices on texture seams to their other sides.

    `wedge_vertices`: the vertex of every wedge, shape (W,); copies begin at `first`.
    """
    for w in range(first, wedge_vertices.shape[0]):
        for i in range(GEOMETRY_COLUMNS):
            rows[w, i] = rows[wedge_vertices[w], i]


@njit
def spread_over_wedges(values: Floats32, wedge_uv: Integers32, spread: Floats32) -> None:
    """Write `wedge_values` of other values into `spread`, shape (W, k); zeros remain.

    `values`: shape (A, k); `wedge_uv`: row of each wedge in `values`, -1 for none, shape (W,).
    """
    for w in range(wedge_uv.shape[0]):
        row = wedge_uv[w]
        if row < 0:
            continue
        for i in range(values.shape[1]):
            spread[w, i] = values[row, i]


def wedge_values(mesh: Connectivity, values: Floats32) -> Floats32:
    """Texture coordinates and attributes of wedges, 0 where none is given, shape (W, k).

    `values`: shape (A, k); `mesh` has the row of each wedge.
    """
    zeros = np.zeros((1, values.shape[1]), np.float32)
    return np.concatenate([values, zeros])[mesh.wedge_uv]  # -1 is the last row


def write_wedges(mesh: Connectivity, values: Floats32, rows: Floats32) -> None:
    """Write the copies of vertices along seams, and the values of `wedge_values`."""
    copy_along_seams(mesh.wedge_vertices, mesh.vertex_count, rows)
    rows[: len(values), GEOMETRY_COLUMNS:] = values
