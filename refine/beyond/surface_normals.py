r"""Normals of the refined surface itself: `normals="refined"`.

Kähler, Haber, Seidel 2003, interpolate the normal of a new point from those at the ends of its edge
(section 4.4). Then smooth shading cannot show what a split found out: only outlines and highlights
change. Here the surface that all splits together would make is looked at, wherever it is split:

              c                m    middles of all edges, where the scheme puts them
             / \               C    middle of a triangle: its corners' mean, and 0.511 of how far
          m /   \ m                 each m stands out of its edge
           /  C  \
          a---m---b            normal at m    (b - a) x (C - C'), with C' beyond the edge;
           \  C' /                            (b - a) x (C - m) on a border
          m \   / m            normal at a    sum over the triangles around of
             \ /                              (C - a) x (m_ac - m_ab)
              d

Both are sums of the cross products of the small triangles around the point, put together. They do
not depend on what is split in this frame, so no normal jumps when something is. A new point begins
with the mean of the normals at the ends of its edge, and turns to its own while it goes the first
third of its way (blending.py). At a quarter it is the mean of its neighbours'.

Differs from the paper, whose rule is `normals="linear"`.
"""

import numpy as np

from ...jit import njit
from ..kahler.frame import CENTRES, ONCE, ROWS, FrameBuffers, buffers_for, split_everywhere
from ..kahler.look_up import SIDE_BITS
from ..kahler.smoothing import Scheme, write_mean_normal
from ..mesh.arrays import Doubles, Floats
from ..mesh.connectivity import Connectivity
from ..mesh.normals import normalise
from ..mesh.vectors import (
    HALF,
    ONE,
    THIRD,
    ZERO,
    Vector,
    add_to_row,
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

FULL_CENTRE = np.float32(0.511)
"""How far the middle of a triangle follows the displacements of its edges: 4/9 (blending.py), and
15 % more: curves between these points stand out farther. So normals are nearer to a dense head."""
SOON = np.float32(3.0)
"""How much sooner than the place of a new point its normal has gone all the way. Chosen: a turn of
shading is seen less than a jump of the surface, and half of it is half a triangle wasted."""
STEADY = np.float32(0.02)
"""Share of the mean of the ends' normals, in squared lengths of the edge, that is added to a normal
in the middle. Chosen: where an edge is folded until nothing is left across it, this decides. More
looks softer in deep folds and is farther from dense faces: 0.3 costs five points of thirty."""


class WholeSurface:
    """The surface of a frame where every edge is split once, and its normals."""

    def __init__(self, mesh: Connectivity, rest_positions: Doubles) -> None:
        """Make room; `rest_positions`: shape (V, 3)."""
        self._mesh = mesh
        vertex_count, edge_count = mesh.vertex_count, len(mesh.edges)
        near, points = np.zeros_like(rest_positions), rest_positions.astype(np.float32)
        frame = buffers_for(mesh, near, points, np.zeros_like(points))
        rows = np.zeros((vertex_count + edge_count, 6), dtype=np.float32)
        self._frame = split_everywhere(frame, vertex_count)._replace(rows=rows)
        self._centres = np.zeros((len(mesh.faces), 3), dtype=np.float32)
        self.rows = rows
        """Of the vertices, then of the middles of all edges, shape (V + E, 6): positions first, as
        seen from vertex 0, so that a mesh far from the origin loses nothing."""
        self.normals = np.zeros((vertex_count + edge_count, 3), dtype=np.float32)
        """Unit normals there, shape (V + E, 3)."""

    def split(self, frame: FrameBuffers) -> FrameBuffers:
        """The mesh of `frame`, as seen from vertex 0, every edge split once; to be placed."""
        if frame.normals is not self._frame.normals:
            self._frame = self._frame._replace(normals=frame.normals)
        see_from_first(frame.positions, self._frame.positions, self._frame.points)
        return self._frame

    def find_normals(self) -> None:
        """Work the normals out, when the rows have been placed."""
        surface_normals(self._mesh, self.rows, self._centres, self.normals)

    def measure(self, displacements: Floats, turns: Floats) -> None:
        """Write how far middles stand out of their edges, and their normals turn; shape (E,) each.

        Against the straight edge, and against the mean of the normals at its ends [rad], times the
        length of the edge.
        """
        measure_edges(self._mesh, self.rows, self.normals, displacements, turns)


class RefinedNormals(Scheme):
    """A scheme, with the normals of the surface that it makes."""

    def __init__(self, scheme: Scheme) -> None:
        """`scheme`: says where points go."""
        self.parts = (scheme,)
        self.interpolates = scheme.interpolates
        self._scheme = scheme

    def bind(
        self, connectivity: Connectivity, rest_positions: Doubles, rest_normals: Floats
    ) -> None:
        """Bind the scheme, and make room for its surface."""
        self._scheme.bind(connectivity, rest_positions, rest_normals)
        self._mesh = connectivity
        self._surface = WholeSurface(connectivity, rest_positions)

    def prepare(self, frame: FrameBuffers) -> None:
        """Find the surface of this frame where every edge is split once, and its normals."""
        self._scheme.prepare(frame)
        self._scheme.place(self._surface.split(frame))
        self._surface.find_normals()

    def place(self, frame: FrameBuffers) -> None:
        """Write points where the scheme has them, with the normals of its surface."""
        self._scheme.place(frame)
        turn_normals(self._mesh, frame, self._surface.normals)

    def place_centres(self, frame: FrameBuffers) -> None:
        """Let the scheme correct the middles of triangles, and turn their normals."""
        self._scheme.place_centres(frame)
        turn_centres(self._mesh, frame, self._surface.rows)

    def measure(self, displacements: Floats, turns: Floats) -> None:
        """Write how far middles would stand out, and turn the normal, of every edge, (E,) each."""
        self._surface.measure(displacements, turns)


@njit
def see_from_first(positions: Doubles, near: Doubles, points: Floats) -> None:
    """Write positions less the first, shape (V, 3), in double and in single precision."""
    for v in range(positions.shape[0]):
        away = difference(positions, 0, v)
        write_row(near, v, away)
        write_row(points, v, away)


@njit
def between_rows(rows: Floats, a: np.uint32, b: np.uint32) -> Vector:
    """The vector from row a to row b."""
    return less(row_of(rows, b), ONE, row_of(rows, a))


@njit
def place_surface_centres(mesh: Connectivity, rows: Floats, centres: Floats) -> None:
    """Write the points in the middle of triangles with three split edges, shape (F, 3)."""
    vertex_count = mesh.vertex_count
    for t in range(centres.shape[0]):
        for i in range(3):
            corners = middles = ZERO
            for k in range(3):
                e = mesh.triangle_edges[t, k]
                corners += rows[mesh.faces[t, k], i]
                if e >= 0:
                    middles += rows[vertex_count + e, i]
            # The sum of displacements is the sum of the middles less that of the corners.
            centres[t, i] = THIRD * corners + FULL_CENTRE * (middles - corners)


@njit
def surface_normals(mesh: Connectivity, rows: Floats, centres: Floats, normals: Floats) -> None:
    """Write unit normals of vertices and of the middles of all edges, shape (V + E, 3).

    `rows`: their positions, shape (V + E, 6). `centres`: scratch, shape (F, 3).
    """
    place_surface_centres(mesh, rows, centres)
    vertex_count, face_count = mesh.vertex_count, centres.shape[0]
    normals[:vertex_count] = ZERO
    for t in range(face_count):
        if mesh.triangle_edges[t, 0] < 0:
            continue
        centre = row_of(centres, t)
        for i in range(3):
            a = mesh.faces[t, i]
            after = np.uint32(vertex_count + mesh.triangle_edges[t, i])
            before = np.uint32(vertex_count + mesh.triangle_edges[t, i - 1])
            out = less(centre, ONE, row_of(rows, a))
            add_to_row(normals, a, cross(out, between_rows(rows, after, before)))
    normalise(normals[:vertex_count])
    for e in range(mesh.edges.shape[0]):
        a, b = mesh.around.points[e, 0], mesh.around.points[e, 1]
        row = np.uint32(vertex_count + e)
        mean = times(HALF, plus(row_of(normals, a), row_of(normals, b)))
        side, beyond = mesh.edge_sides[e, 0] >> SIDE_BITS, mesh.edge_sides[e, 1] >> SIDE_BITS
        if not mesh.around.is_interior[e] and beyond < face_count:
            write_row(normals, row, unit(mean))  # sheets that meet have no normal in common
            continue
        along = between_rows(rows, a, b)
        far = row_of(centres, beyond) if beyond < face_count else row_of(rows, row)
        across = less(row_of(centres, side), ONE, far)
        steady = times(STEADY * dot(along, along), mean)
        write_row(normals, row, unit(plus(cross(along, across), steady)))


@njit
def turn_normals(mesh: Connectivity, frame: FrameBuffers, normals: Floats) -> None:
    """Write the normals of vertices and of the points of split edges, as far as they have grown.

    `normals`: of vertices and middles, shape (V + E, 3).
    """
    vertices, vertex_count = frame.rows, mesh.vertex_count
    for v in range(vertex_count):
        write_row(vertices, v, row_of(normals, v), 3)
    for k in range(frame.counts[ONCE]):
        e = frame.split_once[k]
        a, b = mesh.around.points[e, 0], mesh.around.points[e, 1]
        row = np.uint32(frame.first_points[e] + (frame.splits[e] >> 1))
        geomorph = min(ONE, SOON * frame.geomorph_once[e])
        normal = row_of(normals, np.uint32(vertex_count + e))
        if geomorph < ONE:
            mean = unit(plus(row_of(normals, a), row_of(normals, b)))
            normal = unit(mix(mean, normal, geomorph))
        write_row(vertices, row, normal, 3)
        if frame.splits[e] == 2:
            write_mean_normal(vertices, a, row, np.uint32(row - 1))
            write_mean_normal(vertices, b, row, np.uint32(row + 1))


@njit
def turn_centres(mesh: Connectivity, frame: FrameBuffers, rows: Floats) -> None:
    """Turn the normals of points in the middle of triangles as the least grown edge allows.

    To the normal of the hexagon around, whose corners are in `rows`, shape (V + E, 6).
    """
    vertices, vertex_count = frame.rows, mesh.vertex_count
    for k in range(frame.counts[CENTRES]):
        t, row = frame.centre_triangles[k], np.uint32(frame.counts[ROWS] + k)
        geomorph, hexagon = ONE, (ZERO, ZERO, ZERO)
        origin = row_of(rows, mesh.faces[t, 0])
        for i in range(3):
            e, last = mesh.triangle_edges[t, i], mesh.triangle_edges[t, i - 1]
            geomorph = min(geomorph, frame.geomorph_once[e] if frame.splits[e] > 0 else ZERO)
            a = less(row_of(rows, mesh.faces[t, i]), ONE, origin)
            after = np.uint32(vertex_count + e)
            before = np.uint32(vertex_count + last)
            hexagon = plus(hexagon, cross(a, between_rows(rows, before, after)))
        if geomorph > ZERO:
            geomorph = min(ONE, SOON * geomorph)
            mean = row_of(vertices, row, 3)
            write_row(vertices, row, unit(mix(mean, unit(hexagon), geomorph)), 3)


@njit
def measure_edges(
    mesh: Connectivity, rows: Floats, normals: Floats, displacements: Floats, turns: Floats
) -> None:
    """Write the distance of each middle from its edge, and turn of its normal x length, (E,)."""
    vertex_count = mesh.vertex_count
    for e in range(displacements.shape[0]):
        a, b = mesh.around.points[e, 0], mesh.around.points[e, 1]
        row = np.uint32(vertex_count + e)
        ends = plus(row_of(rows, a), row_of(rows, b))
        out = less(row_of(rows, row), HALF, ends)
        displacements[e] = np.sqrt(dot(out, out))
        mean = unit(plus(row_of(normals, a), row_of(normals, b)))
        apart = less(row_of(normals, row), ONE, mean)
        # The chord of the angle: within a hundredth of it up to half a radian.
        along = between_rows(rows, a, b)
        turns[e] = np.sqrt(dot(apart, apart) * dot(along, along))
