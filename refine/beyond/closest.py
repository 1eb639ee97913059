"""Closest points on a triangle mesh, for binding a coarse mesh to a finer one.

A search in two steps: the closest vertex that looks the same way, found in a tree of boxes; from
its triangles downhill over neighbouring triangles until none is closer. On a surface that is finer
than the distances that are asked for this is the closest point; and lips that touch at rest do not
take each other's points, which the very closest point would.

The tree halves vertices, not space, so that it is as deep where they cluster as where they do not.

After Bentley 1975, "Multidimensional binary search trees used for associative searching"; Ericson
2005, "Real-time collision detection", section 5.1.5, for one triangle.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ...jit import njit
from ..mesh.arrays import Doubles, Floats, Unsigned, Wide
from ..mesh.normals import vertex_normals

SAME_WAY = 0.2
"""Cosine between normals above which two surfaces look the same way. Chosen: 78 degrees."""
GIVE_UP = 100.0
"""Ten times as far as the closest vertex nothing is searched for any more (squared)."""
MOST_VISITED = 4096
"""Vertices that are looked at for one that looks the same way, before the closest of all counts: a
bound for thousands of vertices in one place."""
LEAF = 8
"""Most vertices in a box that is not halved."""
MOST_STEPS = 64
"""Steps downhill; a handful are taken, this only ends circles of equals."""


class Incidence(NamedTuple):
    """The triangles around each vertex v: `triangles[starts[v]:starts[v + 1]]`."""

    starts: Wide
    triangles: Wide


class Tree(NamedTuple):
    """Boxes around vertices, each halved into numbers 2 k + 1 and 2 k + 2 while it is large."""

    lows: Doubles
    """Lowest corner of each box, shape (K, 3)."""
    highs: Doubles
    """Its highest corner, shape (K, 3)."""
    ranges: Wide
    """The vertices in it, first and end, among `members`, shape (K, 2)."""
    members: Wide
    """Numbers of vertices."""


class SearchSurface:
    """A mesh to find closest points on: `positions`, shape (V, 3), `faces`, shape (F, 3)."""

    def __init__(self, positions: Doubles, faces: Unsigned) -> None:
        self.positions = positions
        self.faces = faces
        self.normals = np.zeros(positions.shape, dtype=np.float32)
        vertex_normals(positions, faces, self.normals)
        order = np.argsort(faces.ravel(), kind="stable")
        counts = np.bincount(faces.ravel(), minlength=len(positions))
        self._around = Incidence(
            np.concatenate([[0], np.cumsum(counts)]).astype(np.int64), (order // 3).astype(np.int64)
        )
        self._tree = tree_of(positions, np.unique(faces).astype(np.int64))

    def closest(self, points: Doubles, normals: Doubles) -> tuple[Wide, Doubles]:
        """Return triangle, shape (N,), and barycentric coordinates, shape (N, 3), for each point.

        `normals`: which way the surface looks at the points, shape (N, 3), zero for any way.
        """
        triangles = np.zeros(len(points), dtype=np.int64)
        weights = np.zeros((len(points), 3))
        find_closest(
            (np.ascontiguousarray(points), np.ascontiguousarray(normals)),
            (self.positions, self.normals, self.faces),
            self._around,
            self._tree,
            triangles,
            weights,
        )
        return triangles, weights

    def at(self, values: npt.NDArray[np.floating], triangles: Wide, weights: Doubles) -> Doubles:
        """Interpolate values of vertices, shape (V, k), at places on the surface, shape (N, k)."""
        corners: Doubles = np.einsum("nik,ni->nk", values[self.faces[triangles]], weights)
        return corners


@njit
def closest_on_triangle(
    px: float, py: float, pz: float, a: Doubles, b: Doubles, c: Doubles
) -> tuple[float, float, float]:
    """Return barycentric coordinates of the point of triangle a, b, c that is closest to p."""
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    wx, wy, wz = px - a[0], py - a[1], pz - a[2]
    d1, d2 = ux * wx + uy * wy + uz * wz, vx * wx + vy * wy + vz * wz
    if d1 <= 0.0 and d2 <= 0.0:
        return 1.0, 0.0, 0.0
    uu, uv, vv = (
        ux * ux + uy * uy + uz * uz,
        ux * vx + uy * vy + uz * vz,
        vx * vx + vy * vy + vz * vz,
    )
    d3, d4, d5, d6 = d1 - uu, d2 - uv, d1 - uv, d2 - vv
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


def tree_of(positions: Doubles, members: Wide) -> Tree:
    """Halve vertices, across the longest side of their box, until there are few in each."""
    levels = max(0, int(np.ceil(np.log2(max(len(members), 1) / LEAF))))
    count = 2 ** (levels + 1) - 1
    tree = Tree(np.zeros((count, 3)), np.zeros((count, 3)), np.zeros((count, 2), np.int64), members)
    halve(positions, tree)
    return tree


@njit
def halve(positions: Doubles, tree: Tree) -> None:
    """Sort the members of a tree, and measure its boxes."""
    count = tree.lows.shape[0]
    tree.ranges[0, 1] = tree.members.shape[0]
    for k in range(count):
        first, end = tree.ranges[k]
        inside = tree.members[first:end]
        longest, axis = -1.0, 0
        for i in range(3):
            low, high = np.inf, -np.inf
            for v in inside:
                low, high = min(low, positions[v, i]), max(high, positions[v, i])
            tree.lows[k, i], tree.highs[k, i] = low, high
            if high - low > longest:
                longest, axis = high - low, i
        if 2 * k + 2 < count:
            along = np.empty(end - first)
            for n in range(end - first):
                along[n] = positions[inside[n], axis]
            tree.members[first:end] = inside[np.argsort(along, kind="mergesort")]
            middle = (first + end) // 2
            tree.ranges[2 * k + 1] = first, middle
            tree.ranges[2 * k + 2] = middle, end


@njit
def away_from(point: Doubles, tree: Tree, k: int) -> float:
    """Squared distance of a point from a box; infinite if nothing is in it."""
    squared = 0.0
    for i in range(3):
        beside = max(tree.lows[k, i] - point[i], 0.0, point[i] - tree.highs[k, i])
        squared += beside * beside
    return squared


@njit
def closest_vertex(
    point: Doubles, normal: Doubles, positions: Doubles, normals: Floats, tree: Tree
) -> int:
    """Return the closest vertex that looks the same way, or the closest of all if none does."""
    waiting, distances = np.empty(128, np.int64), np.empty(128)
    waiting[0], distances[0], count, visited = 0, 0.0, 1, 0
    best, any_best = -1, -1
    distance, any_distance = np.inf, np.inf
    while count > 0 and (best >= 0 or visited < MOST_VISITED):
        count -= 1
        k = waiting[count]
        if distances[count] > min(distance, GIVE_UP * any_distance):
            continue
        if 2 * k + 2 < tree.lows.shape[0]:
            # The nearer half is looked at first.
            left, right = away_from(point, tree, 2 * k + 1), away_from(point, tree, 2 * k + 2)
            near, far = (0, 1) if right < left else (1, 0)
            waiting[count + near], distances[count + near] = 2 * k + 1, left
            waiting[count + far], distances[count + far] = 2 * k + 2, right
            count += 2
            continue
        for n in range(tree.ranges[k, 0], tree.ranges[k, 1]):
            v = tree.members[n]
            square = same = size = 0.0
            for i in range(3):
                square += (positions[v, i] - point[i]) ** 2
                same += normals[v, i] * normal[i]
                size += normal[i] * normal[i]
            visited += 1
            if square < any_distance:
                any_distance, any_best = square, v
            if square < distance and (same > SAME_WAY or size == 0.0):
                distance, best = square, v
    return best if best >= 0 else any_best


@njit
def find_closest(
    asked: tuple[Doubles, Doubles],
    surface: tuple[Doubles, Floats, Unsigned],
    around: Incidence,
    tree: Tree,
    triangles: Wide,
    weights: Doubles,
) -> None:
    """Write the triangle and the place on it that is closest to each point.

    `asked`: points and normals there; `surface`: positions, normals and triangles.
    """
    points, point_normals = asked
    positions, normals, faces = surface
    vertices, before = np.empty(3, np.int64), np.empty(3, np.int64)
    for n in range(points.shape[0]):
        px, py, pz = points[n, 0], points[n, 1], points[n, 2]
        vertices[:] = closest_vertex(points[n], point_normals[n], positions, normals, tree)
        best, best_triangle = np.inf, -1
        before[:] = -1
        for _ in range(MOST_STEPS):
            has_improved = False
            for corner in range(3):
                v = vertices[corner]
                if v == before[0] or v == before[1] or v == before[2]:
                    continue  # its triangles have been looked at
                for k in range(around.starts[v], around.starts[v + 1]):
                    t = around.triangles[k]
                    a, b, c = positions[faces[t, 0]], positions[faces[t, 1]], positions[faces[t, 2]]
                    x, y, z = closest_on_triangle(px, py, pz, a, b, c)
                    square = 0.0
                    for i in range(3):
                        square += (x * a[i] + y * b[i] + z * c[i] - points[n, i]) ** 2
                    if square < best:
                        best, best_triangle, has_improved = square, t, True
                        weights[n, 0], weights[n, 1], weights[n, 2] = x, y, z
                if corner == 0 and vertices[1] == v:
                    break  # the search begins in one vertex
            if not has_improved:
                break
            for corner in range(3):
                before[corner] = vertices[corner]
                vertices[corner] = faces[best_triangle, corner]
        triangles[n] = best_triangle
