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
from .lanes import four, single, write
from .native import Call, has_room, native, with_room
from .normals import clear, cross_product, normalise
from .schemes import Frame

Floats = npt.NDArray[np.float32]
Doubles = npt.NDArray[np.float64]
Unsigned = npt.NDArray[np.uint32]
Vector = tuple[np.float32, np.float32, np.float32]

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
MIDDLE, NEAR_END = 1, 2
"""Rows of the middle and of the far quarter of an edge, behind that of the near one (curves.py)."""
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
        self._beyond = np.zeros((len(connectivity.edges), 2), dtype=np.uint32)
        counts = np.zeros((2, len(rest_normals)), dtype=np.int64)
        follow_borders(
            connectivity.edges, connectivity.is_interior, counts[0], counts[1], self._beyond
        )
        self._across = connectivity.faces.copy()
        self._shares = np.zeros((len(connectivity.faces), 6), dtype=np.float32)
        doubled, squared = np.zeros(len(self._shares)), np.zeros((len(self._shares), 3))
        measure_triangles(rest_positions, connectivity.faces, doubled, squared)
        weigh_neighbours(
            connectivity.faces,
            connectivity.triangle_edges,
            connectivity.edge_sides,
            connectivity.is_interior,
            doubled,
            squared,
            self._across,
            self._shares,
        )

        self._normals = with_room(np.zeros_like(rest_normals))
        valences = np.bincount(connectivity.edges.ravel(), minlength=len(rest_normals))
        self._steeper_by = (STEEPER / np.maximum(valences, 1)).astype(np.float32)
        self._steeper = with_room(np.zeros_like(rest_normals))
        self._sums = np.zeros((2, len(rest_normals), 4), dtype=np.float32)

    def placing(self, frame: Frame) -> list[Call]:
        """Return the calls that place points in the arrays of a frame; `vertices` are its rows."""
        return [*self._bind_bulging(frame), *self._bind_pointing(frame)]

    def raising(self, frame: Frame) -> list[Call]:
        """Return the call that raises points in the middle of triangles, when others are there."""
        assert frame.centre_triangles is not None
        mesh = self._connectivity
        raising = raise_centres.bind(
            mesh.faces,
            mesh.triangle_edges,
            frame.splits,
            frame.growth_once,
            frame.first_points,
            self._across,
            self._shares,
            frame.centre_triangles,
            frame.counts,
            np.zeros((2, 3)),
            np.zeros(3),
            frame.rows,
        )
        return [raising]

    def _bind_bulging(self, frame: Frame) -> list[Call]:
        """Return the calls that find normals and bulges by the positions of a frame."""
        assert has_room(frame.positions)
        mesh = self._connectivity
        find_normals = weighted_normals.bind(
            frame.positions, mesh.faces, self._weights, self._sums[0], self._normals
        )
        bulge = bulge_cubic.bind(
            frame.positions,
            self._normals,
            mesh.edges.view(np.uint32),
            self._steeper_by,
            self._sums[1],
            self._steeper,
            mesh.edge_points,
            mesh.is_interior,
            self._beyond,
            frame.split_once,
            frame.counts,
            self._bulge_rows,
        )
        return [find_normals, bulge]

    def _vertex_normals(self, frame: Frame) -> Floats:
        return self._normals

    def _bulge(self, frame: Frame, bulges: Floats) -> None:
        frame.bound(self._bind_bulging)()

    def place_centres(self, frame: Frame) -> None:
        """Raise the points in the middle of triangles as far as the edges around have grown."""
        frame.bound(self.raising)()


@native
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


@native
def follow_borders(
    edges: npt.NDArray[np.int32],
    is_interior: npt.NDArray[np.bool_],
    border_count: npt.NDArray[np.int64],
    sums: npt.NDArray[np.int64],
    beyond: Unsigned,
) -> None:
    """Write the vertices before and after every border edge, or its ends where its border ends.

    `border_count`, `sums`: zeros, shape (V,).
    """
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


@native
def weighted_normals(
    positions: Doubles, faces: Unsigned, weights: Floats, sums: Floats, normals: Floats
) -> None:
    """Write unit vertex normals, each corner weighted as at rest, shape (V, 3).

    `positions` have room (lanes.py); `sums`: scratch, shape (V, 4).
    """
    clear(sums)
    for k in range(faces.shape[0]):
        t = np.uint64(k)
        a, b, c = faces[t, 0], faces[t, 1], faces[t, 2]
        normal = cross_product(positions, a, b, c)
        write(sums, a, four(sums, a) + weights[t, 0] * normal)
        write(sums, b, four(sums, b) + weights[t, 1] * normal)
        write(sums, c, four(sums, c) + weights[t, 2] * normal)
    normalise(sums, normals)


@native
def steepen_normals(
    normals: Floats, edges: Unsigned, off: Floats, sums: Floats, steeper: Floats
) -> None:
    """Write unit normals less those of their neighbours, `off` of each, shape (V,).

    `normals` have room (lanes.py); `sums`: scratch, shape (V, 4).
    """
    clear(sums)
    for k in range(edges.shape[0]):
        e = np.uint64(k)
        a, b = edges[e, 0], edges[e, 1]
        write(sums, a, four(sums, a) + four(normals, b))
        write(sums, b, four(sums, b) + four(normals, a))
    for v in range(sums.shape[0]):
        write(sums, v, four(normals, v) - off[v] * four(sums, v))
    normalise(sums, steeper)


@native
def along(d: Vector, normals: Floats, v: np.uint32) -> np.float32:
    """Height of an edge over the plane across a normal."""
    return np.float32(d[0] * normals[v, 0] + d[1] * normals[v, 1] + d[2] * normals[v, 2])


@native
def length_of(d: Vector) -> np.float32:
    """Length of an edge."""
    return np.float32(np.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]))


@native
def between(positions: Doubles, a: np.uint32, b: np.uint32) -> Vector:
    """The edge from a to b, rounded when it has been taken."""
    return (
        np.float32(positions[b, 0] - positions[a, 0]),
        np.float32(positions[b, 1] - positions[a, 1]),
        np.float32(positions[b, 2] - positions[a, 2]),
    )


@native
def bulge_cubic(
    positions: Doubles,
    normals: Floats,
    edges: Unsigned,
    off: Floats,
    sums: Floats,
    steeper: Floats,
    edge_points: Unsigned,
    is_interior: npt.NDArray[np.bool_],
    beyond: Unsigned,
    split_once: Unsigned,
    counts: npt.NDArray[np.int64],
    bulges: Floats,
) -> None:
    """Write the bulges of the split edges: those of the cubic with the tangents at both ends.

    `bulges`: three rows of three for each edge, with room (lanes.py), in which edges are written in
    their order; `counts`: see schemes.Frame; the others as for `steepen_normals`.
    """
    if counts[1] == 0:
        return
    steepen_normals(normals, edges, off, sums, steeper)
    for k in range(counts[1]):
        e = split_once[k]
        a, b, row = edge_points[e, 0], edge_points[e, 1], np.uint64(3) * np.uint64(e)
        if is_interior[e]:
            d = between(positions, a, b)
            # How much the tangents turn away from the straight edge.
            turn_a = (-FULLNESS * along(d, steeper, a)) * four(steeper, a)
            turn_b = (-FULLNESS * along(d, steeper, b)) * four(steeper, b)
        else:
            p, q = beyond[e, 0], beyond[e, 1]
            at_a, at_b = four(positions, a), four(positions, b)
            length = length_of(between(positions, a, b))
            share_a = length / max(length + length_of(between(positions, p, a)), TINY)
            share_b = length / max(length + length_of(between(positions, b, q)), TINY)
            straight = single(at_b - at_a)
            turn_a = share_a * single(at_b - four(positions, p)) - straight
            turn_b = share_b * single(four(positions, q) - at_a) - straight
        write(bulges, row, NEAR * turn_a - FAR * turn_b)
        write(bulges, row + np.uint64(MIDDLE), EIGHTH * (turn_a - turn_b))
        write(bulges, row + np.uint64(NEAR_END), FAR * turn_a - NEAR * turn_b)


@native
def measure_triangles(
    positions: Doubles, faces: Unsigned, doubled: Doubles, squared: Doubles
) -> None:
    """Write twice the areas, shape (F,), 0 of slivers, and squared edges, shape (F, 3)."""
    for t in range(faces.shape[0]):
        a, b, c = faces[t, 0], faces[t, 1], faces[t, 2]
        ux, vx = positions[b, 0] - positions[a, 0], positions[c, 0] - positions[b, 0]
        uy, vy = positions[b, 1] - positions[a, 1], positions[c, 1] - positions[b, 1]
        uz, vz = positions[b, 2] - positions[a, 2], positions[c, 2] - positions[b, 2]
        wx, wy, wz = ux + vx, uy + vy, uz + vz
        squared[t, 0] = ux * ux + uy * uy + uz * uz
        squared[t, 1] = vx * vx + vy * vy + vz * vz
        squared[t, 2] = wx * wx + wy * wy + wz * wz
        x, y, z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        area = np.sqrt(x * x + y * y + z * z)
        total = squared[t, 0] + squared[t, 1] + squared[t, 2]
        doubled[t] = area if area > SLIVER * total else 0.0


@native
def weigh_neighbours(
    faces: Unsigned,
    triangle_edges: npt.NDArray[np.int32],
    edge_sides: Unsigned,
    is_interior: npt.NDArray[np.bool_],
    doubled: Doubles,
    squared: Doubles,
    across: Unsigned,
    shares: Floats,
) -> None:
    """Write the corners across the edges of each triangle, (F, 3), and weights, shape (F, 6).

    `doubled`, `squared`: twice the areas, shape (F,), and squared edges, shape (F, 3).
    Weights: of the depths of these corners, then of the bulges of the edges, which say how deep the
    corners are expected. A border edge has no corner across it, and weight 0.
    """
    for t in range(faces.shape[0]):
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


@native
def raise_centres(
    faces: Unsigned,
    triangle_edges: npt.NDArray[np.int32],
    splits: npt.NDArray[np.uint8],
    growth_once: Floats,
    first_points: Unsigned,
    across: Unsigned,
    shares: Floats,
    centre_triangles: Unsigned,
    counts: npt.NDArray[np.int64],
    sides: Doubles,
    higher: Doubles,
    vertices: Floats,
) -> None:
    """Move the points in the middle of triangles to where edges and triangles around have them.

    `counts`: see schemes.Frame. Scratch, `sides`, shape (2, 3), and `higher`, shape (3,), is in
    double precision: the fourth power of a length is beyond single for many a unit of length.
    """
    for k in range(counts[4]):
        t, row = centre_triangles[k], np.uint32(counts[0] + k)
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
            u, v = np.float64(at_b - at_a), np.float64(at_c - at_a)
            sides[0, i], sides[1, i] = u, v
            squares += u * u + v * v + (v - u) * (v - u)
            flat = THIRD * (at_a + at_b + at_c)
            vertices[row, i] += (CENTRE_FULLNESS - ONE) * growth * (vertices[row, i] - flat)
        x = sides[0, 1] * sides[1, 2] - sides[0, 2] * sides[1, 1]
        y = sides[0, 2] * sides[1, 0] - sides[0, 0] * sides[1, 2]
        z = sides[0, 0] * sides[1, 1] - sides[0, 1] * sides[1, 0]
        # Along the normal; a triangle that has been crushed to a line has none.
        area = x * x + y * y + z * z + FLATTENED * squares * squares
        height = growth * (x * higher[0] + y * higher[1] + z * higher[2]) / max(area, TINY)
        vertices[row, 0] += np.float32(height * x)
        vertices[row, 1] += np.float32(height * y)
        vertices[row, 2] += np.float32(height * z)
