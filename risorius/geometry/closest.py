"""Exact closest points on a triangle mesh, optionally only where it faces the same way.

Triangles are sorted along a space-filling curve and grouped into a binary tree of boxes. A search
enters the nearer box first, and skips boxes that are farther than the nearest triangle so far. The
tree has the same depth everywhere, even where triangles cluster.

Source: Morton 1966 for the curve; Ericson 2005, "Real-time collision detection", section 5.1.5, for
one triangle.
"""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np
import numpy.typing as npt

from ..jit import njit
from .arrays import Floats64, Integers64
from .directions import unit_vectors
from .normals import cross_products
from .read_only import read_only
from .vectors import dot, less, vector_of

LEAF_SIZE = 4
"""Triangles in a box of the lowest level (chosen by timing)."""


@dataclass(frozen=True)
class SurfacePoints:
    """For each of n points, the closest point of a triangle mesh."""

    distances: Floats64
    """Shape (n,)."""
    triangles: Integers64
    """Shape (n,)."""
    corners: npt.NDArray[np.integer]
    """Vertices of the triangle, shape (n, 3)."""
    weights: Floats64
    """Barycentric coordinates in it, shape (n, 3)."""

    def interpolate(self, values: npt.NDArray[np.floating]) -> Floats64:
        """Interpolate values of the mesh's vertices, (V,) or (V, k), at these points."""
        wide = np.asarray(values, dtype=np.float64)[self.corners]
        carried: Floats64 = np.einsum("nc,nc...->n...", self.weights, wide)
        return carried

    def interpolate_round(self, vertices: Floats64, normals: Floats64) -> Floats64:
        """Interpolate places on curved triangles: edges are arcs, normal to the vertex normals.

        vertices: (V, 3). normals: unit normals, (V, 3). Returns shape (n, 3).
        Source: Vlachos et al. 2001, "Curved PN triangles", with parabolas for cubics.
        """
        places = self.interpolate(vertices)
        for first, second in ((0, 1), (1, 2), (2, 0)):
            ends = self.corners[:, [first, second]]
            along = np.diff(vertices[ends], axis=1)
            up = normals[ends]
            heights = (along * up).sum(axis=2, keepdims=True) * up
            arc = 0.125 * (heights[:, 1] - heights[:, 0])  # from the middle of the straight edge
            share = 4.0 * self.weights[:, first] * self.weights[:, second]
            places += share[:, None] * arc
        return places


@dataclass(frozen=True, eq=False)
class MeshSearch:
    """A mesh with its triangles sorted into boxes, for repeated searches."""

    faces: npt.NDArray[np.integer]
    """Vertices of the triangles, shape (F, 3), at least one."""
    _order: Integers64
    _corners: Floats64
    _face_normals: Floats64
    _boxes: Floats64

    @classmethod
    def from_mesh(cls, vertices: npt.NDArray[np.floating], faces: npt.NDArray[np.integer]) -> Self:
        """Sort and box triangles (F, 3) of vertices (V, 3)."""
        corners = np.asarray(vertices, dtype=np.float64)[faces]
        order = np.argsort(codes_on_curve(corners.mean(axis=1)), kind="stable")
        corners = np.ascontiguousarray(corners[order])
        face_normals = cross_products(
            corners.reshape(-1, 3), np.arange(corners.size // 3).reshape(-1, 3)
        )
        return cls(faces, order, corners, unit_vectors(face_normals, 1e-300), _boxes(corners))

    def closest(
        self,
        points: npt.NDArray[np.floating],
        normals: npt.NDArray[np.floating] | None = None,
        wrong_side: float = 0.0,
    ) -> SurfacePoints:
        """Find the closest points, as `closest_points` does."""
        queries = read_only(np.ascontiguousarray(points, dtype=np.float64))
        wanted = np.zeros_like(queries) if normals is None else np.array(normals, dtype=np.float64)
        distances = np.empty(len(queries))
        triangles = np.empty(len(queries), np.int64)
        weights = np.empty((len(queries), 3))
        mesh = self._corners, self._face_normals, self._boxes
        _search(queries, wanted, *mesh, wrong_side, distances, triangles, weights)
        triangles = self._order[triangles]
        return SurfacePoints(distances, triangles, self.faces[triangles], weights)


def closest_points(
    points: npt.NDArray[np.floating],
    vertices: npt.NDArray[np.floating],
    faces: npt.NDArray[np.integer],
    normals: npt.NDArray[np.floating] | None = None,
    wrong_side: float = 0.0,
) -> SurfacePoints:
    """Find the point of a mesh (one triangle or more) that is closest to each of `points` (n, 3).

    `normals`: direction in which the surface should face there, shape (n, 3), zero for any
    direction. For a triangle that faces the other way, `wrong_side` is added to the distance, so
    that points of the lower lip find the lower lip even if it touches the upper lip.
    """
    return MeshSearch.from_mesh(vertices, faces).closest(points, normals, wrong_side)


def codes_on_curve(positions: Floats64) -> Integers64:
    """Index of each position along a space-filling curve, shape (V,)."""
    if len(positions) == 0:
        return np.zeros(0, dtype=np.int64)
    low = positions.min(axis=0)
    size = float((positions.max(axis=0) - low).max())
    curve_bits = 20  # of the grid along one axis; 3 x 20 fit a number of 64
    scale = (2**curve_bits - 1) / size if size > 0.0 else 0.0
    cells = ((positions - low) * scale).astype(np.int64)
    codes = np.zeros(len(positions), dtype=np.int64)
    for bit in range(curve_bits):  # bits of x, y and z in turn
        for axis in range(3):
            codes |= ((cells[:, axis] >> bit) & 1) << (3 * bit + axis)
    return codes


def _boxes(corners: Floats64) -> Floats64:
    """Boxes in heap order (children of k: 2 k and 2 k + 1), low and high, shape (2 n, 6)."""
    leaf_count = 1 << max(0, int(np.ceil(np.log2(len(corners) / LEAF_SIZE))))
    boxes = np.full((2 * leaf_count, 6), np.inf)
    boxes[:, 3:] = -np.inf
    starts = np.arange(0, len(corners), LEAF_SIZE)
    low = corners.min(axis=1)
    high = corners.max(axis=1)
    leaves = slice(leaf_count, leaf_count + len(starts))
    boxes[leaves, :3] = np.minimum.reduceat(low, starts)
    boxes[leaves, 3:] = np.maximum.reduceat(high, starts)
    level = leaf_count
    while level > 1:
        pairs = boxes[level : 2 * level].reshape(-1, 2, 6)
        level //= 2
        boxes[level : 2 * level, :3] = pairs[..., :3].min(axis=1)
        boxes[level : 2 * level, 3:] = pairs[..., 3:].max(axis=1)
    return boxes


@njit
def _box_distance(box: Floats64, point: Floats64) -> float:
    """Distance to a box; infinite for an empty one."""
    squared = 0.0
    for i in range(3):
        beside = max(box[i] - point[i], 0.0, point[i] - box[3 + i])
        squared += beside * beside
    return math.sqrt(squared)


@njit
def _search(
    queries: Floats64,
    wanted: Floats64,
    corners: Floats64,
    face_normals: Floats64,
    boxes: Floats64,
    wrong_side: float,
    distances: Floats64,
    triangles: Integers64,
    weights: Floats64,
) -> None:
    """Write the closest point to each query: distance, triangle, barycentric coordinates."""
    leaf_count = boxes.shape[0] // 2
    stack_size = 64
    stack = np.empty(stack_size, np.int64)
    reach = np.empty(stack_size)
    least_cosine = 0.3  # between two normals that count as the same direction: 73 degrees
    for q in range(queries.shape[0]):
        point = queries[q]
        direction = wanted[q]
        any_direction = direction[0] == 0.0 and direction[1] == 0.0 and direction[2] == 0.0
        least = np.inf
        depth = 1
        stack[0] = 1
        reach[0] = 0.0
        while depth > 0:
            depth -= 1
            node = stack[depth]
            if reach[depth] >= least:
                continue
            if node >= leaf_count:
                first = LEAF_SIZE * (node - leaf_count)
                for t in range(first, min(first + LEAF_SIZE, corners.shape[0])):
                    a, b, c = corners[t]
                    u, v, w = closest_on_triangle(point, a, b, c)
                    squared = facing = 0.0
                    for i in range(3):
                        squared += (u * a[i] + v * b[i] + w * c[i] - point[i]) ** 2
                        facing += face_normals[t, i] * direction[i]
                    distance = np.sqrt(squared)
                    turned = 0.0 if any_direction else min(max(least_cosine - facing, 0.0), 1.0)
                    if distance + wrong_side * turned < least:
                        least = distance + wrong_side * turned
                        distances[q] = distance
                        triangles[q] = t
                        weights[q, 0] = u
                        weights[q, 1] = v
                        weights[q, 2] = w
                continue
            left = _box_distance(boxes[2 * node], point)
            right = _box_distance(boxes[2 * node + 1], point)
            far = 0 if left > right else 1  # the nearer one is on top of the stack
            stack[depth] = 2 * node + far
            reach[depth] = max(left, right)
            stack[depth + 1] = 2 * node + 1 - far
            reach[depth + 1] = min(left, right)
            depth += 2


@njit
def closest_on_triangle(
    point: Floats64, a: Floats64, b: Floats64, c: Floats64
) -> tuple[float, float, float]:
    """Barycentric coordinates of the point of triangle a, b, c that is closest to another point."""
    first = vector_of(a)
    ab = less(vector_of(b), 1.0, first)
    ac = less(vector_of(c), 1.0, first)
    away = less(vector_of(point), 1.0, first)
    d1 = dot(ab, away)
    d2 = dot(ac, away)
    if d1 <= 0.0 and d2 <= 0.0:
        return 1.0, 0.0, 0.0
    uu = dot(ab, ab)
    uv = dot(ab, ac)
    vv = dot(ac, ac)
    d3 = d1 - uu
    d4 = d2 - uv
    d5 = d1 - uv
    d6 = d2 - vv
    if d3 >= 0.0 and d4 <= d3:
        return 0.0, 1.0, 0.0
    if d6 >= 0.0 and d5 <= d6:
        return 0.0, 0.0, 1.0
    on_ab = d1 * d4 - d3 * d2
    if on_ab <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        t = d1 / (d1 - d3)
        return 1.0 - t, t, 0.0
    on_ac = d5 * d2 - d1 * d6
    if on_ac <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        t = d2 / (d2 - d6)
        return 1.0 - t, 0.0, t
    on_bc = d3 * d6 - d5 * d4
    if on_bc <= 0.0 and d4 >= d3 and d5 >= d6:
        t = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        return 0.0, 1.0 - t, t
    total = on_ab + on_ac + on_bc
    return on_bc / total, on_ac / total, on_ab / total
