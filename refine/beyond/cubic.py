r"""Cubic edges from end points and normals: the scheme named `cubic`.

The border curves of curved PN triangles (Vlachos, Peters, Boyd, Mitchell 2001): the tangents of a
cubic from a to b are perpendicular to the vertex normals at its ends. With d = b - a, and heights
h_a = d . n_a and h_b = d . n_b:

    middle         (a + b) / 2    -  ( h_a n_a -     h_b n_b) /  8
    near a      (3 a + b) / 4     -  (9 h_a n_a - 3 h_b n_b) / 64
    near b      (a + 3 b) / 4     -  (3 h_a n_a - 9 h_b n_b) / 64

Differs from PN triangles: the normals are weighted by the geometric mean of a triangle's angle and
its area at rest. The angle alone is best on smooth surfaces; the area alone is best where
decimation has left folds of small triangles; the mean loses little on either. A mean over the
surrounding triangles also underestimates bends. So for heights, but not for shading, a normal is
moved a little away from the normals of its neighbours: n - 0.15 x mean of the neighbours,
normalised. This changes nothing on a plane, or on a sphere of equal triangles. An edge on a border
takes its tangents from the border curve, because normals do not determine an outline. At a corner
of the border there is no tangent, so the curve is a parabola; a chord as tangent would be too flat.

The *displacement* of a point is the vector from its place on the straight edge to the curve. Points
of split edges are moved by the displacement times their geomorph weight (blending.py):

                 .  m  .                 m      =  (a + b) / 2          +  displacement
              n           n              n at a =  (3 a + b) / 4        +  displacement
            a---------------b            grown   =  mix of (a + m) / 2 and n

The normal at m or n is the mean of the normals of its neighbours, as in the paper (section 4.4).
surface_normals.py computes normals of the refined surface instead.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ...geometry.arrays import Flags, Floats32, Floats64, Unsigned32
from ...geometry.vectors import (
    HALF,
    ONE,
    QUARTER,
    ROW_WIDTH,
    SMALLEST_FLOAT,
    THREE_QUARTERS,
    ZERO,
    Vector,
    between,
    dot,
    less,
    mix,
    plus,
    row_of,
    times,
    unit,
    write_row,
)
from ...jit import njit
from ..kahler.frame import SPLIT_EDGES, FrameBuffers
from ..kahler.scheme import Scheme
from ..mesh.borders import edges_of_outlines, follow_borders, follow_outlines
from ..mesh.connectivity import Connectivity, Surroundings
from ..mesh.creases import sectors_of, sharpened
from ..mesh.fans import Fans, corners_behind, fans_around, fans_of
from ..mesh.normals import weigh_corners
from ..mesh.threads import parallel_for
from .cubic_normals import cross_products, steepen_normals, weighted_normals

START_POINT = 0
MIDDLE_POINT = 1
END_POINT = 2
"""Points of an edge in an array of displacements, shape (E, 3, 3): edge, point, x y z."""
FULLNESS_FACTOR = np.float32(1.2)
"""Factor on the cubic displacement of inner edges. Triangles between curves are flat, so the best
fit lies a little outside the curves. Measured on ellipsoids, a torus and heads, where 1.1 to 1.25
are almost equally good.
"""
STEEPENING_SHARE = np.float32(0.15)
"""Fraction of the neighbours' mean normal that is subtracted from a normal. A vertex normal is a
mean, and the subtraction is a first step to undo this. A second or a larger step amplifies the
noise of decimated meshes. Measured on two faces and their decimations: half a percentage point of
35 better on scans, equal on smooth heads, half a point worse on the roughest and on a torus.
"""
MIDDLE_WEIGHT = np.float32(1 / 8)
"""Weight of the end tangents in the middle of a cubic."""
NEAR_WEIGHT = np.float32(9 / 64)
FAR_WEIGHT = np.float32(3 / 64)
"""Weights of the nearer and of the farther tangent at a quarter of a cubic."""


class Tangents(NamedTuple):
    """Data for the tangents at the ends of cubic edges, passed to compiled code as one tuple."""

    normals: Floats32
    """Unit normals of the S sectors of vertices, each corner weighted as at rest, shape (S, 3)."""
    steeper: Floats32
    """Unit normals, moved away from the normals of their neighbours, shape (S, 3)."""
    off: Floats32
    """Fraction of each neighbour's normal that is subtracted, shape (S,)."""
    ends: Unsigned32
    """Sectors at both ends of every edge, shape (E, 2); not used for edges on borders."""
    beyond: Unsigned32
    """The vertices before and after every border edge, shape (E, 2); not used for others."""
    covers: Flags
    """Inner edges that bend outward only, shape (E,)."""


class CubicScheme(Scheme):
    """The scheme `cubic`: edges become cubic curves, normal to the vertex normals at both ends."""

    interpolates = True
    uses_normals = False
    measures = True

    def __init__(
        self,
        outlines: Sequence[Sequence[int]] = (),
        backs: Sequence[int] = (),
        curves: Sequence[Sequence[int]] = (),
        covers: Sequence[int] = (),
    ) -> None:
        """Choose rims, folds, and covers.

        - `outlines`: vertices along rims within the surface, whose edges bend like borders. The
          first and the last edge of a rim only give their direction to their neighbours.
        - `backs`: triangles behind folds, as inner sides of lids. A vertex that they share with
          other triangles has the normal of the others: a mean of both sides is normal to neither.
        - `curves`: as `outlines`, but the surface is smooth across them, as across rims of ears.
        - `covers`: triangles that cover a body, as lids cover eyeballs. Their edges bend outward
          only, so a body that the triangles enclose does not pierce the refined surface.
        """
        self._outlines = [list(rim) for rim in outlines]
        self._rims = [*self._outlines, *(list(rim) for rim in curves)]
        self._backs = [int(triangle) for triangle in backs]
        self._covers = [int(triangle) for triangle in covers]

    def outlined(self, connectivity: Connectivity) -> Flags:
        """Edges of the outlines, shape (E,)."""
        return edges_of_outlines(connectivity, self._outlines)

    def is_back(self, connectivity: Connectivity) -> Flags:
        """Flags of triangles behind folds, shape (F,)."""
        return np.isin(np.arange(len(connectivity.faces)), self._backs)

    def covering(self, connectivity: Connectivity) -> Flags:
        """Edges of the covers, shape (E,)."""
        edges = connectivity.triangle_edges[self._covers]
        return np.isin(np.arange(len(connectivity.edges)), edges)

    def curved(self, connectivity: Connectivity) -> Flags:
        """Edges of the outlines and of the curves, shape (E,)."""
        return edges_of_outlines(connectivity, self._rims)

    def bind(
        self, connectivity: Connectivity, rest_positions: Floats64, rest_normals: Floats32
    ) -> None:
        """Weigh the corners of the mesh at rest, and follow its borders and outlines."""
        mesh = self._mesh = sharpened(connectivity, self.outlined(connectivity))
        bent = sharpened(mesh, self.curved(connectivity))
        self._around = bent.around
        sectors = sectors_of(mesh)
        self._fans = fans_around(sectors.corners, sectors.edges, sectors.sector_count)
        self._displacements = np.zeros((len(mesh.edges), 3, 3), dtype=np.float32)
        self._rows = self._displacements.reshape(-1, 3)
        self._crosses = np.zeros((len(mesh.faces), 3), dtype=np.float32)
        sector_normals = np.zeros((sectors.sector_count, 3), dtype=np.float32)
        valences = np.bincount(sectors.edges.ravel(), minlength=sectors.sector_count)
        self._weights = np.zeros(mesh.faces.shape, dtype=np.float32)
        weigh_corners(rest_positions, mesh.faces, self._weights)
        self._weights[corners_behind(mesh.faces, self.is_back(mesh))] = ZERO
        self._tangents = Tangents(
            normals=sector_normals,
            steeper=np.zeros_like(sector_normals),
            off=(STEEPENING_SHARE / np.maximum(valences, 1)).astype(np.float32),
            ends=sectors.edges[: len(mesh.edges)],
            beyond=follow_outlines(bent, follow_borders(mesh, rest_positions), self._rims),
            covers=self.covering(mesh) & bent.around.is_interior,
        )
        # For shading, both sides of a crease are one surface, as in the input.
        self._normals = sector_normals
        self._whole_fans: Fans | None = None
        if mesh.is_sharp.any():
            self._normals = np.zeros_like(rest_normals)
            self._whole_fans = fans_of(mesh)

    def prepare(self, frame: FrameBuffers) -> None:
        """Compute vertex normals, and the displacements of the points on all edges."""
        self._displace(frame.positions)

    def place(self, frame: FrameBuffers) -> None:
        """Write unchanged vertices, and the points of split edges on their curves."""
        self.place_positions(frame)
        count = len(frame.points) + int(frame.counts[SPLIT_EDGES])
        parallel_for(place_mean_normals, count, self._around.points, frame, self._normals)

    def place_positions(self, frame: FrameBuffers) -> None:
        """Write positions only, as `place` does."""
        count = len(frame.points) + int(frame.counts[SPLIT_EDGES])
        parallel_for(place_on_curves, count, self._around.points, frame, self._rows)

    def measure(self, displacements: Floats32, turns: Floats32) -> None:
        """Write how far one split would displace the midpoint of every edge, shape (E,).

        The normal in the middle is the mean of the normals at the ends, so `turns`, shape (E,), are
        set to zero.
        """
        displacement_sizes(self._displacements, displacements)
        turns[:] = ZERO

    def _displace(self, positions: Floats64) -> None:
        fans = self._fans
        tangents = self._tangents
        crosses = self._crosses
        parallel_for(cross_products, len(crosses), positions, self._mesh.faces, crosses)
        corners = fans.corner_starts, fans.corners
        weights = self._weights, crosses, tangents.normals
        parallel_for(weighted_normals, len(tangents.off), *corners, *weights)
        if self._whole_fans is not None:
            around = self._whole_fans.corner_starts, self._whole_fans.corners
            given = self._weights, crosses, self._normals
            parallel_for(weighted_normals, len(positions), *around, *given)
        neighbours = fans.neighbour_starts, fans.neighbours
        parallel_for(steepen_normals, len(tangents.off), *neighbours, *tangents[:3])
        parallel_for(
            displace_cubic, len(self._mesh.edges), self._around, positions, tangents, self._rows
        )


@njit
def length_of(d: Vector) -> np.float32:
    """Length of an edge."""
    return np.float32(np.sqrt(dot(d, d)))


@njit
def write_cubic(displacements: Floats32, first: np.uint32, turn_a: Vector, turn_b: Vector) -> None:
    """Write the displacements of an edge, three rows from row `first` on.

    `turn_a`, `turn_b`: vectors from the straight edge to the tangents at both ends.
    """
    near_a = less(times(NEAR_WEIGHT, turn_a), FAR_WEIGHT, turn_b)
    near_b = less(times(FAR_WEIGHT, turn_a), NEAR_WEIGHT, turn_b)
    write_row(displacements, np.uint32(first + START_POINT), near_a)
    middle = times(MIDDLE_WEIGHT, less(turn_a, ONE, turn_b))
    write_row(displacements, np.uint32(first + MIDDLE_POINT), middle)
    write_row(displacements, np.uint32(first + END_POINT), near_b)


@njit
def remove_inward(displacements: Floats32, first: np.uint32, outward: Vector) -> None:
    """Set displacements of an edge that point inward to zero; its three rows begin at `first`."""
    for point in range(3):
        row = np.uint32(first + point)
        if dot(row_of(displacements, row), outward) < ZERO:
            write_row(displacements, row, (ZERO, ZERO, ZERO))


@njit
def displace_cubic(
    first: int,
    last: int,
    around: Surroundings,
    positions: Floats64,
    tangents: Tangents,
    displacements: Floats32,
) -> None:
    """Write the displacements of edges from the cubics with the given tangents at both ends.

    `displacements`: three rows for each edge, shape (3 E, 3).
    """
    points = around.points
    is_interior = around.is_interior
    steeper = tangents.steeper
    ends = tangents.ends
    assert positions.shape[1] == steeper.shape[1] == displacements.shape[1] == ROW_WIDTH
    for k in range(first, last):
        e = np.uint32(k)
        a = points[e, 0]
        b = points[e, 1]
        d = between(positions, a, b)
        if is_interior[e]:
            at_a = row_of(steeper, np.uint32(ends[e, 0]))
            at_b = row_of(steeper, np.uint32(ends[e, 1]))
            turn_a = times(-FULLNESS_FACTOR * dot(d, at_a), at_a)
            turn_b = times(-FULLNESS_FACTOR * dot(d, at_b), at_b)
        else:
            turn_a, turn_b = turns_of_border(positions, a, b, tangents.beyond[e])
        write_cubic(displacements, np.uint32(3 * e), turn_a, turn_b)
        if tangents.covers[e]:
            at_a = row_of(steeper, np.uint32(ends[e, 0]))
            at_b = row_of(steeper, np.uint32(ends[e, 1]))
            remove_inward(displacements, np.uint32(3 * e), plus(at_a, at_b))


@njit
def turns_of_border(
    positions: Floats64, a: np.uint32, b: np.uint32, beyond: Unsigned32
) -> tuple[Vector, Vector]:
    """Return the turns of the tangents at both ends of a border edge, for `write_cubic`.

    A tangent runs between the neighbours of its end, and is as long as the edge allows. At the end
    of a border it mirrors the other one. `beyond`: vertices before a and after b, shape (2,).
    """
    p = beyond[0]
    q = beyond[1]
    d = between(positions, a, b)
    length = length_of(d)
    weight_a = length / max(length + length_of(between(positions, p, a)), SMALLEST_FLOAT)
    weight_b = length / max(length + length_of(between(positions, b, q)), SMALLEST_FLOAT)
    turn_a = less(times(weight_a, between(positions, p, b)), ONE, d)
    turn_b = less(times(weight_b, between(positions, a, q)), ONE, d)
    if p == a:
        turn_a = times(-ONE, turn_b)
    elif q == b:
        turn_b = times(-ONE, turn_a)
    return turn_a, turn_b


@njit
def displacement_sizes(displacements: Floats32, sizes: Floats32) -> None:
    """Write how far the midpoint of every edge is displaced, shape (E,)."""
    for e in range(sizes.shape[0]):
        middle = row_of(displacements[e], MIDDLE_POINT)
        sizes[e] = np.sqrt(dot(middle, middle))


@njit
def place_on_curves(
    first: int, last: int, ends: Unsigned32, frame: FrameBuffers, displacements: Floats32
) -> None:
    """Write positions of unchanged vertices, and of the one or three points of split edges.

    The loop runs over vertices, and then over split edges. `ends`: the ends of edges, in the first
    two columns of (E, 4); `displacements`: three rows for each edge, shape (3 E, 3).
    """
    points = frame.points
    rows = frame.rows
    splits = frame.splits
    first_points = frame.first_points
    split_once = frame.split_once
    geomorph_once = frame.geomorph_once
    assert points.shape[1] == displacements.shape[1] == ROW_WIDTH
    vertex_count = points.shape[0]
    for v in range(first, min(last, vertex_count)):
        write_row(rows, np.uint32(v), row_of(points, np.uint32(v)))
    for k in range(max(first - vertex_count, 0), last - vertex_count):
        e = split_once[np.uint32(k)]
        row = np.uint32(first_points[e] + (splits[e] >> 1))
        at_a = row_of(points, ends[e, 0])
        at_b = row_of(points, ends[e, 1])
        out = times(geomorph_once[e], row_of(displacements, np.uint32(3 * e + MIDDLE_POINT)))
        middle = plus(times(HALF, plus(at_a, at_b)), out)
        write_row(rows, row, middle)
        if splits[e] == 2:
            full_a = plus(times(THREE_QUARTERS, at_a), times(QUARTER, at_b))
            full_b = plus(times(THREE_QUARTERS, at_b), times(QUARTER, at_a))
            full_a = plus(full_a, row_of(displacements, np.uint32(3 * e + START_POINT)))
            full_b = plus(full_b, row_of(displacements, np.uint32(3 * e + END_POINT)))
            straight_a = times(HALF, plus(at_a, middle))
            straight_b = times(HALF, plus(at_b, middle))
            geomorph = frame.geomorph_twice[e]
            write_row(rows, np.uint32(row - 1), mix(straight_a, full_a, geomorph))
            write_row(rows, np.uint32(row + 1), mix(straight_b, full_b, geomorph))


@njit
def place_mean_normals(
    first: int, last: int, ends: Unsigned32, frame: FrameBuffers, normals: Floats32
) -> None:
    """Write normals of vertices, shape (V, 3), and of points on edges; loop and `ends` as above."""
    rows = frame.rows
    vertex_count = frame.points.shape[0]
    for v in range(first, min(last, vertex_count)):
        write_row(rows, v, row_of(normals, v), 3)
    for k in range(max(first - vertex_count, 0), last - vertex_count):
        e = frame.split_once[k]
        row = np.uint32(frame.first_points[e] + (frame.splits[e] >> 1))
        at_a = row_of(normals, ends[e, 0])
        at_b = row_of(normals, ends[e, 1])
        normal = unit(plus(at_a, at_b))
        write_row(rows, row, normal, 3)
        if frame.splits[e] == 2:
            write_row(rows, np.uint32(row - 1), unit(plus(at_a, normal)), 3)
            write_row(rows, np.uint32(row + 1), unit(plus(at_b, normal)), 3)
