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

How far the points of an edge stand out of the straight edge is its *displacement*. Those of split
edges are put there as far as their geomorph weights say (blending.py):

                 .  m  .                 m      =  (a + b) / 2          +  displacement
              n           n              n at a =  (3 a + b) / 4        +  displacement
            a---------------b            grown   =  mix of (a + m) / 2 and n

The normal at m is the mean of those at a and b, and at n that of its neighbours, as in the paper
(section 4.4); surface_normals.py has others.
"""

from typing import NamedTuple

import numpy as np

from ...jit import njit
from ..border.rows import place_unmoved
from ..kahler.frame import ONCE, FrameBuffers
from ..kahler.smoothing import Scheme, write_mean_normal
from ..mesh.arrays import Doubles, Floats, Unsigned
from ..mesh.borders import border_neighbours
from ..mesh.connectivity import Connectivity, Surroundings
from ..mesh.normals import cross_product, normalise
from ..mesh.vectors import (
    HALF,
    QUARTER,
    THREE_QUARTERS,
    TINY,
    ZERO,
    Vector,
    add_to_row,
    between,
    cross,
    difference,
    dot,
    less,
    mix,
    plus,
    row_of,
    times,
    unit,
    write_row,
)

NEAR_START, MIDDLE, NEAR_END = 0, 1, 2
"""Points of an edge in an array of displacements, shape (E, 3, 3): edge, point, x y z."""
FULLNESS = np.float32(1.2)
"""How much more than the cubic inner edges are displaced. Triangles between curves are flat, so the
best fit stands out a little; measured on ellipsoids, a torus, heads, flat between 1.1 and 1.25."""
STEEPER = np.float32(0.15)
"""Share of the mean normal around that is taken off a normal. A first step of undoing the mean that
vertex normals are; a second, or more of it, finds the noise of decimated meshes. Measured on two
faces and their decimations: half a point of 35 % better on scans, level on smooth heads, and half a
point worse on the roughest and on a torus."""
EIGHTH = np.float32(1 / 8)
"""Share of the end tangents in the middle of a cubic."""
NEAR, FAR = np.float32(9 / 64), np.float32(3 / 64)
"""Share of the nearer and of the farther tangent at a quarter of a cubic."""
SLIVER = 1e-9
"""Sine of an angle below which a triangle has no direction."""


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


class CubicScheme(Scheme):
    """Edges are cubic curves across the normals at their ends."""

    interpolates = True

    def bind(
        self, connectivity: Connectivity, rest_positions: Doubles, rest_normals: Floats
    ) -> None:
        """Weigh the corners of the mesh at rest, and follow its borders."""
        mesh = self._mesh = connectivity
        self._around = mesh.around
        self._displacements = np.zeros((len(mesh.edges), 3, 3), dtype=np.float32)
        self._normals = np.zeros_like(rest_normals)
        valences = np.bincount(mesh.edges.ravel(), minlength=len(rest_normals))
        self._weights = np.zeros(mesh.faces.shape, dtype=np.float32)
        weigh_corners(rest_positions, mesh.faces, self._weights)
        self._tangents = Tangents(
            normals=self._normals,
            steeper=np.zeros_like(rest_normals),
            off=(STEEPER / np.maximum(valences, 1)).astype(np.float32),
            beyond=follow_borders(mesh, rest_positions),
        )

    def prepare(self, frame: FrameBuffers) -> None:
        """Find normals of vertices and displacements of all edges, middles as if split once."""
        self._displace(frame.positions)

    def place(self, frame: FrameBuffers) -> None:
        """Write vertices as they are, and the points of split edges on their curves."""
        place_on_curves(self._around, frame, self._normals, self._displacements)

    def measure(self, displacements: Floats, turns: Floats) -> None:
        """Write how far the middle of every edge stands out if it is split once, shape (E,).

        A mean of normals turns nothing: `turns`, shape (E,), become zero.
        """
        displacement_sizes(self._displacements, displacements)
        turns[:] = ZERO

    def _displace(self, positions: Doubles) -> None:
        weighted_normals(positions, self._mesh.faces, self._weights, self._normals)
        displace_cubic(self._around, positions, self._tangents, self._displacements)


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
def write_cubic(
    displacements: Floats, e: int, i: int, turn_a: np.float32, turn_b: np.float32
) -> None:
    """Write coordinate i of the displacements of an edge.

    `turn_a`, `turn_b`: how much the tangents at both ends turn away from the straight edge.
    """
    displacements[e, NEAR_START, i] = NEAR * turn_a - FAR * turn_b
    displacements[e, MIDDLE, i] = EIGHTH * (turn_a - turn_b)
    displacements[e, NEAR_END, i] = FAR * turn_a - NEAR * turn_b


@njit
def displace_cubic(
    around: Surroundings, positions: Doubles, tangents: Tangents, displacements: Floats
) -> None:
    """Write the displacements of all edges: those of the cubic with the tangents at both ends.

    `displacements`: shape (E, 3, 3); with `tangents.normals` of this frame, the steeper ones
    follow.
    """
    steepen_normals(around, tangents)
    steeper = tangents.steeper
    for e in range(displacements.shape[0]):
        a, b = around.points[e, 0], around.points[e, 1]
        d = between(positions, a, b)
        if around.is_interior[e]:
            at_a, at_b = row_of(steeper, a), row_of(steeper, b)
            height_a, height_b = -FULLNESS * dot(d, at_a), -FULLNESS * dot(d, at_b)
            for i in range(3):
                write_cubic(displacements, e, i, height_a * at_a[i], height_b * at_b[i])
            continue
        p, q = tangents.beyond[e, 0], tangents.beyond[e, 1]
        length = length_of(d)
        share_a = length / max(length + length_of(between(positions, p, a)), TINY)
        share_b = length / max(length + length_of(between(positions, b, q)), TINY)
        for i in range(3):
            straight = np.float32(positions[b, i] - positions[a, i])
            turn_a = share_a * np.float32(positions[b, i] - positions[p, i]) - straight
            turn_b = share_b * np.float32(positions[q, i] - positions[a, i]) - straight
            write_cubic(displacements, e, i, turn_a, turn_b)


@njit
def displacement_sizes(displacements: Floats, sizes: Floats) -> None:
    """Write how far the middle of every edge is displaced, shape (E,)."""
    for e in range(sizes.shape[0]):
        middle = row_of(displacements[e], MIDDLE)
        sizes[e] = np.sqrt(dot(middle, middle))


@njit
def place_on_curves(
    around: Surroundings, frame: FrameBuffers, normals: Floats, displacements: Floats
) -> None:
    """Write vertices as they are, and the one or three points of every split edge.

    `normals`: unit normals of vertices, shape (V, 3); `displacements`: of edges, shape (E, 3, 3).
    """
    points, vertices = frame.points, frame.rows
    place_unmoved(points, normals, vertices)
    for k in range(frame.counts[ONCE]):
        e = frame.split_once[k]
        a, b = around.points[e, 0], around.points[e, 1]
        row = np.uint32(frame.first_points[e] + (frame.splits[e] >> 1))
        near_a, near_b = np.uint32(row - 1), np.uint32(row + 1)
        at_a, at_b, displacement = row_of(points, a), row_of(points, b), displacements[e]
        out = times(frame.geomorph_once[e], row_of(displacement, MIDDLE))
        middle = plus(times(HALF, plus(at_a, at_b)), out)
        write_row(vertices, row, middle)
        write_mean_normal(vertices, a, b, row)
        if frame.splits[e] == 2:
            full_a = plus(times(THREE_QUARTERS, at_a), times(QUARTER, at_b))
            full_b = plus(times(THREE_QUARTERS, at_b), times(QUARTER, at_a))
            full_a = plus(full_a, row_of(displacement, NEAR_START))
            full_b = plus(full_b, row_of(displacement, NEAR_END))
            geomorph = frame.geomorph_twice[e]
            write_row(vertices, near_a, mix(times(HALF, plus(at_a, middle)), full_a, geomorph))
            write_row(vertices, near_b, mix(times(HALF, plus(at_b, middle)), full_b, geomorph))
            write_mean_normal(vertices, a, row, near_a)
            write_mean_normal(vertices, b, row, near_b)
