r"""Normals of the refined surface itself: `normals="refined"`.

Kähler, Haber, Seidel 2003, interpolate the normal of a new point from those at the ends of its edge
(section 4.4). Then smooth shading cannot show the form that a split found: only outlines and
highlights change. This scheme takes the surface that all splits together would make, everywhere:

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
not depend on the splits of this frame, so no normal jumps when an edge is split. Normals at m are
worked out where an edge is split; on all edges where the criterion measures them. A new point
begins with the mean of the normals at the ends of its edge, and turns to its own while it goes the
first third of its way (blending.py). At a quarter it is the mean of its neighbours'.

Differs from the paper, whose rule is `normals="linear"`.
"""

import numpy as np

from ...geometry.arrays import Flags, Floats32, Floats64, Integers32, Unsigned32
from ...jit import njit
from ..kahler.frame import ONCE, ROWS, FrameBuffers, buffers_for, split_everywhere
from ..kahler.look_up import SIDE_BITS, SIDE_MASK
from ..kahler.smoothing import Scheme
from ..mesh.connectivity import Connectivity
from ..mesh.fans import fans_of
from ..mesh.threads import share
from ..mesh.vectors import (
    HALF,
    ONE,
    THIRD,
    ZERO,
    Vector,
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

CENTRE_SHARE = np.float32(0.511)
"""How far the middle of a triangle follows the displacements of its edges: 4/9 (blending.py), and
15 % more: curves between these points stand out farther. So normals are nearer to a dense head."""
NORMAL_HASTE = np.float32(3.0)
"""How much sooner than the place of a new point its normal has gone all the way. Chosen: a turn of
shading is seen less than a jump of the surface, and half of it is half a triangle wasted."""
MEAN_NORMAL_SHARE = np.float32(0.02)
"""Share of the mean of the ends' normals, in squared lengths of the edge, that is added to a normal
in the middle. Chosen: where an edge is folded until nothing is left across it, this decides. More
looks softer in deep folds and is farther from dense faces: 0.3 costs five points of thirty."""


class WholeSurface:
    """The surface of a frame where every edge is split once, and its normals."""

    def __init__(self, mesh: Connectivity, rest_positions: Floats64) -> None:
        """Make room; `rest_positions`: shape (V, 3)."""
        self._mesh = mesh
        self._fans = fans_of(mesh)
        self._origin = mesh.first_vertex
        vertex_count = mesh.vertex_count
        edge_count = len(mesh.edges)
        near = np.zeros_like(rest_positions)
        points = rest_positions.astype(np.float32)
        frame = buffers_for(mesh, near, points, np.zeros_like(points))
        rows = np.zeros((vertex_count + edge_count, 6), dtype=np.float32)
        self._frame = split_everywhere(frame, vertex_count)._replace(rows=rows)
        self._centres = np.zeros((len(mesh.faces), 3), dtype=np.float32)
        self._has_all_edges = False
        self.rows = rows
        """Of the vertices, then of the middles of all edges, shape (V + E, 6): positions first, as
        seen from the first vertex in use, so that a mesh far from the origin loses nothing."""
        self.normals = np.zeros((vertex_count + edge_count, 3), dtype=np.float32)
        """Unit normals there, shape (V + E, 3); in middles after `find_normals_of_edges` alone."""

    def split(self, frame: FrameBuffers) -> FrameBuffers:
        """The mesh of `frame`, as seen from its first vertex, every edge split once; unplaced."""
        if frame.normals is not self._frame.normals:
            self._frame = self._frame._replace(normals=frame.normals)
        positions = frame.positions
        near = self._frame.positions
        points = self._frame.points
        share(see_from, len(positions), positions, self._origin, near, points)
        return self._frame

    def find_normals(self) -> None:
        """Work the normals of vertices out, when the rows have been placed."""
        mesh = self._mesh
        rows = self.rows
        centres = self._centres
        normals = self.normals
        triangles = mesh.faces, mesh.triangle_edges
        share(place_surface_centres, len(centres), mesh.vertex_count, *triangles, rows, centres)
        fans = self._fans.corner_starts, self._fans.corners, mesh.triangle_edges
        count = mesh.vertex_count
        share(surface_normals_of_vertices, count, *fans, rows, centres, normals)
        self._has_all_edges = False

    def find_normals_of_edges(self, edges: Unsigned32) -> None:
        """Work the normals in the middles of these out, numbers of shape (N,), unless all have."""
        if self._has_all_edges:
            return
        mesh = self._mesh
        around = mesh.around.points, mesh.edge_sides, mesh.around.is_interior
        arrays = self.rows, self._centres, self.normals
        share(surface_normals_of_edges, len(edges), edges, *around, *arrays)

    def measure(self, displacements: Floats32, turns: Floats32) -> None:
        """Write how far middles stand out of their edges, and their normals turn; shape (E,) each.

        Against the straight edge, and against the mean of the normals at its ends [rad], times the
        length of the edge. All middles have their normals then.
        """
        self.find_normals_of_edges(self._frame.split_edges)
        self._has_all_edges = True
        points = self._mesh.around.points
        share(measure_edges, len(points), points, self.rows, self.normals, displacements, turns)


class RefinedNormals(Scheme):
    """A scheme, with the normals of the surface that it makes."""

    measures = True

    def __init__(self, scheme: Scheme) -> None:
        """`scheme`: says where points go."""
        self.parts = (scheme,)
        self.interpolates = scheme.interpolates
        self.uses_normals = scheme.uses_normals
        self._scheme = scheme

    def bind(
        self, connectivity: Connectivity, rest_positions: Floats64, rest_normals: Floats32
    ) -> None:
        """Bind the scheme, and make room for its surface."""
        self._scheme.bind(connectivity, rest_positions, rest_normals)
        self._mesh = connectivity
        self._surface = WholeSurface(connectivity, rest_positions)
        on_crease = np.zeros(connectivity.vertex_count, dtype=np.bool_)
        on_crease[connectivity.edges[connectivity.is_sharp]] = True
        self._at_creases = np.flatnonzero(on_crease[connectivity.edges].any(axis=1))

    def prepare(self, frame: FrameBuffers) -> None:
        """Find the surface of this frame where every edge is split once, and its normals."""
        self._scheme.prepare(frame)
        self._scheme.place_positions(self._surface.split(frame))
        self._surface.find_normals()

    def place(self, frame: FrameBuffers) -> None:
        """Write points where the scheme has them, with the normals of its surface."""
        self._surface.find_normals_of_edges(frame.split_edges)
        self._scheme.place_positions(frame)
        count = len(frame.points) + int(frame.counts[ONCE])
        share(turn_normals, count, self._mesh.around.points, frame, self._surface.normals)

    def place_centres(self, frame: FrameBuffers) -> None:
        """Let the scheme correct the middles of triangles, and turn their normals."""
        self._scheme.place_centres(frame)
        triangles = self._mesh.faces, self._mesh.triangle_edges
        share(turn_centres, frame.centre_count, *triangles, frame, self._surface.rows)

    def measure(self, displacements: Floats32, turns: Floats32) -> None:
        """Write how far middles would stand out, and turn the normal, of every edge, (E,) each.

        The normal of a vertex on a crease is between those of its sides, and a
        split would not mend the turn of edges that end there.
        """
        self._surface.measure(displacements, turns)
        turns[self._at_creases] = ZERO


@njit
def see_from(
    first: int, last: int, positions: Floats64, origin: int, near: Floats64, points: Floats32
) -> None:
    """Write positions less that of one vertex, shape (V, 3), in double and in single precision."""
    for v in range(first, last):
        away = difference(positions, origin, v)
        write_row(near, v, away)
        write_row(points, v, away)


@njit
def between_rows(rows: Floats32, a: np.uint32, b: np.uint32) -> Vector:
    """The vector from row a to row b."""
    return less(row_of(rows, b), ONE, row_of(rows, a))


@njit
def place_surface_centres(
    first: int,
    last: int,
    vertex_count: int,
    faces: Unsigned32,
    triangle_edges: Integers32,
    rows: Floats32,
    centres: Floats32,
) -> None:
    """Write the points in the middle of triangles with three split edges, shape (F, 3).

    `rows`: of vertices and of the middles of all edges, shape (V + E, 6).
    """
    for t in range(first, last):
        corners = middles = ZERO, ZERO, ZERO
        for k in range(3):
            e = triangle_edges[t, k]
            corners = plus(corners, row_of(rows, faces[t, k]))
            if e >= 0:
                middles = plus(middles, row_of(rows, np.uint32(vertex_count + e)))
        # The sum of displacements is the sum of the middles less that of the corners.
        out = times(CENTRE_SHARE, less(middles, ONE, corners))
        write_row(centres, t, plus(times(THIRD, corners), out))


@njit
def surface_normals_of_vertices(
    first: int,
    last: int,
    starts: Unsigned32,
    corners: Unsigned32,
    triangle_edges: Integers32,
    rows: Floats32,
    centres: Floats32,
    normals: Floats32,
) -> None:
    """Write unit normals of vertices, the first of `normals`, shape (V + E, 3).

    `starts`, `corners`: of the triangles at each vertex (mesh/fans.py). `rows`: positions, shape
    (V + E, 6).
    """
    vertex_count = starts.shape[0] - 1
    for v in range(first, last):
        here = row_of(rows, v)
        total = (ZERO, ZERO, ZERO)
        for k in range(starts[v], starts[v + 1]):
            t = corners[k] >> SIDE_BITS
            i = corners[k] & SIDE_MASK
            if triangle_edges[t, 0] < 0:
                continue
            after = np.uint32(vertex_count + triangle_edges[t, i])
            before = np.uint32(vertex_count + triangle_edges[t, (i + 2) % 3])
            out = less(row_of(centres, t), ONE, here)
            total = plus(total, cross(out, between_rows(rows, after, before)))
        write_row(normals, v, unit(total))


@njit
def surface_normals_of_edges(
    first: int,
    last: int,
    edges: Unsigned32,
    points: Unsigned32,
    edge_sides: Unsigned32,
    is_interior: Flags,
    rows: Floats32,
    centres: Floats32,
    normals: Floats32,
) -> None:
    """Write unit normals of the middles of edges, the last of `normals`, shape (V + E, 3).

    `edges`: those that want theirs, shape (N,); `points`: of edges, shape (E, 4). The vertices have
    theirs.
    """
    vertex_count = normals.shape[0] - points.shape[0]
    face_count = centres.shape[0]
    for k in range(first, last):
        e = edges[k]
        a = points[e, 0]
        b = points[e, 1]
        row = np.uint32(vertex_count + e)
        mean = times(HALF, plus(row_of(normals, a), row_of(normals, b)))
        side = edge_sides[e, 0] >> SIDE_BITS
        beyond = edge_sides[e, 1] >> SIDE_BITS
        if not is_interior[e] and beyond < face_count:
            write_row(normals, row, unit(mean))  # sheets that meet have no normal in common
            continue
        along = between_rows(rows, a, b)
        far = row_of(centres, beyond) if beyond < face_count else row_of(rows, row)
        across = less(row_of(centres, side), ONE, far)
        steady = times(MEAN_NORMAL_SHARE * dot(along, along), mean)
        write_row(normals, row, unit(plus(cross(along, across), steady)))


@njit
def turn_normals(
    first: int, last: int, points: Unsigned32, frame: FrameBuffers, normals: Floats32
) -> None:
    """Write the normals of vertices and of the points of split edges, as far as they have grown.

    The loop is over vertices, and then over split edges. `points`: of edges, shape (E, 4);
    `normals`: of vertices and middles, shape (V + E, 3).
    """
    vertices = frame.rows
    vertex_count = frame.points.shape[0]
    for v in range(first, min(last, vertex_count)):
        write_row(vertices, v, row_of(normals, v), 3)
    for k in range(max(first - vertex_count, 0), last - vertex_count):
        e = frame.split_once[k]
        a = points[e, 0]
        b = points[e, 1]
        row = np.uint32(frame.first_points[e] + (frame.splits[e] >> 1))
        geomorph = min(ONE, NORMAL_HASTE * frame.geomorph_once[e])
        normal = row_of(normals, np.uint32(vertex_count + e))
        if geomorph < ONE:
            mean = unit(plus(row_of(normals, a), row_of(normals, b)))
            normal = unit(mix(mean, normal, geomorph))
        write_row(vertices, row, normal, 3)
        if frame.splits[e] == 2:
            near_a = np.uint32(row - 1)
            near_b = np.uint32(row + 1)
            write_row(vertices, near_a, unit(plus(row_of(normals, a), normal)), 3)
            write_row(vertices, near_b, unit(plus(row_of(normals, b), normal)), 3)


@njit
def turn_centres(
    first: int,
    last: int,
    faces: Unsigned32,
    triangle_edges: Integers32,
    frame: FrameBuffers,
    rows: Floats32,
) -> None:
    """Turn the normals of points in the middle of triangles as the least grown edge allows.

    To the normal of the hexagon around, whose corners are in `rows`, shape (V + E, 6).
    """
    vertices = frame.rows
    vertex_count = frame.points.shape[0]
    for k in range(first, last):
        t = frame.centre_triangles[k]
        row = np.uint32(frame.counts[ROWS] + k)
        geomorph = ONE
        hexagon = (ZERO, ZERO, ZERO)
        origin = row_of(rows, faces[t, 0])
        for i in range(3):
            e = triangle_edges[t, i]
            previous = triangle_edges[t, i - 1]
            geomorph = min(geomorph, frame.geomorph_once[e] if frame.splits[e] > 0 else ZERO)
            a = less(row_of(rows, faces[t, i]), ONE, origin)
            after = np.uint32(vertex_count + e)
            before = np.uint32(vertex_count + previous)
            hexagon = plus(hexagon, cross(a, between_rows(rows, before, after)))
        if geomorph > ZERO:
            geomorph = min(ONE, NORMAL_HASTE * geomorph)
            mean = row_of(vertices, row, 3)
            write_row(vertices, row, unit(mix(mean, unit(hexagon), geomorph)), 3)


@njit
def measure_edges(
    first: int,
    last: int,
    points: Unsigned32,
    rows: Floats32,
    normals: Floats32,
    displacements: Floats32,
    turns: Floats32,
) -> None:
    """Write the distance of each middle from its edge, and turn of its normal x length, (E,).

    `points`: of edges, shape (E, 4); `rows`, `normals`: of vertices and middles.
    """
    vertex_count = rows.shape[0] - points.shape[0]
    for e in range(first, last):
        a = points[e, 0]
        b = points[e, 1]
        row = np.uint32(vertex_count + e)
        ends = plus(row_of(rows, a), row_of(rows, b))
        out = less(row_of(rows, row), HALF, ends)
        displacements[e] = np.sqrt(dot(out, out))
        mean = unit(plus(row_of(normals, a), row_of(normals, b)))
        apart = less(row_of(normals, row), ONE, mean)
        # The chord of the angle: within a hundredth of it up to half a radian.
        along = between_rows(rows, a, b)
        turns[e] = np.sqrt(dot(apart, apart) * dot(along, along))
