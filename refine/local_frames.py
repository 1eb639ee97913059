"""Directions that move with a surface: what detail is stored along (detail.py).

Three orthogonal directions of length one, as rows of a matrix, for edges, vertices and triangles.
They turn with the surface whatever it does, because they are found anew from it in every frame; and
they change without a jump as long as normals and edges do.
"""

import numpy as np
import numpy.typing as npt

from .kernels import kernel

Floats = npt.NDArray[np.float32]
Doubles = npt.NDArray[np.float64]
Unsigned = npt.NDArray[np.uint32]

ZERO = np.float32(0.0)
ONE = np.float32(1.0)
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
    axes: Floats,
) -> None:
    """Write the directions of the listed triangles: up, along edge 0, across.

    Up is the middle of the quadratic that has the normals of the corners and those upright on the
    edges between them.
    """
    for k in range(count):
        t = listed[k]
        x = y = z = ZERO
        for i in range(3):
            a, b = faces[t, i], faces[t, (i + 1) % 3]
            u, v, w = upright(positions, normals, a, b)
            x += FOUR * u - normals[a, 0]
            y += FOUR * v - normals[a, 1]
            z += FOUR * w - normals[a, 2]
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
