"""Vertex normals, which measure bends and shade the surface.

They are weighted by area: the cross products of the incident triangles, summed and normalised.
(Kähler, Haber, Seidel 2003, name no weights; unweighted cross products are simplest, and large
triangles count most.)

Edge vectors are taken in double precision, and all else in single, so a mesh far from the origin
loses no precision. Normals at rest and in a frame come from the same code: see criterion.py.
"""

import numpy as np

from ...geometry.arrays import Floats32, Floats64, Unsigned32
from ...geometry.vectors import (
    ONE,
    ROW_WIDTH,
    ZERO,
    Rows,
    Vector,
    add_to_row,
    between,
    cross,
    difference,
    dot,
    is_representable,
    row_of,
    times,
    unit,
    write_row,
)
from ...jit import njit

SLIVER_SINE = 1e-9
"""Sine of an angle below which a triangle counts as degenerate and has no normal."""


@njit
def cross_product(positions: Floats64, a: np.uint32, b: np.uint32, c: np.uint32) -> Vector:
    """Normal of a triangle times twice its area."""
    return cross(between(positions, a, b), between(positions, a, c))


@njit
def normalise(vectors: Floats32) -> None:
    """Bring vectors, shape (V, 3), to length one; zero vectors stay zero.

    The loop has no branch, so the compiler vectorises it. A second loop treats the vectors whose
    squares single precision cannot represent, one by one.
    """
    assert vectors.shape[1] == ROW_WIDTH
    left_count = 0
    for v in range(vectors.shape[0]):
        vector = row_of(vectors, v)
        squared = dot(vector, vector)
        scale = ONE / np.sqrt(squared if is_representable(squared) else ONE)
        write_row(vectors, v, times(scale, vector))
        left_count += not is_representable(squared)
    if left_count > 0:
        for v in range(vectors.shape[0]):
            vector = row_of(vectors, v)
            if not is_representable(dot(vector, vector)):
                write_row(vectors, v, unit(vector))


@njit
def vertex_normals(positions: Floats64, faces: Unsigned32, normals: Floats32) -> None:
    """Write the area-weighted unit normal of every vertex into `normals`, shape (V, 3).

    It is zero where a vertex has no triangle with an area. `faces`: vertices of triangles, shape
    (F, 3).
    """
    assert positions.shape[1] == faces.shape[1] == normals.shape[1] == ROW_WIDTH
    normals[:] = ZERO
    for t in range(faces.shape[0]):
        a = faces[t, 0]
        b = faces[t, 1]
        c = faces[t, 2]
        normal = cross_product(positions, a, b, c)
        add_to_row(normals, a, normal)
        add_to_row(normals, b, normal)
        add_to_row(normals, c, normal)
    normalise(normals)


@njit
def weigh_corners(positions: Floats64, faces: Unsigned32, weights: Rows) -> None:
    """Write sqrt(angle / |cross product|) of every corner, shape (F, 3); 0 without an area."""
    for t in range(faces.shape[0]):
        for i in range(3):
            a = faces[t, i]
            b = faces[t, (i + 1) % 3]
            c = faces[t, (i + 2) % 3]
            u = difference(positions, a, b)
            v = difference(positions, a, c)
            normal = cross(u, v)
            size = np.sqrt(dot(u, u) * dot(v, v))
            area = np.sqrt(dot(normal, normal))
            angle = np.arctan2(area, dot(u, v))
            weights[t, i] = np.sqrt(angle / area) if area > SLIVER_SINE * size else 0.0
