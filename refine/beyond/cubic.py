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

The middle of a triangle (blending.py) hears a second opinion. Its edges say from the normals how
far the surface stands out; the corners across them say it from places:

          c           depth     how far c lies below the plane of triangle 1
         / \          expected  the same, if the surface were the one quadratic height over this
        /   \                   plane whose middles of edges are those that the normals gave
       a-----b        share     area of 1 / (area of 1 + area of 2): a fold reaches no farther than
        \ 1 /                   the smaller triangle
         \ /          higher by sum over edges of  share x (depth - expected) / 9,  times 0.6

Where normals and places agree, as on smooth surfaces, nothing is added. Where decimation has left
folds the errors of one have little to do with those of the other, and both together are nearer.
"""

from typing import NamedTuple

import numpy as np

from ...jit import njit
from ..kahler.frame import CENTRES, ROWS, FrameBuffers
from ..mesh.arrays import Doubles, Floats, Unsigned
from ..mesh.borders import border_neighbours
from ..mesh.connectivity import Connectivity, Surroundings
from ..mesh.normals import cross_product, normalise
from ..mesh.vectors import (
    HALF,
    ONE,
    TINY,
    ZERO,
    Vector,
    add_to_row,
    between,
    cross,
    difference,
    dot,
    less,
    row_of,
    times,
    unit,
    write_row,
)
from .curves import MIDDLE, NEAR_END, NEAR_START, CurveScheme

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
THIRD = np.float32(1 / 3)


class Tangents(NamedTuple):
    """What the ends of cubic edges go by; compiled code takes it as it is."""

    normals: Floats
    """Unit normals, each corner weighted as at rest, shape (V, 3)."""
    steeper: Floats
    """Unit normals that go further from those of their neighbours, shape (V, 3)."""
    off: Floats
    """How much of each neighbour's normal is taken off, shape (V,)."""
    beyond: Unsigned
    """The vertices before and after every border edge, shape (E, 2); of others no matter."""


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
        mesh = connectivity
        valences = np.bincount(mesh.edges.ravel(), minlength=len(rest_normals))
        self._weights = np.zeros(mesh.faces.shape, dtype=np.float32)
        weigh_corners(rest_positions, mesh.faces, self._weights)
        self._tangents = Tangents(
            normals=self._normals,
            steeper=np.zeros_like(rest_normals),
            off=(STEEPER / np.maximum(valences, 1)).astype(np.float32),
            beyond=follow_borders(mesh, rest_positions),
        )
        self._across = mesh.faces.copy()
        self._shares = np.zeros((len(mesh.faces), 6), dtype=np.float32)
        weigh_neighbours(mesh, rest_positions, self._across, self._shares)

    def prepare(self, frame: FrameBuffers) -> None:
        """Find the normals of vertices and the bulges of all edges."""
        self._bulge(frame.positions)

    def place_centres(self, frame: FrameBuffers) -> None:
        """Raise the points in the middle of triangles as far as the edges around have grown."""
        raise_centres(self._mesh, frame, self._across, self._shares)

    def _bulge(self, positions: Doubles) -> None:
        weighted_normals(positions, self._mesh.faces, self._weights, self._normals)
        bulge_cubic(self._around, positions, self._tangents, self._bulges)


@njit
def weigh_corners(positions: Doubles, faces: Unsigned, weights: Floats) -> None:
    """Write sqrt(angle / |cross product|) of every corner, shape (F, 3); 0 without an area."""
    for t in range(faces.shape[0]):
        for i in range(3):
            a, b, c = faces[t, i], faces[t, (i + 1) % 3], faces[t, (i + 2) % 3]
            u, v = difference(positions, a, b), difference(positions, a, c)
            normal, size = cross(u, v), np.sqrt(dot(u, u) * dot(v, v))
            area = np.sqrt(dot(normal, normal))
            angle = np.arctan2(area, dot(u, v))
            weights[t, i] = np.sqrt(angle / area) if area > SLIVER * size else 0.0


def follow_borders(mesh: Connectivity, rest_positions: Doubles) -> Unsigned:
    """Find the vertices before and after every border edge, shape (E, 2); its own ends at a corner.

    What it says of other edges has no meaning.
    """
    neighbours = border_neighbours(mesh, rest_positions)[mesh.edges]
    others = mesh.edges[:, ::-1].view(np.uint32)
    return np.where(neighbours[..., 0] != others, neighbours[..., 0], neighbours[..., 1])


@njit
def weighted_normals(positions: Doubles, faces: Unsigned, weights: Floats, normals: Floats) -> None:
    """Write unit vertex normals, each corner weighted as at rest, shape (V, 3)."""
    normals[:] = ZERO
    for t in range(faces.shape[0]):
        a, b, c = faces[t, 0], faces[t, 1], faces[t, 2]
        normal = cross_product(positions, a, b, c)
        for i in range(3):
            add_to_row(normals, faces[t, i], times(weights[t, i], normal))
    normalise(normals)


@njit
def steepen_normals(around: Surroundings, tangents: Tangents) -> None:
    """Write unit normals less those of their neighbours, `off` of each."""
    normals, steeper = tangents.normals, tangents.steeper
    steeper[:] = ZERO
    for e in range(around.points.shape[0]):
        a, b = around.points[e, 0], around.points[e, 1]
        add_to_row(steeper, a, row_of(normals, b))
        add_to_row(steeper, b, row_of(normals, a))
    for v in range(normals.shape[0]):
        write_row(steeper, v, unit(less(row_of(normals, v), tangents.off[v], row_of(steeper, v))))


@njit
def length_of(d: Vector) -> np.float32:
    """Length of an edge."""
    return np.float32(np.sqrt(dot(d, d)))


@njit
def write_cubic(bulges: Floats, e: int, i: int, turn_a: np.float32, turn_b: np.float32) -> None:
    """Write coordinate i of the bulges of an edge.

    `turn_a`, `turn_b`: how much the tangents at both ends turn away from the straight edge.
    """
    bulges[e, NEAR_START, i] = NEAR * turn_a - FAR * turn_b
    bulges[e, MIDDLE, i] = EIGHTH * (turn_a - turn_b)
    bulges[e, NEAR_END, i] = FAR * turn_a - NEAR * turn_b


@njit
def bulge_cubic(
    around: Surroundings, positions: Doubles, tangents: Tangents, bulges: Floats
) -> None:
    """Write the bulges of all edges: those of the cubic with the tangents at both ends.

    `bulges`: shape (E, 3, 3); with `tangents.normals` of this frame, the steeper ones follow.
    """
    steepen_normals(around, tangents)
    steeper = tangents.steeper
    for e in range(bulges.shape[0]):
        a, b = around.points[e, 0], around.points[e, 1]
        d = between(positions, a, b)
        if around.is_interior[e]:
            at_a, at_b = row_of(steeper, a), row_of(steeper, b)
            height_a, height_b = -FULLNESS * dot(d, at_a), -FULLNESS * dot(d, at_b)
            for i in range(3):
                write_cubic(bulges, e, i, height_a * at_a[i], height_b * at_b[i])
            continue
        p, q = tangents.beyond[e, 0], tangents.beyond[e, 1]
        length = length_of(d)
        share_a = length / max(length + length_of(between(positions, p, a)), TINY)
        share_b = length / max(length + length_of(between(positions, b, q)), TINY)
        for i in range(3):
            straight = np.float32(positions[b, i] - positions[a, i])
            turn_a = share_a * np.float32(positions[b, i] - positions[p, i]) - straight
            turn_b = share_b * np.float32(positions[q, i] - positions[a, i]) - straight
            write_cubic(bulges, e, i, turn_a, turn_b)


@njit
def measure_triangles(
    positions: Doubles, faces: Unsigned, doubled: Doubles, squared: Doubles
) -> None:
    """Write twice the areas, shape (F,), 0 of slivers, and squared edges, shape (F, 3)."""
    for t in range(faces.shape[0]):
        a, b, c = faces[t, 0], faces[t, 1], faces[t, 2]
        u, v, w = (
            difference(positions, a, b),
            difference(positions, b, c),
            difference(positions, a, c),
        )
        squared[t, 0], squared[t, 1], squared[t, 2] = dot(u, u), dot(v, v), dot(w, w)
        normal = cross(u, v)
        area = np.sqrt(dot(normal, normal))
        total = squared[t, 0] + squared[t, 1] + squared[t, 2]
        doubled[t] = area if area > SLIVER * total else 0.0


@njit
def weigh_neighbours(
    mesh: Connectivity, positions: Doubles, across: Unsigned, shares: Floats
) -> None:
    """Write the corners across the edges of each triangle, (F, 3), and weights, shape (F, 6).

    Weights: of the depths of these corners, then of the bulges of the edges, which say how deep the
    corners are expected. A border edge has no corner across it, and weight 0.
    """
    faces, edge_sides = mesh.faces, mesh.edge_sides
    doubled, squared = np.zeros(faces.shape[0]), np.zeros((faces.shape[0], 3))
    measure_triangles(positions, faces, doubled, squared)
    for t in range(faces.shape[0]):
        size = 0.0
        for i in range(3):
            e = mesh.triangle_edges[t, i]
            across[t, i] = faces[t, i]
            if e < 0 or not mesh.around.is_interior[e] or doubled[t] == 0.0:
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


@njit
def raise_centres(
    mesh: Connectivity, frame: FrameBuffers, across: Unsigned, shares: Floats
) -> None:
    """Move the points in the middle of triangles to where edges and triangles around have them.

    What is worked out here is in double precision: the fourth power of a length is beyond single
    for many a unit of length.
    """
    vertices = frame.rows
    sides, higher = np.zeros((2, 3)), np.zeros(3)
    for k in range(frame.counts[CENTRES]):
        t, row = frame.centre_triangles[k], np.uint32(frame.counts[ROWS] + k)
        growth = ONE
        for i in range(3):
            growth = min(growth, frame.growth_once[mesh.triangle_edges[t, i]])
        if growth <= ZERO:
            continue  # not all edges have a middle
        higher[:] = 0.0
        for j in range(3):
            a, b, c = mesh.faces[t, j], mesh.faces[t, (j + 1) % 3], across[t, j]
            e = mesh.triangle_edges[t, j]
            m = frame.first_points[e] + (frame.splits[e] >> 1)
            for i in range(3):
                bulge = vertices[m, i] - HALF * (vertices[a, i] + vertices[b, i])
                depth = vertices[a, i] - vertices[c, i]
                higher[i] += shares[t, j] * depth + shares[t, 3 + j] * bulge
        a, b, c = mesh.faces[t, 0], mesh.faces[t, 1], mesh.faces[t, 2]
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
