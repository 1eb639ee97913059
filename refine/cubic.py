r"""Cubic edges from end points and normals: the scheme named `cubic`.

The border curves of curved PN triangles (Vlachos, Peters, Boyd, Mitchell 2001): the cubic that
starts at a in the plane across its normal, and arrives at b in the plane across its own. With
d = b - a, and heights h_a = d . n_a, h_b = d . n_b over these planes:

    middle         (a + b) / 2    -  ( h_a n_a -     h_b n_b) /  8
    near a      (3 a + b) / 4     -  (9 h_a n_a - 3 h_b n_b) / 64
    near b      (a + 3 b) / 4     -  (3 h_a n_a - 9 h_b n_b) / 64

Differs from PN triangles: the normals are weighted by the geometric mean of a triangle's angle and
its area at rest. Angle alone is truest on smooth surfaces, area alone where decimation has left
folds of small triangles; between them both lose little. And a mean over the triangles around shows
what bends less than it does; so where heights are taken, not where light falls, normals go a little
further from those of their neighbours than they are: n - 0.15 x mean of the neighbours, normalised.
On a plane and a sphere of equal triangles that changes nothing. An edge on a border is cubic in the
border curve itself, because a surface's normal says nothing about where it ends.

The middle of a triangle (blend.py) hears a second opinion. Its edges say from the normals how far
the surface stands out; the corners across them say it from places:

          c           depth     how far c lies below the plane of triangle 1
         / \          expected  the same, if the surface were the one quadratic height over this
        /   \                   plane whose middles of edges are those that the normals gave
       a-----b        share     area of 1 / (area of 1 + area of 2): a fold reaches no farther than
        \ 1 /                   the smaller triangle
         \ /          higher by sum over edges of  share x (depth - expected) / 9,  times 0.6

Where normals and places agree, as on smooth surfaces, nothing is added. Where decimation has left
folds the errors of one have little to do with those of the other, and both together are nearer.
"""

import numpy as np
import numpy.typing as npt

from .connectivity import Connectivity
from .curves import CurveScheme
from .kernels import kernel
from .lanes import four, write
from .native import native, with_room
from .schemes import Frame

Floats = npt.NDArray[np.float32]
Doubles = npt.NDArray[np.float64]
Unsigned = npt.NDArray[np.uint32]

FULLNESS = np.float32(1.2)
"""How much more than the cubic an inner edge bulges. Triangles between curves are flat, so the best
fit stands out a little; measured on ellipsoids, a torus and heads, flat between 1.1 and 1.25."""
STEEPER = np.float32(0.15)
"""Share of the mean normal around that is taken off a normal. A first step of undoing the mean that
vertex normals are; a second, or more of it, finds the noise of decimated meshes. Measured on two
faces and their decimations: half a point of 35 % better on scans, level on smooth heads, and half a
point worse on the roughest and on a torus."""
CENTRE_FULLNESS = np.float32(1.15)
"""How much farther the middle of a triangle stands out, which the largest flat triangles meet."""
SECOND_OPINION = 0.6
"""Share of what the triangles around say otherwise that a middle follows. On a sphere of equal
triangles they show half its height, so this is three tenths of the way; measured on two faces and
their decimations, flat between 0.4 and 0.8."""
MOST_EXPECTED = 2.0
"""Sum of weights (of the heights of edges) above which a triangle hears less of those around: it is
narrow, and they lie far from it. Three in four of a decimated face have less."""
FLATTENED = np.float32(1e-3)
"""Squared area over squared sides at which a triangle has half lost its direction, 1/48 at most."""
EIGHTH = np.float32(1 / 8)
"""Share of the end tangents in the middle of a cubic."""
NEAR, FAR = np.float32(9 / 64), np.float32(3 / 64)
"""Share of the nearer and of the farther tangent at a quarter of a cubic."""
SLIVER = 1e-9
"""Sine of an angle below which a triangle has no direction."""
MIDDLE, NEAR_START, NEAR_END = 1, 0, 2
"""Points of an edge in an array of bulges (curves.py)."""
ZERO = np.float32(0.0)
HALF = np.float32(0.5)
THIRD = np.float32(1 / 3)
ONE = np.float32(1.0)
TINY = np.finfo(np.float32).tiny


class CubicScheme(CurveScheme):
    """Edges are cubic curves across the normals at their ends."""

    def bind(
        self,
        connectivity: Connectivity,
        rest_positions: Doubles,
        rest_normals: Floats,
    ) -> None:
        """Weigh the corners of the mesh at rest, and follow its borders."""
        super().bind(connectivity, rest_positions, rest_normals)
        self._weights = np.zeros(connectivity.faces.shape, dtype=np.float32)
        weigh_corners(rest_positions, connectivity.faces, self._weights)
        self._normals = with_room(np.zeros_like(rest_normals))
        self._steeper = np.zeros_like(rest_normals)
        valences = np.bincount(connectivity.edges.ravel(), minlength=len(rest_normals))
        self._steepen = steepen_normals.bind(
            self._normals,
            connectivity.edges.view(np.uint32),
            (STEEPER / np.maximum(valences, 1)).astype(np.float32),
            np.zeros((len(rest_normals), 4), np.float32),
            self._steeper,
        )
        self._beyond = np.zeros((len(connectivity.edges), 2), dtype=np.uint32)
        follow_borders(connectivity.edges, connectivity.is_interior, rest_normals, self._beyond)
        self._across = connectivity.faces.copy()
        self._shares = np.zeros((len(connectivity.faces), 6), dtype=np.float32)
        weigh_neighbours(
            rest_positions,
            connectivity.faces,
            connectivity.triangle_edges,
            connectivity.edge_sides,
            connectivity.is_interior,
            self._across,
            self._shares,
        )

    def _vertex_normals(self, frame: Frame) -> Floats:
        if frame.once_count == 0:
            weighted_normals(
                frame.positions, self._connectivity.faces, self._weights, self._normals
            )
        return self._normals

    def place_centres(self, frame: Frame) -> None:
        """Raise the points in the middle of triangles as far as the edges around have grown."""
        assert frame.centre_triangles is not None
        raise_centres(
            self._connectivity.faces,
            self._connectivity.triangle_edges,
            frame.splits,
            frame.growth_once,
            frame.first_points,
            self._across,
            self._shares,
            frame.centre_triangles,
            frame.centre_count,
            frame.first_centre,
            frame.rows,
        )

    def _bulge(self, frame: Frame, bulges: Floats) -> None:
        if frame.once_count > 0:
            self._bulge_cubic(frame.positions, frame.split_once, frame.once_count, bulges)

    def _bulge_cubic(
        self, positions: Doubles, split_once: Unsigned, once_count: int, bulges: Floats
    ) -> None:
        mesh = self._connectivity
        weighted_normals(positions, mesh.faces, self._weights, self._normals)
        self._steepen()
        bulge_cubic(
            positions,
            self._steeper,
            mesh.edge_points,
            mesh.is_interior,
            self._beyond,
            split_once,
            once_count,
            bulges,
        )


@kernel
def weigh_corners(positions: Doubles, faces: Unsigned, weights: Floats) -> None:
    """Write sqrt(angle / |cross product|) of every corner, shape (F, 3); 0 without an area."""
    for t in range(faces.shape[0]):
        for i in range(3):
            a, b, c = faces[t, i], faces[t, (i + 1) % 3], faces[t, (i + 2) % 3]
            ux, vx = positions[b, 0] - positions[a, 0], positions[c, 0] - positions[a, 0]
            uy, vy = positions[b, 1] - positions[a, 1], positions[c, 1] - positions[a, 1]
            uz, vz = positions[b, 2] - positions[a, 2], positions[c, 2] - positions[a, 2]
            x, y, z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
            cross, dot = np.sqrt(x * x + y * y + z * z), ux * vx + uy * vy + uz * vz
            size = np.sqrt((ux * ux + uy * uy + uz * uz) * (vx * vx + vy * vy + vz * vz))
            weights[t, i] = (
                np.sqrt(np.arctan2(cross, dot) / cross) if cross > SLIVER * size else 0.0
            )


@kernel
def follow_borders(
    edges: npt.NDArray[np.int32],
    is_interior: npt.NDArray[np.bool_],
    normals: Floats,
    beyond: Unsigned,
) -> None:
    """Write the vertices before and after every border edge, or its ends where its border ends."""
    vertex_count = normals.shape[0]
    border_count = np.zeros(vertex_count, np.int32)
    sums = np.zeros(vertex_count, np.int64)
    for e in range(edges.shape[0]):
        if not is_interior[e]:
            a, b = edges[e, 0], edges[e, 1]
            border_count[a] += 1
            border_count[b] += 1
            sums[a] += b
            sums[b] += a
    for e in range(edges.shape[0]):
        a, b = edges[e, 0], edges[e, 1]
        # Of two neighbours along the border the sum less one is the other.
        beyond[e, 0] = sums[a] - b if border_count[a] == 2 else a
        beyond[e, 1] = sums[b] - a if border_count[b] == 2 else b


@kernel
def weighted_normals(positions: Doubles, faces: Unsigned, weights: Floats, normals: Floats) -> None:
    """Write unit vertex normals, each corner weighted as at rest, shape (V, 3)."""
    normals[:] = ZERO
    for t in range(faces.shape[0]):
        a, b, c = faces[t, 0], faces[t, 1], faces[t, 2]
        ux = np.float32(positions[b, 0] - positions[a, 0])
        uy = np.float32(positions[b, 1] - positions[a, 1])
        uz = np.float32(positions[b, 2] - positions[a, 2])
        vx = np.float32(positions[c, 0] - positions[a, 0])
        vy = np.float32(positions[c, 1] - positions[a, 1])
        vz = np.float32(positions[c, 2] - positions[a, 2])
        x, y, z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        for i in range(3):
            v, weight = faces[t, i], weights[t, i]
            normals[v, 0] += weight * x
            normals[v, 1] += weight * y
            normals[v, 2] += weight * z
    for v in range(normals.shape[0]):
        x, y, z = normals[v, 0], normals[v, 1], normals[v, 2]
        scale = ONE / np.sqrt(max(x * x + y * y + z * z, TINY))
        normals[v, 0], normals[v, 1], normals[v, 2] = x * scale, y * scale, z * scale


@native
def steepen_normals(
    normals: Floats, edges: Unsigned, off: Floats, sums: Floats, steeper: Floats
) -> None:
    """Write unit normals less those of their neighbours, `off` of each, shape (V,).

    `normals` have room (lanes.py); `sums`: scratch, shape (V, 4).
    """
    for v in range(sums.shape[0]):
        sums[v, 0] = sums[v, 1] = sums[v, 2] = sums[v, 3] = ZERO
    for e in range(edges.shape[0]):
        a, b = edges[e, 0], edges[e, 1]
        write(sums, a, four(sums, a) + four(normals, b))
        write(sums, b, four(sums, b) + four(normals, a))
    for v in range(sums.shape[0]):
        x = normals[v, 0] - off[v] * sums[v, 0]
        y = normals[v, 1] - off[v] * sums[v, 1]
        z = normals[v, 2] - off[v] * sums[v, 2]
        scale = ONE / np.sqrt(max(x * x + y * y + z * z, TINY))
        steeper[v, 0], steeper[v, 1], steeper[v, 2] = x * scale, y * scale, z * scale


@kernel
def bulge_cubic(
    positions: Doubles,
    normals: Floats,
    edge_points: Unsigned,
    is_interior: npt.NDArray[np.bool_],
    beyond: Unsigned,
    split_once: Unsigned,
    once_count: int,
    bulges: Floats,
) -> None:
    """Write the bulges of the split edges: those of the cubic with the tangents at both ends."""
    d = np.empty(3, np.float32)
    for k in range(once_count):
        e = split_once[k]
        a, b = edge_points[e, 0], edge_points[e, 1]
        for i in range(3):
            d[i] = positions[b, i] - positions[a, i]
        if is_interior[e]:
            height_a = d[0] * normals[a, 0] + d[1] * normals[a, 1] + d[2] * normals[a, 2]
            height_b = d[0] * normals[b, 0] + d[1] * normals[b, 1] + d[2] * normals[b, 2]
            for i in range(3):
                # How much the tangents turn away from the straight edge.
                turn_a = -FULLNESS * height_a * normals[a, i]
                turn_b = -FULLNESS * height_b * normals[b, i]
                bulges[e, MIDDLE, i] = EIGHTH * (turn_a - turn_b)
                bulges[e, NEAR_START, i] = NEAR * turn_a - FAR * turn_b
                bulges[e, NEAR_END, i] = FAR * turn_a - NEAR * turn_b
            continue
        p, q = beyond[e, 0], beyond[e, 1]
        length = before = after = ZERO
        for i in range(3):
            length += d[i] * d[i]
            before += np.float32(positions[a, i] - positions[p, i]) ** 2
            after += np.float32(positions[q, i] - positions[b, i]) ** 2
        length, before, after = np.sqrt(length), np.sqrt(before), np.sqrt(after)
        share_a = length / max(length + before, TINY)
        share_b = length / max(length + after, TINY)
        for i in range(3):
            turn_a = share_a * np.float32(positions[b, i] - positions[p, i]) - d[i]
            turn_b = share_b * np.float32(positions[q, i] - positions[a, i]) - d[i]
            bulges[e, MIDDLE, i] = EIGHTH * (turn_a - turn_b)
            bulges[e, NEAR_START, i] = NEAR * turn_a - FAR * turn_b
            bulges[e, NEAR_END, i] = FAR * turn_a - NEAR * turn_b


@kernel
def measure_triangles(
    positions: Doubles, faces: Unsigned, doubled: Doubles, squared: Doubles
) -> None:
    """Write twice the areas, shape (F,), 0 of slivers, and squared edges, shape (F, 3)."""
    d = np.empty((3, 3))
    for t in range(faces.shape[0]):
        for i in range(3):
            a, b = faces[t, i], faces[t, (i + 1) % 3]
            for k in range(3):
                d[i, k] = positions[b, k] - positions[a, k]
                squared[t, i] += d[i, k] * d[i, k]
        x = d[0, 1] * d[1, 2] - d[0, 2] * d[1, 1]
        y = d[0, 2] * d[1, 0] - d[0, 0] * d[1, 2]
        z = d[0, 0] * d[1, 1] - d[0, 1] * d[1, 0]
        area = np.sqrt(x * x + y * y + z * z)
        doubled[t] = area if area > SLIVER * squared[t].sum() else 0.0


@kernel
def weigh_neighbours(
    positions: Doubles,
    faces: Unsigned,
    triangle_edges: npt.NDArray[np.int32],
    edge_sides: Unsigned,
    is_interior: npt.NDArray[np.bool_],
    across: Unsigned,
    shares: Floats,
) -> None:
    """Write the corners across the edges of each triangle, (F, 3), and weights, shape (F, 6).

    Weights: of the depths of these corners, then of the bulges of the edges, which say how deep the
    corners are expected. A border edge has no corner across it, and weight 0.
    """
    face_count = faces.shape[0]
    doubled, squared = np.zeros(face_count), np.zeros((face_count, 3))
    measure_triangles(positions, faces, doubled, squared)
    for t in range(face_count):
        size = 0.0
        for i in range(3):
            e = triangle_edges[t, i]
            across[t, i] = faces[t, i]
            if e < 0 or not is_interior[e] or doubled[t] == 0.0:
                continue
            side = edge_sides[e, 1 if edge_sides[e, 0] >> 2 == t else 0]
            u, j = side >> 2, side & 3
            if doubled[u] == 0.0:
                continue
            after, before = (i + 1) % 3, (i + 2) % 3
            across[t, i] = faces[u, (j + 2) % 3]
            share = doubled[t] / (doubled[t] + doubled[u]) / 9.0
            shares[t, i] = share
            # The corner across in coordinates of this triangle, the other one unfolded into it.
            along = 0.5 * (squared[t, i] + squared[t, before] - squared[t, after]) / squared[t, i]
            there = 0.5 * (squared[u, j] + squared[u, (j + 1) % 3] - squared[u, (j + 2) % 3])
            of_c = -doubled[u] / doubled[t]
            of_b = there / squared[t, i] - of_c * along
            of_a = 1.0 - of_b - of_c
            # Over a quadratic height it lies 4 x (sum of these products x bulges) above the plane.
            shares[t, 3 + i] += share * 4.0 * of_a * of_b
            shares[t, 3 + after] += share * 4.0 * of_b * of_c
            shares[t, 3 + before] += share * 4.0 * of_c * of_a
        for i in range(3):
            size += abs(shares[t, 3 + i])
        gain = SECOND_OPINION * CENTRE_FULLNESS * min(1.0, MOST_EXPECTED / max(size, SLIVER))
        for i in range(3):
            shares[t, i] *= gain * FULLNESS
            shares[t, 3 + i] *= gain


@kernel
def raise_centres(
    faces: Unsigned,
    triangle_edges: npt.NDArray[np.int32],
    splits: npt.NDArray[np.uint8],
    growth_once: Floats,
    first_points: Unsigned,
    across: Unsigned,
    shares: Floats,
    centre_triangles: Unsigned,
    centre_count: int,
    first_centre: int,
    vertices: Floats,
) -> None:
    """Move the points in the middle of triangles to where edges and triangles around have them."""
    # In double: the fourth power of a length is beyond single precision for many a unit of length.
    u, v, higher = np.empty(3), np.empty(3), np.empty(3)
    for k in range(centre_count):
        t, row = centre_triangles[k], first_centre + k
        growth = ONE
        for i in range(3):
            growth = min(growth, growth_once[triangle_edges[t, i]])
        if growth <= ZERO:
            continue  # not all edges have a middle
        higher[:] = 0.0
        for j in range(3):
            a, b, c, e = faces[t, j], faces[t, (j + 1) % 3], across[t, j], triangle_edges[t, j]
            m = first_points[e] + (splits[e] >> 1)
            for i in range(3):
                bulge = vertices[m, i] - HALF * (vertices[a, i] + vertices[b, i])
                depth = vertices[a, i] - vertices[c, i]
                higher[i] += shares[t, j] * depth + shares[t, 3 + j] * bulge
        a, b, c = faces[t, 0], faces[t, 1], faces[t, 2]
        squares = 0.0
        for i in range(3):
            at_a, at_b, at_c = vertices[a, i], vertices[b, i], vertices[c, i]
            u[i], v[i] = at_b - at_a, at_c - at_a
            squares += u[i] * u[i] + v[i] * v[i] + (v[i] - u[i]) * (v[i] - u[i])
            flat = THIRD * (at_a + at_b + at_c)
            vertices[row, i] += (CENTRE_FULLNESS - ONE) * growth * (vertices[row, i] - flat)
        x = u[1] * v[2] - u[2] * v[1]
        y = u[2] * v[0] - u[0] * v[2]
        z = u[0] * v[1] - u[1] * v[0]
        # Along the normal; a triangle that has been crushed to a line has none.
        area = x * x + y * y + z * z + FLATTENED * squares * squares
        height = growth * (x * higher[0] + y * higher[1] + z * higher[2]) / max(area, TINY)
        vertices[row, 0] += np.float32(height * x)
        vertices[row, 1] += np.float32(height * y)
        vertices[row, 2] += np.float32(height * z)
