"""Directions that move with a surface: what detail is stored along (detail.py).

Three orthogonal directions of length one, as rows of a matrix, for points of edges and triangles.
They turn with the surface whatever it does, because they are found anew from it in every frame; and
they change without a jump as long as normals and edges do.

The middle of a triangle is near the middle of what bends: between the centroid and the mean of the
middles of its edges, weighted by how far each is displaced. In the strips of triangles along a
folded lip two edges of three bend. With its middle in the centroid, a third of the strip's width
from one side or the other, every second triangle cut across the fold, and small teeth were seen.
"""

import numpy as np

from ...jit import njit
from ..mesh.arrays import Doubles, Floats, Unsigned
from ..mesh.connectivity import Surroundings
from ..mesh.vectors import (
    HALF,
    ONE,
    THIRD,
    TINY,
    ZERO,
    Vector,
    between,
    cross,
    dot,
    less,
    plus,
    row_of,
    times,
    unit,
    write_row,
)

SLIDE = np.float32(0.6)
"""How far the middle of a triangle goes from the centroid to the middle of what bends. Chosen: all
the way is smoothest, and farther from a scanned face; less leaves teeth."""
FLAT = np.float32(0.02)
"""Squared height over an edge, in squared lengths, that counts as bent everywhere: what is flat has
its middle in the centroid."""
TWO = np.float32(2.0)
FOUR = np.float32(4.0)


@njit
def write_axes(up: Vector, towards: Vector, axes: Floats) -> None:
    """Write three orthogonal directions of length one as rows of `axes`, shape (3, 3).

    The first is `up`, the second is `towards` made normal to it.
    """
    up = unit(up)
    towards = unit(less(towards, dot(up, towards), up))
    write_row(axes, 0, up)
    write_row(axes, 1, towards)
    write_row(axes, 2, cross(up, towards))


@njit
def upright(positions: Doubles, normals: Floats, a: np.uint32, b: np.uint32) -> Vector:
    """Return the mean of the normals at both ends of an edge, made normal to it, of length one."""
    along, mean = between(positions, a, b), plus(row_of(normals, a), row_of(normals, b))
    return unit(less(mean, dot(along, mean) / max(dot(along, along), TINY), along))


@njit
def middle_axes(around: Surroundings, positions: Doubles, normals: Floats, axes: Floats) -> None:
    """Write the directions of the middles of all edges: upright on the edge, along it, across.

    `normals`: of vertices, shape (V, 3); `axes`: shape (E, 3, 3, 3), edge, point, direction.
    """
    for e in range(axes.shape[0]):
        a, b = around.points[e, 0], around.points[e, 1]
        write_axes(upright(positions, normals, a, b), between(positions, a, b), axes[e, 1])


@njit
def quarter_axes(
    around: Surroundings, positions: Doubles, normals: Floats, edges: Unsigned, axes: Floats
) -> None:
    """Write the directions of the quarters of some edges, shape (N,), from those of their middles.

    Up is half way from the middle's to the normal at the end: a point near a vertex turns with it,
    not with the edge.
    """
    for e in edges:
        a, b = around.points[e, 0], around.points[e, 1]
        up, along = row_of(axes[e, 1], 0), between(positions, a, b)
        write_axes(plus(up, row_of(normals, a)), along, axes[e, 0])
        write_axes(plus(up, row_of(normals, b)), along, axes[e, 2])


@njit
def triangle_axes(
    positions: Doubles, normals: Floats, faces: Unsigned, t: int, shares: Floats, axes: Floats
) -> None:
    """Write the directions of a triangle, shape (3, 3): up, along edge 0, across.

    `shares`: where in it (slide_middle). Up is what the quadratic has there that has the normals of
    the corners and those upright on the edges between them.
    """
    up = ZERO, ZERO, ZERO
    for i in range(3):
        a, b = faces[t, i], faces[t, (i + 1) % 3]
        start, end = shares[i], shares[(i + 1) % 3]
        middle, corner = FOUR * start * end, start * (TWO * start - ONE)
        at_edge = times(middle, upright(positions, normals, a, b))
        up = plus(up, plus(at_edge, times(corner, row_of(normals, a))))
    write_axes(up, between(positions, faces[t, 0], faces[t, 1]), axes)


@njit
def bend_of(positions: Doubles, normals: Floats, a: np.uint32, b: np.uint32) -> np.float32:
    """How far the middle of an edge is displaced, squared, with a little for its length."""
    d, at_a, at_b = between(positions, a, b), row_of(normals, a), row_of(normals, b)
    height_a, height_b, cosine = dot(d, at_a), dot(d, at_b), dot(at_a, at_b)
    # The displacement of the cubic times eight, squared.
    bend = height_a * height_a + height_b * height_b - TWO * cosine * height_a * height_b
    return np.float32(bend + FLAT * dot(d, d))


@njit
def slide_middle(
    positions: Doubles, normals: Floats, faces: Unsigned, t: int, shares: Floats
) -> None:
    """Write where the middle of a triangle lies: shares of its corners, shape (3,)."""
    a, b, c = faces[t, 0], faces[t, 1], faces[t, 2]
    ab, bc = bend_of(positions, normals, a, b), bend_of(positions, normals, b, c)
    ca = bend_of(positions, normals, c, a)
    scale = SLIDE * HALF / max(ab + bc + ca, TINY)
    shares[0] = (ONE - SLIDE) * THIRD + scale * (ab + ca)
    shares[1] = (ONE - SLIDE) * THIRD + scale * (bc + ab)
    shares[2] = (ONE - SLIDE) * THIRD + scale * (ca + bc)


@njit
def find_middles(
    positions: Doubles, normals: Floats, faces: Unsigned, shares: Floats, axes: Floats
) -> None:
    """Write shares of the corners, shape (F, 3), and directions, (F, 3, 3), of all triangles."""
    for t in range(faces.shape[0]):
        slide_middle(positions, normals, faces, t, shares[t])
        triangle_axes(positions, normals, faces, t, shares[t], axes[t])
