r"""Smoothing: positions of vertices and of new points on split edges; the paper's scheme `loop`.

Kähler, Haber, Seidel 2003, section 4.2 with Figs. 3 and 4, after Loop 1987. `o` is the point that
is computed.

    first level, interior edge      border edge

              1/8
             /   \
          3/8--o--3/8              1/2---o---1/2
             \   /
              1/8

    second level: o halves the half-edge a'm; then the edge point m itself is moved

            c                quarter point, interior edge   o = 3/8 (a' + m) + 1/8 (p + r)
           / \               quarter point, border edge     o = 1/2 (a' + m)
          /   \
         p-----q             middle point, interior edge
        / \   / \                5/8 m + 1/16 (a' + b' + p + q + r + s)
       /   \ /   \           middle point, border edge
      a'-o--m-----b'             3/4 m + 1/8 (a' + b')
       \   / \   /
        \ /   \ /
         r-----s
          \   /
            d

m is the first-level point of the edge. p, q, r and s are the first-level points of the neighbour
edges ac, bc, ad and bd; if such an edge is not split, its midpoint is used. a' and b' are the moved
end points; their weights are in mesh/rings.py.

The paper leaves one question open. We decide that the second level reads m, p, q, r and s before it
moves any point, so that the order of edges does not matter.

The *geomorph weight* of a point is 0 on the straight edge and 1 at its final position; each edge
has one for each level. It is 1 everywhere unless the frame is blended (beyond/blending.py).
Interpolation with weight 0 or 1 returns one of the two positions to the last bit.

Normals of new points are interpolated between their two neighbours on the edge, and normalised
(section 4.4, first paragraph).
"""

from typing import Any

import numpy as np

from ...geometry.arrays import Floats32, Floats64, Unsigned8, Unsigned32
from ...geometry.vectors import (
    HALF,
    ONE,
    ROW_WIDTH,
    ZERO,
    Vector,
    mix,
    plus,
    row_of,
    times,
    unit,
    write_row,
)
from ...jit import njit
from ..mesh.connectivity import Connectivity, Surroundings
from ..mesh.rings import NEAR_COUNT, Rings, vertex_rings
from ..mesh.threads import parallel_for, threads_for
from .frame import SPLIT_EDGES, TWICE_SPLIT_EDGES, FrameBuffers
from .kept_splits import (
    KeptRows,
    copy_frame,
    keep_edge_points,
    kept_rows,
    place_crowded_vertices,
    place_kept_edge_points,
    place_kept_vertices,
)
from .scheme import Scheme

EDGE_END_WEIGHT = np.float32(3 / 8)
"""First and second level, interior: end points of the edge or half-edge (Fig. 3, Fig. 4 left)."""
EDGE_WING_WEIGHT = np.float32(1 / 8)
"""First and second level, interior: the two points beside it (Fig. 3, Fig. 4 left)."""
BORDER_END_WEIGHT = np.float32(1 / 2)
"""Border edge: end points (Fig. 3, bottom left)."""
BORDER_OWN_WEIGHT = np.float32(3 / 4)
"""Middle point of a border edge split twice: the rule of a vertex on a border (Fig. 3)."""
BORDER_RING_WEIGHT = np.float32(1 / 8)
"""The moved ends of this edge."""
MIDDLE_OWN_WEIGHT = np.float32(5 / 8)
"""Middle point of an interior edge split twice: valence six, 1 - 6/16 (Fig. 4 right)."""
MIDDLE_RING_WEIGHT = np.float32(1 / 16)
"""Its six neighbours, 3/(8 x 6) (Fig. 4 right)."""


class LoopScheme(Scheme):
    """The paper's scheme: Loop's rules with Warren's weights (section 4.2)."""

    def bind(
        self, connectivity: Connectivity, rest_positions: Floats64, rest_normals: Floats32
    ) -> None:
        """Compute the weights of every vertex."""
        self._around = connectivity.around
        self._rings = vertex_rings(connectivity)
        self._vertex_geomorph = np.zeros(connectivity.vertex_count, dtype=np.float32)
        self._edge_points = np.zeros((len(connectivity.edges), 3), dtype=np.float32)
        self._frame: FrameBuffers | None = None
        self._kept: KeptRows | None = None

    def keep(self, frame: FrameBuffers) -> None:
        """Compute a matrix, unless the frame is blended."""
        edges = frame.split_edges
        twice = frame.twice_split_edges
        once_grown = (frame.geomorph_once[edges] == ONE).all()
        if once_grown and (frame.geomorph_twice[twice] == ONE).all():
            self._kept, self._inside_count = kept_rows(frame, self._around, self._rings)

    def place(self, frame: FrameBuffers) -> None:
        """Write moved vertices, then points of the first level, then those of the second."""
        if threads_for(len(frame.points) + int(frame.counts[SPLIT_EDGES])) > 1:
            if self._kept is None:
                self._place_shared(frame)
            else:
                self._place_kept(frame, self._kept)
            return
        if frame is not self._frame:
            self._frame = frame
            self._tuples = frame[:], self._around[:], self._rings[:]  # plain: passed faster
        if self._kept is not None:
            place_kept(*self._tuples, self._kept[:], self._inside_count, self._edge_points)
            return
        place_by_loop(*self._tuples, self._vertex_geomorph, self._edge_points)

    def _place_shared(self, frame: FrameBuffers) -> None:
        """Write the results of `place` in loops shared among threads, equal to the last bit."""
        around = self._around
        edge_points = self._edge_points
        geomorph = self._vertex_geomorph
        edges = frame.split_edges
        geomorph_vertices(around.points, edges, frame.geomorph_once, geomorph)
        parallel_for(place_vertices, len(frame.points), frame, self._rings, geomorph)
        parallel_for(place_edge_points, len(edges), frame, around, edge_points)
        parallel_for(place_quarters, len(frame.twice_split_edges), frame, around, edge_points)

    def _place_kept(self, frame: FrameBuffers, kept: KeptRows) -> None:
        """Write the results of `place` for frames whose splits never change."""
        rows = frame.rows
        vertex_count = len(frame.points)
        parallel_for(copy_frame, vertex_count, frame, kept)
        parallel_for(place_kept_vertices, vertex_count, kept, rows)
        place_crowded_vertices(kept, self._rings, rows)
        inside_count = self._inside_count
        parallel_for(
            place_kept_edge_points, inside_count, kept, EDGE_END_WEIGHT, EDGE_WING_WEIGHT, rows
        )
        place_kept_edge_points(inside_count, len(kept.edges), kept, BORDER_END_WEIGHT, ZERO, rows)
        twice_count = len(frame.twice_split_edges)
        if twice_count > 0:
            keep_edge_points(kept, rows, self._edge_points)
            parallel_for(place_quarters, twice_count, frame, self._around, self._edge_points)


@njit
def write_mean_normal(rows: Floats32, p: np.uint32, q: np.uint32, row: np.uint32) -> None:
    """Write the unit mean of the normals of two rows."""
    total = plus(row_of(rows, p, 3), row_of(rows, q, 3))
    write_row(rows, row, unit(total), 3)


@njit
def geomorph_vertices(
    ends: Unsigned32, edges: Unsigned32, geomorph: Floats32, vertex_geomorph: Floats32
) -> None:
    """Write the geomorph weight of each vertex, (V,): the largest of its split edges, or 0.

    `ends`: the first two columns hold the vertices of each edge, (E, 4). `edges`: indices of the
    split edges, (N,). `geomorph`: the weight of each edge, (E,). Weights are written to
    `vertex_geomorph`.
    """
    vertex_geomorph[:] = ZERO
    for e in edges:
        a = ends[e, 0]
        b = ends[e, 1]
        vertex_geomorph[a] = max(vertex_geomorph[a], geomorph[e])
        vertex_geomorph[b] = max(vertex_geomorph[b], geomorph[e])


@njit
def place_vertices(
    first: int, last: int, frame: FrameBuffers, rings: Rings, geomorph: Floats32
) -> None:
    """Write the original vertices; the vertex rule moves vertices at split edges (Fig. 3).

    `geomorph`: weight of each vertex, shape (V,).
    """
    points = frame.points
    normals = frame.normals
    rows = frame.rows
    near = rings.near
    starts = rings.starts
    assert points.shape[1] == normals.shape[1] == ROW_WIDTH and near.shape[1] == NEAR_COUNT
    for v in range(first, last):
        point = row_of(points, v)
        if geomorph[v] > ZERO:
            total = row_of(points, near[v, 0])
            for k in range(1, NEAR_COUNT):
                total = plus(total, row_of(points, near[v, k]))
            for k in range(starts[v], starts[v + 1]):
                total = plus(total, row_of(points, rings.others[k]))
            moved = plus(times(rings.own[v], point), times(rings.ring[v], total))
            point = mix(point, moved, geomorph[v])
        write_row(rows, v, point)
        write_row(rows, v, row_of(normals, v), 3)


@njit
def place_edge_points(
    first: int, last: int, frame: FrameBuffers, around: Surroundings, edge_points: Floats32
) -> None:
    """Write the first-level point of every split edge (Fig. 3), and keep it in `edge_points`.

    `edge_points`: points at their final positions, shape (E, 3).
    """
    points = frame.points
    normals = frame.normals
    rows = frame.rows
    geomorph = frame.geomorph_once
    beside = around.points
    for e in frame.split_once[first:last]:
        a = beside[e, 0]
        b = beside[e, 1]
        c = beside[e, 2]
        d = beside[e, 3]
        row = frame.first_points[e] + (frame.splits[e] >> 1)
        ends = plus(row_of(points, a), row_of(points, b))
        edge_point = times(BORDER_END_WEIGHT, ends)
        if c != a:  # an edge inside the mesh
            wings = plus(row_of(points, c), row_of(points, d))
            edge_point = plus(times(EDGE_END_WEIGHT, ends), times(EDGE_WING_WEIGHT, wings))
        write_row(edge_points, e, edge_point)
        if geomorph[e] < ONE:
            straight = times(HALF, plus(row_of(rows, a), row_of(rows, b)))
            edge_point = mix(straight, edge_point, geomorph[e])
        write_row(rows, row, edge_point)
        normal = unit(plus(row_of(normals, a), row_of(normals, b)))
        write_row(rows, row, normal, 3)


@njit
def wing(
    points: Floats32,
    edge_points: Floats32,
    ends: tuple[int, int],
    e: np.uint32,
    geomorph: np.float32,
) -> Vector:
    """Return the first-level point of a neighbour edge at its current geomorph weight."""
    start = row_of(points, ends[0])
    end = row_of(points, ends[1])
    straight = times(HALF, plus(start, end))
    return mix(straight, row_of(edge_points, e), geomorph)


@njit
def geomorph_of_split(splits: Unsigned8, geomorph: Floats32, e: np.uint32) -> np.float32:
    """Return the geomorph weight of the midpoint of an edge; 0 if the edge is not split."""
    return geomorph[e] if splits[e] > 0 else ZERO


@njit
def place_quarters(
    first: int, last: int, frame: FrameBuffers, around: Surroundings, edge_points: Floats32
) -> None:
    """Write the quarter points of every edge that is split twice, and move its edge point (Fig. 4).

    `edge_points`: as `place_edge_points` left them.
    """
    points = frame.points
    rows = frame.rows
    splits = frame.splits
    once = frame.geomorph_once
    beside = around.points
    wings = around.wings
    for e in frame.split_twice[first:last]:
        near_a = frame.first_points[e]
        centre = np.uint32(near_a + 1)
        near_b = np.uint32(near_a + 2)
        a = beside[e, 0]
        b = beside[e, 1]
        c = beside[e, 2]
        d = beside[e, 3]
        m = row_of(edge_points, e)
        moved_a = row_of(rows, a)
        moved_b = row_of(rows, b)
        ends_a = plus(moved_a, m)
        ends_b = plus(moved_b, m)
        moved = plus(moved_a, moved_b)
        if c != a:  # an edge inside the mesh
            ac = wings[e, 0]
            bc = wings[e, 1]
            ad = wings[e, 2]
            bd = wings[e, 3]
            p = wing(points, edge_points, (a, c), ac, geomorph_of_split(splits, once, ac))
            q = wing(points, edge_points, (b, c), bc, geomorph_of_split(splits, once, bc))
            r = wing(points, edge_points, (a, d), ad, geomorph_of_split(splits, once, ad))
            s = wing(points, edge_points, (b, d), bd, geomorph_of_split(splits, once, bd))
            wings_a = plus(p, r)
            wings_b = plus(q, s)
            ring = plus(moved, plus(wings_a, wings_b))
            beside_a = plus(times(EDGE_END_WEIGHT, ends_a), times(EDGE_WING_WEIGHT, wings_a))
            beside_b = plus(times(EDGE_END_WEIGHT, ends_b), times(EDGE_WING_WEIGHT, wings_b))
            edge_point = plus(times(MIDDLE_OWN_WEIGHT, m), times(MIDDLE_RING_WEIGHT, ring))
        else:
            beside_a = times(BORDER_END_WEIGHT, ends_a)
            beside_b = times(BORDER_END_WEIGHT, ends_b)
            edge_point = plus(times(BORDER_OWN_WEIGHT, m), times(BORDER_RING_WEIGHT, moved))
        geomorph = frame.geomorph_twice[e]
        write_row(rows, near_a, mix(times(HALF, ends_a), beside_a, geomorph))
        write_row(rows, centre, mix(m, edge_point, geomorph))
        write_row(rows, near_b, mix(times(HALF, ends_b), beside_b, geomorph))
        write_mean_normal(rows, a, centre, near_a)
        write_mean_normal(rows, b, centre, near_b)


@njit
def place_by_loop(
    frame: tuple[Any, ...],
    around: tuple[Any, ...],
    rings: tuple[Any, ...],
    vertex_geomorph: Floats32,
    edge_points: Floats32,
) -> None:
    """Write moved vertices, the first level and the second level of a frame.

    This is one kernel, because the overhead of four calls would take longer than their work. The
    plain tuples are `FrameBuffers`, `Surroundings` and `Rings`; `vertex_geomorph`, shape (V,), and
    `edge_points`, shape (E, 3), are scratch.
    """
    of_frame = FrameBuffers(*frame)
    of_edges = Surroundings(*around)
    counts = of_frame.counts
    split = of_frame.split_once[: counts[SPLIT_EDGES]]
    geomorph_vertices(of_edges.points, split, of_frame.geomorph_once, vertex_geomorph)
    place_vertices(0, len(of_frame.points), of_frame, Rings(*rings), vertex_geomorph)
    place_edge_points(0, counts[SPLIT_EDGES], of_frame, of_edges, edge_points)
    place_quarters(0, counts[TWICE_SPLIT_EDGES], of_frame, of_edges, edge_points)


@njit(lanes=True)
def place_kept(
    frame: tuple[Any, ...],
    around: tuple[Any, ...],
    rings: tuple[Any, ...],
    kept: tuple[Any, ...],
    inside_count: int,
    edge_points: Floats32,
) -> None:
    """Write the results of `place_by_loop` for fixed splits; `kept`: tuple of `KeptRows`."""
    of_frame = FrameBuffers(*frame)
    matrix = KeptRows(*kept)
    rows = of_frame.rows
    vertex_count = len(of_frame.points)
    copy_frame(0, vertex_count, of_frame, matrix)
    place_kept_vertices(0, vertex_count, matrix, rows)
    place_crowded_vertices(matrix, Rings(*rings), rows)
    place_kept_edge_points(0, inside_count, matrix, EDGE_END_WEIGHT, EDGE_WING_WEIGHT, rows)
    place_kept_edge_points(inside_count, len(matrix.edges), matrix, BORDER_END_WEIGHT, ZERO, rows)
    twice_count = of_frame.counts[TWICE_SPLIT_EDGES]
    if twice_count > 0:
        keep_edge_points(matrix, rows, edge_points)
        place_quarters(0, twice_count, of_frame, Surroundings(*around), edge_points)
