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

from .native import native
from .normals import unit

Floats = npt.NDArray[np.float32]
Doubles = npt.NDArray[np.float64]
Unsigned = npt.NDArray[np.uint32]

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


@native
def write_axes(
    x: np.float32,
    y: np.float32,
    z: np.float32,
    u: np.float32,
    v: np.float32,
    w: np.float32,
    axes: Floats,
    k: np.uint64,
) -> None:
    """Write three orthogonal directions of length one: (x y z), then (u v w) made normal to it.

    Into rows k, k + 1, k + 2 of `axes`.
    """
    x, y, z = unit(x, y, z)
    slope = x * u + y * v + z * w
    u, v, w = unit(u - slope * x, v - slope * y, w - slope * z)
    second, third = k + np.uint64(1), k + np.uint64(2)
    axes[k, 0], axes[k, 1], axes[k, 2] = x, y, z
    axes[second, 0], axes[second, 1], axes[second, 2] = u, v, w
    axes[third, 0], axes[third, 1], axes[third, 2] = y * w - z * v, z * u - x * w, x * v - y * u


@native
def upright(
    positions: Doubles, normals: Floats, a: np.uint32, b: np.uint32
) -> tuple[np.float32, np.float32, np.float32]:
    """Return the mean of the normals at both ends of an edge, made normal to it, of length one."""
    x = np.float32(positions[b, 0] - positions[a, 0])
    y = np.float32(positions[b, 1] - positions[a, 1])
    z = np.float32(positions[b, 2] - positions[a, 2])
    u = normals[a, 0] + normals[b, 0]
    v = normals[a, 1] + normals[b, 1]
    w = normals[a, 2] + normals[b, 2]
    slope = (x * u + y * v + z * w) / max(x * x + y * y + z * z, TINY)
    return unit(u - slope * x, v - slope * y, w - slope * z)


@native
def edge_axes(
    positions: Doubles,
    normals: Floats,
    edge_points: Unsigned,
    splits: npt.NDArray[np.uint8],
    split_once: Unsigned,
    counts: npt.NDArray[np.int64],
    axes: Floats,
) -> None:
    """Write the directions of the points of the split edges: up, along the edge, across.

    `axes`: nine rows for each edge; `counts`: see schemes.Frame.
    Edges that are split once have a middle only. Up is upright on the edge there, and half way from
    there to the normal at the end at the quarters: a point near a vertex turns with it, not with
    the edge.
    """
    for k in range(counts[1]):
        e = split_once[k]
        a, b = edge_points[e, 0], edge_points[e, 1]
        u, v, w = upright(positions, normals, a, b)
        for point in range(3):
            x, y, z = u, v, w
            if point != 1:
                if splits[e] < 2:
                    continue
                near = a if point == 0 else b
                x, y, z = u + normals[near, 0], v + normals[near, 1], w + normals[near, 2]
            write_axes(
                x,
                y,
                z,
                np.float32(positions[b, 0] - positions[a, 0]),
                np.float32(positions[b, 1] - positions[a, 1]),
                np.float32(positions[b, 2] - positions[a, 2]),
                axes,
                np.uint64(9) * np.uint64(e) + np.uint64(3 * point),
            )


@native
def vertex_axes(positions: Doubles, normals: Floats, towards: Unsigned, axes: Floats) -> None:
    """Write the directions of all vertices, three rows each: up, towards a neighbour, across."""
    for v in range(positions.shape[0]):
        u = towards[v]
        write_axes(
            normals[v, 0],
            normals[v, 1],
            normals[v, 2],
            np.float32(positions[u, 0] - positions[v, 0]),
            np.float32(positions[u, 1] - positions[v, 1]),
            np.float32(positions[u, 2] - positions[v, 2]),
            axes,
            np.uint64(3 * v),
        )


@native
def triangle_axes(
    positions: Doubles,
    normals: Floats,
    faces: Unsigned,
    listed: Unsigned,
    count: npt.NDArray[np.int64],
    shares: Floats,
    axes: Floats,
) -> None:
    """Write the directions of the listed triangles, three rows each: up, along edge 0, across.

    `count`: how many are listed, shape (1,); `shares`: where in the triangles (slide_middles). Up
    is what the quadratic has there that has the normals of the corners and those upright on the
    edges between them.
    """
    for k in range(count[0]):
        t = listed[k]
        x = y = z = ZERO
        for i in range(3):
            a, b = faces[t, i], faces[t, (i + 1) % 3]
            u, v, w = upright(positions, normals, a, b)
            start, end = shares[t, i], shares[t, (i + 1) % 3]
            middle, corner = FOUR * start * end, start * (TWO * start - ONE)
            x += middle * u + corner * normals[a, 0]
            y += middle * v + corner * normals[a, 1]
            z += middle * w + corner * normals[a, 2]
        a, b = faces[t, 0], faces[t, 1]
        write_axes(
            x,
            y,
            z,
            np.float32(positions[b, 0] - positions[a, 0]),
            np.float32(positions[b, 1] - positions[a, 1]),
            np.float32(positions[b, 2] - positions[a, 2]),
            axes,
            np.uint64(3) * np.uint64(t),
        )


@native
def list_grown(
    triangle_edges: npt.NDArray[np.int32],
    growth_once: Floats,
    centre_triangles: Unsigned,
    counts: npt.NDArray[np.int64],
    grown: Unsigned,
    count: npt.NDArray[np.int64],
) -> None:
    """List the triangles all of whose edges have grown, and count them: others show nothing.

    `counts`: see schemes.Frame; `count`, shape (1,), gets how many there are.
    """
    count[0] = 0
    for k in range(counts[4]):
        t = centre_triangles[k]
        once = ONE
        for i in range(3):
            once = min(once, growth_once[triangle_edges[t, i]])
        if once > ZERO:
            grown[count[0]] = t
            count[0] += 1


@native
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


@native
def slide_middles(
    positions: Doubles,
    normals: Floats,
    faces: Unsigned,
    listed: Unsigned,
    count: npt.NDArray[np.int64],
    shares: Floats,
) -> None:
    """Write where the middles of the listed triangles lie: shares of the corners, shape (F, 3).

    `count`: how many are listed, shape (1,).
    """
    for k in range(count[0]):
        t = listed[k]
        a, b, c = faces[t, 0], faces[t, 1], faces[t, 2]
        ab, bc = bend_of(positions, normals, a, b), bend_of(positions, normals, b, c)
        ca = bend_of(positions, normals, c, a)
        scale = SLIDE * HALF / max(ab + bc + ca, TINY)
        shares[t, 0] = (ONE - SLIDE) * THIRD + scale * (ab + ca)
        shares[t, 1] = (ONE - SLIDE) * THIRD + scale * (bc + ab)
        shares[t, 2] = (ONE - SLIDE) * THIRD + scale * (ca + bc)
