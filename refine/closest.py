"""Closest points on a triangle mesh, for binding a coarse mesh to a finer one.

A search in two steps: the closest vertex that looks the same way, found in a grid of cells; from
its triangles downhill over neighbouring triangles until none is closer. On a surface that is finer
than the distances that are asked for this is the closest point; and lips that touch at rest do not
take each other's points, which the very closest point would.

After Ericson 2005, "Real-time collision detection", section 5.1.5, for one triangle.
"""

import numpy as np
import numpy.typing as npt

from .jit import njit
from .normals import vertex_normals

Floats = npt.NDArray[np.float32]
Doubles = npt.NDArray[np.float64]
Unsigned = npt.NDArray[np.uint32]
Wide = npt.NDArray[np.int64]

SAME_WAY = 0.2
"""Cosine between normals above which two surfaces look the same way. Chosen: 78 degrees."""
GIVE_UP = 100.0
"""Ten times as far as the closest vertex nothing is searched for any more (squared)."""
MOST_STEPS = 64
"""Steps downhill; a handful are taken, this only ends circles of equals."""


class Surface:
    """A mesh to find closest points on: `positions`, shape (V, 3), `faces`, shape (F, 3)."""

    def __init__(self, positions: Doubles, faces: Unsigned) -> None:
        self.positions = positions
        self.faces = faces
        self.normals = np.zeros(positions.shape, dtype=np.float32)
        vertex_normals(positions, faces, self.normals)
        used = np.unique(faces)
        order = np.argsort(faces.ravel(), kind="stable")
        counts = np.bincount(faces.ravel(), minlength=len(positions))
        self._starts = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
        self._triangles = (order // 3).astype(np.int64)
        self._lowest = positions[used].min(axis=0)
        extent = positions[used].max(axis=0) - self._lowest
        # Two vertices or so in each cell that the surface passes through.
        self._cell = max(float(np.sqrt((extent**2).sum() / max(len(used), 1))), 1e-12)
        self._shape = np.minimum(extent // self._cell + 1, 512).astype(np.int64)
        cells = np.minimum((positions[used] - self._lowest) // self._cell, self._shape - 1)
        number = cells.astype(np.int64) @ np.array(
            [1, self._shape[0], self._shape[0] * self._shape[1]]
        )
        by_cell = np.argsort(number, kind="stable")
        self._members = used[by_cell].astype(np.int64)
        sizes = np.bincount(number, minlength=int(self._shape.prod()))
        self._cell_starts = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)

    def closest(self, points: Doubles, normals: Doubles) -> tuple[Wide, Doubles]:
        """Return triangle, shape (N,), and barycentric coordinates, shape (N, 3), for each point.

        `normals`: which way the surface looks at the points, shape (N, 3), zero for any way.
        """
        triangles = np.zeros(len(points), dtype=np.int64)
        weights = np.zeros((len(points), 3))
        find_closest(
            np.ascontiguousarray(points),
            np.ascontiguousarray(normals),
            self.positions,
            self.normals,
            self.faces,
            self._starts,
            self._triangles,
            self._lowest,
            self._cell,
            self._shape,
            self._cell_starts,
            self._members,
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


@njit
def closest_vertex(
    point: Doubles,
    normal: Doubles,
    positions: Doubles,
    normals: Floats,
    lowest: Doubles,
    cell: float,
    shape: Wide,
    cell_starts: Wide,
    members: Wide,
) -> int:
    """Return the closest vertex that looks the same way, or the closest of all if none does."""
    centre = np.empty(3, np.int64)
    for i in range(3):
        inside = np.floor((point[i] - lowest[i]) / cell)
        centre[i] = np.int64(min(max(inside, 0.0), shape[i] - 1.0))
    outside = 0.0
    for i in range(3):
        low, high = lowest[i], lowest[i] + cell * shape[i]
        outside = max(outside, low - point[i], point[i] - high)
    best, any_best = -1, -1
    distance, any_distance = np.inf, np.inf
    for reach in range(max(shape[0], max(shape[1], shape[2])) + 1):
        # Everything nearer than this has been seen.
        seen = (reach - 1) * cell
        if best >= 0 and distance < seen * seen and seen > outside:
            break
        if any_best >= 0 and seen * seen > GIVE_UP * any_distance and seen > outside:
            break
        for x in range(max(centre[0] - reach, 0), min(centre[0] + reach + 1, shape[0])):
            for y in range(max(centre[1] - reach, 0), min(centre[1] + reach + 1, shape[1])):
                shell = max(abs(x - centre[0]), abs(y - centre[1])) == reach
                step = 1 if shell else max(2 * reach, 1)
                for z in range(centre[2] - reach, centre[2] + reach + 1, step):
                    if z < 0 or z >= shape[2]:
                        continue
                    number = x + shape[0] * (y + shape[1] * z)
                    for k in range(cell_starts[number], cell_starts[number + 1]):
                        v = members[k]
                        square = same = size = 0.0
                        for i in range(3):
                            square += (positions[v, i] - point[i]) ** 2
                            same += normals[v, i] * normal[i]
                            size += normal[i] * normal[i]
                        if square < any_distance:
                            any_distance, any_best = square, v
                        if square < distance and (same > SAME_WAY or size == 0.0):
                            distance, best = square, v
    return best if best >= 0 else any_best


@njit
def find_closest(
    points: Doubles,
    point_normals: Doubles,
    positions: Doubles,
    normals: Floats,
    faces: Unsigned,
    starts: Wide,
    incident: Wide,
    lowest: Doubles,
    cell: float,
    shape: Wide,
    cell_starts: Wide,
    members: Wide,
    triangles: Wide,
    weights: Doubles,
) -> None:
    """Write the triangle and the place on it that is closest to each point."""
    vertices = np.empty(3, np.int64)
    for n in range(points.shape[0]):
        px, py, pz = points[n, 0], points[n, 1], points[n, 2]
        v = closest_vertex(
            points[n],
            point_normals[n],
            positions,
            normals,
            lowest,
            cell,
            shape,
            cell_starts,
            members,
        )
        vertices[:] = v
        best, best_triangle = np.inf, -1
        for _ in range(MOST_STEPS):
            has_improved = False
            for corner in range(3):
                v = vertices[corner]
                for k in range(starts[v], starts[v + 1]):
                    t = incident[k]
                    a, b, c = positions[faces[t, 0]], positions[faces[t, 1]], positions[faces[t, 2]]
                    x, y, z = closest_on_triangle(px, py, pz, a, b, c)
                    square = 0.0
                    for i in range(3):
                        square += (x * a[i] + y * b[i] + z * c[i] - points[n, i]) ** 2
                    if square < best:
                        best, best_triangle, has_improved = square, t, True
                        weights[n, 0], weights[n, 1], weights[n, 2] = x, y, z
            if not has_improved:
                break
            for corner in range(3):
                vertices[corner] = faces[best_triangle, corner]
        triangles[n] = best_triangle
