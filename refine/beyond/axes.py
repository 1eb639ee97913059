"""Directions that move with a surface: what detail is stored along (detail.py).

Three orthogonal directions of length one, as rows of a matrix, for edges, vertices and triangles.
They turn with the surface whatever it does, because they are found anew from it in every frame; and
they change without a jump as long as normals and edges do.

The middle of a triangle is near the middle of what bends: between the centroid and the mean of the
middles of its edges, weighted by how far each bulges. In the strips of triangles along a folded lip
two edges of three bend. With its middle in the centroid, a third of the strip's width from one side
or the other, every second triangle cut across the fold, and small teeth were seen.
"""

import numpy as np
import numpy.typing as npt

from ...jit import njit
from ..kahler.frame import ONCE, FrameBuffers
from ..mesh.connectivity import Surroundings
from ..mesh.normals import between, unit

Floats = npt.NDArray[np.float32]
Doubles = npt.NDArray[np.float64]
Unsigned = npt.NDArray[np.uint32]
Vector = tuple[np.float32, np.float32, np.float32]

SLIDE = np.float32(0.6)
"""How far the middle of a triangle goes from the centroid to the middle of what bends. Chosen: all
the way is smoothest, and farther from a scanned face; less leaves teeth."""
FLAT = np.float32(0.02)
"""Squared height over an edge, in squared lengths, that counts as bent everywhere: what is flat has
its middle in the centroid."""
ZERO = np.float32(0.0)
THIRD = np.float32(1 / 3)
HALF = np.float32(0.5)
ONE = np.float32(1.0)
TWO = np.float32(2.0)
FOUR = np.float32(4.0)
TINY = np.finfo(np.float32).tiny


@njit
def write_axes(up: Vector, towards: Vector, axes: Floats) -> None:
    """Write three orthogonal directions of length one as rows of `axes`, shape (3, 3).

    The first is `up`, the second is `towards` made normal to it.
    """
    x, y, z = unit(up[0], up[1], up[2])
    u, v, w = towards
    slope = x * u + y * v + z * w
    u, v, w = unit(u - slope * x, v - slope * y, w - slope * z)
    axes[0, 0], axes[0, 1], axes[0, 2] = x, y, z
    axes[1, 0], axes[1, 1], axes[1, 2] = u, v, w
    axes[2, 0], axes[2, 1], axes[2, 2] = y * w - z * v, z * u - x * w, x * v - y * u


@njit
def upright(positions: Doubles, normals: Floats, a: np.uint32, b: np.uint32) -> Vector:
    """Return the mean of the normals at both ends of an edge, made normal to it, of length one."""
    x, y, z = between(positions, a, b)
    u = normals[a, 0] + normals[b, 0]
    v = normals[a, 1] + normals[b, 1]
    w = normals[a, 2] + normals[b, 2]
    slope = (x * u + y * v + z * w) / max(x * x + y * y + z * z, TINY)
    return unit(u - slope * x, v - slope * y, w - slope * z)


@njit
def edge_axes(around: Surroundings, frame: FrameBuffers, normals: Floats, axes: Floats) -> None:
    """Write the directions of the points of the split edges: up, along the edge, across.

    `normals`: of vertices, shape (V, 3); `axes`: shape (E, 3, 3, 3), edge, point, direction.
    Edges that are split once have a middle only. Up is upright on the edge there, and half way from
    there to the normal at the end at the quarters: a point near a vertex turns with it, not with
    the edge.
    """
    for k in range(frame.counts[ONCE]):
        e = frame.split_once[k]
        a, b = around.points[e, 0], around.points[e, 1]
        u, v, w = upright(frame.positions, normals, a, b)
        along = between(frame.positions, a, b)
        write_axes((u, v, w), along, axes[e, 1])
        if frame.splits[e] == 2:
            near_a = u + normals[a, 0], v + normals[a, 1], w + normals[a, 2]
            near_b = u + normals[b, 0], v + normals[b, 1], w + normals[b, 2]
            write_axes(near_a, along, axes[e, 0])
            write_axes(near_b, along, axes[e, 2])


@njit
def vertex_axes(positions: Doubles, normals: Floats, towards: Unsigned, axes: Floats) -> None:
    """Write the directions of all vertices, shape (V, 3, 3): up, towards a neighbour, across."""
    for v in range(positions.shape[0]):
        up = normals[v, 0], normals[v, 1], normals[v, 2]
        write_axes(up, between(positions, v, towards[v]), axes[v])


@njit
def triangle_axes(
    positions: Doubles, normals: Floats, faces: Unsigned, t: int, shares: Floats, axes: Floats
) -> None:
    """Write the directions of a triangle, shape (3, 3): up, along edge 0, across.

    `shares`: where in it (slide_middle). Up is what the quadratic has there that has the normals of
    the corners and those upright on the edges between them.
    """
    x = y = z = ZERO
    for i in range(3):
        a, b = faces[t, i], faces[t, (i + 1) % 3]
        u, v, w = upright(positions, normals, a, b)
        start, end = shares[i], shares[(i + 1) % 3]
        middle, corner = FOUR * start * end, start * (TWO * start - ONE)
        x += middle * u + corner * normals[a, 0]
        y += middle * v + corner * normals[a, 1]
        z += middle * w + corner * normals[a, 2]
    write_axes((x, y, z), between(positions, faces[t, 0], faces[t, 1]), axes)


@njit
def bend_of(positions: Doubles, normals: Floats, a: np.uint32, b: np.uint32) -> np.float32:
    """How far an edge bulges, squared, with a little for its length."""
    length = height_a = height_b = cosine = ZERO
    for j in range(3):
        d = np.float32(positions[b, j] - positions[a, j])
        length += d * d
        height_a += d * normals[a, j]
        height_b += d * normals[b, j]
        cosine += normals[a, j] * normals[b, j]
    # The bulge of the cubic times eight, squared.
    bend = height_a * height_a + height_b * height_b - TWO * cosine * height_a * height_b
    return np.float32(bend + FLAT * length)


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
