"""The nearest point of a triangle mesh, exactly: what the error of a refined mesh is measured with.

Triangles are sorted along a space-filling curve and boxed in pairs, pairs of pairs and so on; a
search goes down the nearer box first and skips boxes farther than what it has found.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from risorius.jit import njit
from risorius.refine.beyond.closest import closest_on_triangle
from risorius.refine.mesh.reorder import places_on_curve

Doubles = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]

LEAF = 4
"""Triangles in a box of the lowest level (chosen by timing)."""
STACK = 64


class Nearest(NamedTuple):
    """Where the nearest points are."""

    distance: Doubles
    """Shape (n,)."""
    triangle: Integers
    """Shape (n,)."""
    weights: Doubles
    """Barycentric coordinates in that triangle, shape (n, 3)."""


def nearest_points(
    points: npt.NDArray[np.floating],
    positions: npt.NDArray[np.floating],
    triangles: npt.NDArray[np.integer],
) -> Nearest:
    """Find the nearest point of a mesh for each of `points`, shape (n, 3).

    `positions`: shape (V, 3); `triangles`: shape (M, 3), at least one.
    """
    corners = np.asarray(positions, dtype=np.float64)[triangles]
    order = np.argsort(places_on_curve(corners.mean(axis=1)), kind="stable")
    boxes = _boxes(corners[order])
    queries = np.ascontiguousarray(points, dtype=np.float64)
    distance = np.empty(len(queries))
    triangle = np.empty(len(queries), dtype=np.int64)
    weights = np.empty((len(queries), 3))
    _search(queries, np.ascontiguousarray(corners[order]), boxes, distance, triangle, weights)
    return Nearest(distance, order[triangle], weights)


def _boxes(corners: Doubles) -> Doubles:
    """Boxes in heap order (children of k: 2 k and 2 k + 1), low and high, shape (2 n, 6)."""
    leaf_count = 1 << max(0, int(np.ceil(np.log2(len(corners) / LEAF))))
    boxes = np.full((2 * leaf_count, 6), np.inf)
    boxes[:, 3:] = -np.inf
    starts = np.arange(0, len(corners), LEAF)
    leaves = slice(leaf_count, leaf_count + len(starts))
    boxes[leaves, :3] = np.minimum.reduceat(corners.min(axis=1), starts)
    boxes[leaves, 3:] = np.maximum.reduceat(corners.max(axis=1), starts)
    level = leaf_count
    while level > 1:
        pairs = boxes[level : 2 * level].reshape(-1, 2, 6)
        level //= 2
        boxes[level : 2 * level, :3] = pairs[..., :3].min(axis=1)
        boxes[level : 2 * level, 3:] = pairs[..., 3:].max(axis=1)
    return boxes


@njit
def _box_distance(box, x, y, z):  # type: ignore[no-untyped-def]
    """Squared distance to a box; infinite for an empty one."""
    dx = max(box[0] - x, 0.0, x - box[3])
    dy = max(box[1] - y, 0.0, y - box[4])
    dz = max(box[2] - z, 0.0, z - box[5])
    return dx * dx + dy * dy + dz * dz


@njit
def _search(queries, corners, boxes, distance, triangle, weights):  # type: ignore[no-untyped-def]
    leaf_count = boxes.shape[0] // 2
    stack = np.empty(STACK, np.int64)
    reach = np.empty(STACK)
    for q in range(queries.shape[0]):
        x, y, z = queries[q, 0], queries[q, 1], queries[q, 2]
        best = np.inf
        depth = 1
        stack[0], reach[0] = 1, 0.0
        while depth > 0:
            depth -= 1
            node = stack[depth]
            if reach[depth] >= best:
                continue
            if node >= leaf_count:
                first = LEAF * (node - leaf_count)
                for t in range(first, min(first + LEAF, corners.shape[0])):
                    a, b, c = corners[t]
                    u, v, w = closest_on_triangle(x, y, z, a, b, c)
                    squared = 0.0
                    for i in range(3):
                        squared += (u * a[i] + v * b[i] + w * c[i] - queries[q, i]) ** 2
                    if squared < best:
                        best, triangle[q] = squared, t
                        weights[q, 0], weights[q, 1], weights[q, 2] = u, v, w
                continue
            left = _box_distance(boxes[2 * node], x, y, z)
            right = _box_distance(boxes[2 * node + 1], x, y, z)
            far = 0 if left > right else 1  # the nearer one comes on top of the stack
            stack[depth], reach[depth] = 2 * node + far, max(left, right)
            stack[depth + 1], reach[depth + 1] = 2 * node + 1 - far, min(left, right)
            depth += 2
        distance[q] = np.sqrt(best)
