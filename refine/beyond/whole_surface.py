"""The surface of a frame with every edge split once, and its normals (see surface_normals.py).

Loops over the whole mesh write sums, and a separate loop normalises them. So the compiler
vectorises that loop (mesh/normals.py), and measuring all edges takes 0.42 of the time.
"""

import numpy as np

from ...geometry.arrays import Flags, Floats32, Floats64, Integers32, Unsigned32
from ...geometry.vectors import (
    HALF,
    ONE,
    ROW_WIDTH,
    THIRD,
    ZERO,
    Number,
    Vector,
    cross,
    difference,
    dot,
    less,
    plus,
    row_of,
    times,
    unit,
    write_row,
)
from ...jit import njit
from ..kahler.frame import FrameBuffers, buffers_for, split_everywhere
from ..kahler.look_up import SIDE_BITS
from ..mesh.connectivity import Connectivity
from ..mesh.fans import fans_before
from ..mesh.normals import normalise
from ..mesh.threads import parallel_for

CENTRE_WEIGHT = np.float32(0.511)
"""Weight of the edges' displacements in the centre of a triangle: 4/9 (blending.py) plus 15 %,
because curves between these points stand out farther. With this share the normals are closest to
the normals of a dense head.
"""
MEAN_NORMAL_WEIGHT = np.float32(0.02)
"""Weight of the mean of the ends' normals, in squared lengths of the edge, that is added to a
normal at a split point. Chosen: it matters where a fold leaves no width across an edge. A larger
weight is softer in deep folds, but farther from dense faces: 0.3 loses five of thirty percentage
points.
"""

OfEdges = tuple[Unsigned32, Unsigned32, Flags, Floats32, Floats32, Floats32]
"""The arrays that kernels over all edges read: `around.points`, `edge_sides`, `around.is_interior`
(mesh/) without edges at backs, rows of vertices and edge points, shape (V + E, 6), centres of
triangles, (F, 3), normals, (V + E, 3). It is a plain tuple, because numba takes it faster than a
named tuple.
"""


class WholeSurface:
    """The surface of a frame with every edge split once, and its normals."""

    def __init__(self, mesh: Connectivity, rest_positions: Floats64, is_back: Flags) -> None:
        """Allocate the arrays; `rest_positions`: shape (V, 3).

        is_back: flags of triangles that do not count in normals of other triangles, shape (F,).
        """
        self._mesh = mesh
        self._fans = fans_before(mesh, is_back)
        self._origin = mesh.first_vertex
        vertex_count = mesh.vertex_count
        edge_count = len(mesh.edges)
        near = np.zeros_like(rest_positions)
        points = rest_positions.astype(np.float32)
        frame = buffers_for(mesh, near, points, np.zeros_like(points))
        rows = np.zeros((vertex_count + edge_count, 6), dtype=np.float32)
        self._frame = split_everywhere(frame, vertex_count)._replace(rows=rows)
        self._centres = np.zeros((len(mesh.faces), 3), dtype=np.float32)
        self._corners = np.zeros((3 * len(mesh.faces), 3), dtype=np.float32)
        self._has_all_edges = False
        self.rows = rows
        """Positions and normals of the vertices, then of the points of all edges, shape (V + E,
        6). Positions are relative to the first vertex in use, so that a mesh far from the origin
        keeps its precision.
        """
        self.normals = np.zeros((vertex_count + edge_count, 3), dtype=np.float32)
        """Unit normals of these rows, shape (V + E, 3); of edges only after
        `find_normals_of_edges`.
        """
        is_smooth = mesh.around.is_interior.copy()
        first, second = is_back[mesh.edge_sides[is_smooth] >> SIDE_BITS].T
        is_smooth[is_smooth] = first == second
        around = mesh.around.points, mesh.edge_sides, is_smooth
        self._of_edges: OfEdges = (*around, rows, self._centres, self.normals)

    def split(self, frame: FrameBuffers) -> FrameBuffers:
        """Return the mesh of `frame` with every edge split once, before points are placed."""
        if frame.normals is not self._frame.normals:
            self._frame = self._frame._replace(normals=frame.normals)
        positions = frame.positions
        near = self._frame.positions
        points = self._frame.points
        parallel_for(see_from, len(positions), positions, self._origin, near, points)
        return self._frame

    def find_normals(self) -> None:
        """Compute the normals of vertices, after the rows have been placed."""
        mesh = self._mesh
        triangles = mesh.faces, mesh.triangle_edges
        of_triangles = self._centres, self._corners
        edge_points = self.rows[mesh.vertex_count :]
        parallel_for(
            cross_corners, len(mesh.faces), *triangles, self.rows, edge_points, *of_triangles
        )
        fans = self._fans.corner_starts, self._fans.corners
        parallel_for(sum_corners, mesh.vertex_count, *fans, self._corners, self.normals)
        self._has_all_edges = False

    def find_normals_of_edges(self, edges: Unsigned32) -> None:
        """Compute the normals at the points of `edges`, (N,), unless all are known already."""
        if self._has_all_edges:
            return
        parallel_for(surface_normals_of_edges, len(edges), edges, self._of_edges)

    def measure(self, displacements: Floats32, turns: Floats32) -> None:
        """Write the distances of split points from edges, and turns of their normals, (E,) each.

        A turn is the angle between the normal and the mean of the normals at the ends [rad], times
        the length of the edge. This computes the normals at all split points.
        """
        means = self._corners  # no longer needed, and large enough
        parallel_for(measure_edges, len(turns), self._of_edges, means, displacements, turns)
        self._has_all_edges = True


@njit
def see_from(
    first: int, last: int, positions: Floats64, origin: int, near: Floats64, points: Floats32
) -> None:
    """Write positions relative to one vertex, shape (V, 3), in double and in single precision."""
    for v in range(first, last):
        away = difference(positions, origin, v)
        write_row(near, v, away)
        write_row(points, v, away)


@njit
def between_rows(rows: Floats32, a: np.uint32, b: np.uint32) -> Vector:
    """Return the vector from row a to row b."""
    return less(row_of(rows, b), ONE, row_of(rows, a))


@njit
def cross_corners(
    first: int,
    last: int,
    faces: Unsigned32,
    triangle_edges: Integers32,
    rows: Floats32,
    edge_points: Floats32,
    centres: Floats32,
    corners: Floats32,
) -> None:
    """Write the centres of triangles with three split edges, shape (F, 3).

    Also write the summand of each triangle in the normals at its corners, shape (3 F, 3); it is
    zero for a triangle that names a vertex twice. `rows`: rows of vertices and
    of edge points, shape (V + E, 6); `edge_points`: rows of edge points, (E, 6).
    """
    assert (
        faces.shape[1]
        == triangle_edges.shape[1]
        == centres.shape[1]
        == corners.shape[1]
        == ROW_WIDTH
    )
    for k in range(first, last):
        t = np.uint32(k)
        of_a = np.uint32(3 * t)
        of_b = np.uint32(of_a + 1)
        of_c = np.uint32(of_a + 2)
        if triangle_edges[t, 0] < 0:
            corners[3 * t : 3 * t + 3] = ZERO
            continue
        a = row_of(rows, faces[t, 0])
        b = row_of(rows, faces[t, 1])
        c = row_of(rows, faces[t, 2])
        ab = row_of(edge_points, np.uint32(triangle_edges[t, 0]))
        bc = row_of(edge_points, np.uint32(triangle_edges[t, 1]))
        ca = row_of(edge_points, np.uint32(triangle_edges[t, 2]))
        # The sum of displacements is the sum of the split points minus that of the corners.
        three = plus(plus(a, b), c)
        out = less(plus(plus(ab, bc), ca), ONE, three)
        centre = plus(times(THIRD, three), times(CENTRE_WEIGHT, out))
        write_row(centres, t, centre)
        write_row(corners, of_a, cross(less(centre, ONE, a), less(ca, ONE, ab)))
        write_row(corners, of_b, cross(less(centre, ONE, b), less(ab, ONE, bc)))
        write_row(corners, of_c, cross(less(centre, ONE, c), less(bc, ONE, ca)))


@njit
def sum_corners(
    first: int,
    last: int,
    starts: Unsigned32,
    around: Unsigned32,
    corners: Floats32,
    normals: Floats32,
) -> None:
    """Write unit normals of vertices into the first V rows of `normals`, shape (V + E, 3).

    `starts`, `around`: the corners at each vertex (mesh/fans.py). `corners`: their summands, shape
    (3 F, 3).
    """
    assert corners.shape[1] == normals.shape[1] == ROW_WIDTH
    for k in range(first, last):
        v = np.uint32(k)
        total = ZERO, ZERO, ZERO
        for i in range(starts[v], starts[v + 1]):
            corner = around[i]  # 4 x triangle + side
            total = plus(total, row_of(corners, np.uint32(corner - (corner >> SIDE_BITS))))
        write_row(normals, v, total)
    normalise(normals[first:last])


@njit
def across_edge(
    e: Number,
    mean: Vector,
    along: Vector,
    edge_point: Vector,
    edge_sides: Unsigned32,
    is_interior: Flags,
    centres: Floats32,
) -> Vector:
    """Return a vector of any length, normal to the surface at the point of edge e.

    mean: mean of the normals at its ends; along: vector from end to end; edge_point: its split
    point.
    `edge_sides`, `is_interior`: fields of `Connectivity`; `centres`: a point in each triangle,
    shape (F, 3).
    """
    side = edge_sides[e, 0] >> SIDE_BITS
    beyond = edge_sides[e, 1] >> SIDE_BITS
    has_two = beyond < centres.shape[0]
    if has_two and not is_interior[e]:
        return mean  # sheets that meet at a border share no normal
    far = row_of(centres, beyond) if has_two else edge_point
    across = less(row_of(centres, side), ONE, far)
    steady = times(MEAN_NORMAL_WEIGHT * dot(along, along), mean)
    return plus(cross(along, across), steady)


@njit
def surface_normals_of_edges(first: int, last: int, edges: Unsigned32, of_edges: OfEdges) -> None:
    """Write unit normals at the points of edges; those of the vertices must be known.

    `edges`: indices of these edges, shape (N,).
    """
    points, edge_sides, is_interior, rows, centres, normals = of_edges
    vertex_count = normals.shape[0] - points.shape[0]
    for k in range(first, last):
        e = edges[k]
        a = points[e, 0]
        b = points[e, 1]
        row = np.uint32(vertex_count + e)
        mean = times(HALF, plus(row_of(normals, a), row_of(normals, b)))
        edge_point = row_of(rows, row)
        along = between_rows(rows, a, b)
        normal = across_edge(e, mean, along, edge_point, edge_sides, is_interior, centres)
        write_row(normals, row, unit(normal))


@njit
def measure_edges(
    first: int,
    last: int,
    of_edges: OfEdges,
    means: Floats32,
    displacements: Floats32,
    turns: Floats32,
) -> None:
    """Write unit normals at the points of consecutive edges, and measure the edges.

    The measures are the distance of each point from its straight edge, and the turn of its normal
    times the length of the edge, (E,) each. `means`: scratch, at least (E, 3).
    """
    points, edge_sides, is_interior, rows, centres, normals = of_edges
    assert centres.shape[1] == normals.shape[1] == means.shape[1] == ROW_WIDTH
    vertex_count = np.uint32(normals.shape[0] - points.shape[0])
    for k in range(first, last):
        e = np.uint32(k)
        a = points[e, 0]
        b = points[e, 1]
        row = np.uint32(vertex_count + e)
        sum_of_normals = plus(row_of(normals, a), row_of(normals, b))
        at_a = row_of(rows, a)
        at_b = row_of(rows, b)
        edge_point = row_of(rows, row)
        along = less(at_b, ONE, at_a)
        out = less(edge_point, HALF, plus(at_a, at_b))
        mean = times(HALF, sum_of_normals)
        normal = across_edge(e, mean, along, edge_point, edge_sides, is_interior, centres)
        write_row(normals, row, normal)
        write_row(means, e, sum_of_normals)
        displacements[e] = dot(out, out)
        turns[e] = dot(along, along)
    own = normals[vertex_count + first : vertex_count + last]
    means = means[first:last]
    normalise(own)
    normalise(means)
    finish_measures(own, means, displacements[first:last], turns[first:last])


@njit
def finish_measures(
    normals: Floats32, means: Floats32, displacements: Floats32, turns: Floats32
) -> None:
    """Take the roots of `displacements`, and of `turns` times the squared turns of normals, (N,).

    `normals`, `means`: unit vectors, shape (N, 3).
    """
    assert normals.shape[1] == means.shape[1] == ROW_WIDTH
    for k in range(turns.shape[0]):
        # The chord of the angle: up to half a radian it differs from the angle by less than a
        # hundredth.
        apart = less(row_of(normals, k), ONE, row_of(means, k))
        turns[k] = np.sqrt(dot(apart, apart) * turns[k])
        displacements[k] = np.sqrt(displacements[k])
