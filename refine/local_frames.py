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

from .kernels import kernel

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


@kernel
def write_axes(
    x: np.float32,
    y: np.float32,
    z: np.float32,
    u: np.float32,
    v: np.float32,
    w: np.float32,
    axes: Floats,
) -> None:
    """Write three orthogonal directions of length one: (x y z), then (u v w) made normal to it."""
    scale = ONE / np.sqrt(max(x * x + y * y + z * z, TINY))
    x, y, z = x * scale, y * scale, z * scale
    slope = x * u + y * v + z * w
    u, v, w = u - slope * x, v - slope * y, w - slope * z
    scale = ONE / np.sqrt(max(u * u + v * v + w * w, TINY))
    u, v, w = u * scale, v * scale, w * scale
    axes[0, 0], axes[0, 1], axes[0, 2] = x, y, z
    axes[1, 0], axes[1, 1], axes[1, 2] = u, v, w
    axes[2, 0], axes[2, 1], axes[2, 2] = y * w - z * v, z * u - x * w, x * v - y * u


@kernel
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
    u, v, w = u - slope * x, v - slope * y, w - slope * z
    scale = ONE / np.sqrt(max(u * u + v * v + w * w, TINY))
    return u * scale, v * scale, w * scale


@kernel
def edge_axes(
    positions: Doubles,
    normals: Floats,
    edge_points: Unsigned,
    splits: npt.NDArray[np.uint8],
    listed: Unsigned,
    count: int,
    axes: Floats,
) -> None:
    """Write the directions of the points of the listed edges: up, along the edge, across.

    Edges that are split once have a middle only. Up is upright on the edge there, and half way from
    there to the normal at the end at the quarters: a point near a vertex turns with it, not with
    the edge.
    """
    for k in range(count):
        e = listed[k]
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
                axes[e, point],
            )


@kernel
def vertex_axes(positions: Doubles, normals: Floats, towards: Unsigned, axes: Floats) -> None:
    """Write the directions of all vertices: up, towards a neighbour, across."""
    for v in range(positions.shape[0]):
        u = towards[v]
        write_axes(
            normals[v, 0],
            normals[v, 1],
            normals[v, 2],
            np.float32(positions[u, 0] - positions[v, 0]),
            np.float32(positions[u, 1] - positions[v, 1]),
            np.float32(positions[u, 2] - positions[v, 2]),
            axes[v],
        )


@kernel
def triangle_axes(
    positions: Doubles,
    normals: Floats,
    faces: Unsigned,
    listed: Unsigned,
    count: int,
    shares: Floats,
    axes: Floats,
) -> None:
    """Write the directions of the listed triangles: up, along edge 0, across.

    `shares`: where in the triangles (slide_middles). Up is what the quadratic has there that has
    the normals of the corners and those upright on the edges between them.
    """
    for k in range(count):
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
            axes[t],
        )


@kernel
def list_grown(
    triangle_edges: npt.NDArray[np.int32],
    growth_once: Floats,
    centre_triangles: Unsigned,
    centre_count: int,
    grown: Unsigned,
) -> int:
    """List the triangles all of whose edges have grown; return how many: others show nothing."""
    count = 0
    for k in range(centre_count):
        t = centre_triangles[k]
        once = ONE
        for i in range(3):
            once = min(once, growth_once[triangle_edges[t, i]])
        if once > ZERO:
            grown[count] = t
            count += 1
    return count


@kernel
def slide_middles(
    positions: Doubles,
    normals: Floats,
    faces: Unsigned,
    listed: Unsigned,
    count: int,
    shares: Floats,
) -> None:
    """Write where the middles of the listed triangles lie: shares of the corners, shape (F, 3)."""
    bends = np.empty(3, np.float32)
    for k in range(count):
        t = listed[k]
        total = ZERO
        for i in range(3):
            a, b = faces[t, i], faces[t, (i + 1) % 3]
            length = height_a = height_b = cosine = ZERO
            for j in range(3):
                d = np.float32(positions[b, j] - positions[a, j])
                length += d * d
                height_a += d * normals[a, j]
                height_b += d * normals[b, j]
                cosine += normals[a, j] * normals[b, j]
            # The bulge of the cubic times eight, squared.
            bend = height_a * height_a + height_b * height_b - TWO * cosine * height_a * height_b
            bends[i] = bend + FLAT * length
            total += bends[i]
        scale = SLIDE * HALF / max(total, TINY)
        for i in range(3):
            bent = scale * (bends[i] + bends[(i + 2) % 3])
            shares[t, i] = (ONE - SLIDE) * THIRD + bent
