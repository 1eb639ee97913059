"""The nearest point of a triangle mesh, exactly: what the error of a refined mesh is measured with.

Triangles are sorted along a space-filling curve and boxed in pairs, pairs of pairs and so on; a
search goes down the nearer box first and skips boxes farther than what it has found. Point against
triangle after Ericson, "Real-Time Collision Detection" (2005), section 5.1.5.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from risorius.jit import njit

Doubles = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]

LEAF = 4
"""Triangles in a box of the lowest level (chosen by timing)."""
BITS = 10
"""Bits of each coordinate on the space-filling curve."""
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
    order = np.argsort(_curve_numbers(corners.mean(axis=1)), kind="stable")
    boxes = _boxes(corners[order])
    queries = np.ascontiguousarray(points, dtype=np.float64)
    distance = np.empty(len(queries))
    triangle = np.empty(len(queries), dtype=np.int64)
    weights = np.empty((len(queries), 3))
    _search(queries, np.ascontiguousarray(corners[order]), boxes, distance, triangle, weights)
    return Nearest(distance, order[triangle], weights)


def _curve_numbers(centres: Doubles) -> Integers:
    """Morton numbers: near in number is near in space."""
    low, high = centres.min(axis=0), centres.max(axis=0)
    scale = (2**BITS - 1) / np.maximum(high - low, 1e-300)
    cells = ((centres - low) * scale).astype(np.int64)
    numbers = np.zeros(len(centres), dtype=np.int64)
    for bit in range(BITS):
        for axis in range(3):
            numbers |= ((cells[:, axis] >> bit) & 1) << (3 * bit + axis)
    return numbers


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
def _on_triangle(corners, x, y, z):  # type: ignore[no-untyped-def]
    """Weights of the second and the third corner at the nearest point of a triangle."""
    ax, ay, az = corners[0, 0], corners[0, 1], corners[0, 2]
    abx, aby, abz = corners[1, 0] - ax, corners[1, 1] - ay, corners[1, 2] - az
    acx, acy, acz = corners[2, 0] - ax, corners[2, 1] - ay, corners[2, 2] - az
    apx, apy, apz = x - ax, y - ay, z - az
    d1, d2 = abx * apx + aby * apy + abz * apz, acx * apx + acy * apy + acz * apz
    if d1 <= 0.0 and d2 <= 0.0:
        return 0.0, 0.0
    bpx, bpy, bpz = x - corners[1, 0], y - corners[1, 1], z - corners[1, 2]
    d3, d4 = abx * bpx + aby * bpy + abz * bpz, acx * bpx + acy * bpy + acz * bpz
    if d3 >= 0.0 and d4 <= d3:
        return 1.0, 0.0
    vc = d1 * d4 - d3 * d2
    if vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        return d1 / (d1 - d3), 0.0
    cpx, cpy, cpz = x - corners[2, 0], y - corners[2, 1], z - corners[2, 2]
    d5, d6 = abx * cpx + aby * cpy + abz * cpz, acx * cpx + acy * cpy + acz * cpz
    if d6 >= 0.0 and d5 <= d6:
        return 0.0, 1.0
    vb = d5 * d2 - d1 * d6
    if vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        return 0.0, d2 / (d2 - d6)
    va = d3 * d6 - d5 * d4
    if va <= 0.0 and d4 - d3 >= 0.0 and d5 - d6 >= 0.0:
        along = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        return 1.0 - along, along
    total = va + vb + vc
    return vb / total, vc / total


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
                    v, w = _on_triangle(corners[t], x, y, z)
                    squared = 0.0
                    for i, at in ((0, x), (1, y), (2, z)):
                        edge, other = corners[t, 1, i], corners[t, 2, i]
                        there = (1.0 - v - w) * corners[t, 0, i] + v * edge + w * other
                        squared += (there - at) ** 2
                    if squared < best:
                        best, triangle[q] = squared, t
                        weights[q, 0], weights[q, 1], weights[q, 2] = 1.0 - v - w, v, w
                continue
            left = _box_distance(boxes[2 * node], x, y, z)
            right = _box_distance(boxes[2 * node + 1], x, y, z)
            far = 0 if left > right else 1  # the nearer one comes on top of the stack
            stack[depth], reach[depth] = 2 * node + far, max(left, right)
            stack[depth + 1], reach[depth + 1] = 2 * node + 1 - far, min(left, right)
            depth += 2
        distance[q] = np.sqrt(best)
