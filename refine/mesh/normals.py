"""Vertex normals: what bends, and what light falls on.

Weighted by area: the cross products of the incident triangles, summed and normalised. (Kähler,
Haber, Seidel 2003, do not say; this needs no weights and lets large triangles decide.)

Edge vectors are taken in double precision before the rest is done in single, so a mesh far from the
origin loses nothing. Normals at rest and in a frame come from the same code: see criterion.py.
"""

import numpy as np

from ...jit import njit
from .arrays import Doubles, Floats, Unsigned
from .vectors import (
    WIDTH,
    ZERO,
    Vector,
    add_to_row,
    between,
    cross,
    row_of,
    unit,
    write_row,
)


@njit
def cross_product(positions: Doubles, a: np.uint32, b: np.uint32, c: np.uint32) -> Vector:
    """Normal of a triangle times twice its area."""
    return cross(between(positions, a, b), between(positions, a, c))


@njit
def normalise(vectors: Floats) -> None:
    """Bring vectors, shape (V, 3), to length one; those that are zero stay zero."""
    assert vectors.shape[1] == WIDTH
    for v in range(vectors.shape[0]):
        write_row(vectors, v, unit(row_of(vectors, v)))


@njit
def vertex_normals(positions: Doubles, faces: Unsigned, normals: Floats) -> None:
    """Write the area-weighted unit normal of every vertex into `normals`, shape (V, 3).

    Zero where a vertex has no triangle with an area. `faces`: vertices of triangles, shape (F, 3).
    """
    assert positions.shape[1] == faces.shape[1] == normals.shape[1] == WIDTH
    normals[:] = ZERO
    for t in range(faces.shape[0]):
        a, b, c = faces[t, 0], faces[t, 1], faces[t, 2]
        normal = cross_product(positions, a, b, c)
        add_to_row(normals, a, normal)
        add_to_row(normals, b, normal)
        add_to_row(normals, c, normal)
    normalise(normals)
