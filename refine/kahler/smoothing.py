r"""Smoothing: where vertices and new points on split edges go; the paper's scheme, named `loop`.

Kähler, Haber, Seidel 2003, section 4.2 with Figs. 3 and 4, after Loop 1987. `o` is the point that
is computed.

    first level, interior edge      border edge

              1/8
             /   \
          3/8--o--3/8              1/2---o---1/2
             \   /
              1/8

    second level: o halves the half-edge a'm; then the middle point m itself is moved

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

m is the first-level point of the edge; p, q, r, s those of the neighbour edges ac, bc, ad, bd, or
their midpoints where these are not split. a' and b' are the moved end points; their weights are in
mesh/rings.py.

The paper leaves open, and we decide: m, p, q, r, s enter the second level as the first level left
them, so that the order of edges cannot matter.

The *geomorph weight* is how much of its way from the straight edge a point has gone: 0 to 1, for
each level of each edge; 1 everywhere unless the frame is blended (beyond/blending.py). A mix with
weight 0 or 1 returns one of its two sides to the last bit.

Normals of new points are interpolated between their two neighbours on the edge and normalised
(section 4.4, first paragraph).

Section 6: "the effects of other smoothing schemes" are of interest. So a scheme is a class.
"""

import numpy as np

from ...geometry.arrays import Floats32, Floats64, Integers64, Unsigned8, Unsigned32
from ...jit import njit
from ..border.registry import Registry
from ..mesh.connectivity import Connectivity
from ..mesh.rings import NEAR_COUNT, vertex_rings
from ..mesh.threads import share, threads_for
from ..mesh.vectors import (
    HALF,
    ONE,
    WIDTH,
    ZERO,
    Vector,
    mix,
    plus,
    row_of,
    times,
    unit,
    write_row,
)
from .frame import ONCE, TWICE, FrameBuffers

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


class Scheme:
    """Places points: what every scheme derives from, the paper's as well as your own.

    It writes `place`; all other methods do nothing unless they are written. A refiner calls `bind`
    once, then in every frame `prepare`, `place` and, where it blends, `place_centres`.
    """

    interpolates = False
    """Whether the original vertices stay where they are."""
    uses_normals = True
    """Whether it reads the normals of frames, which are not found where nobody does."""
    measures = False
    """Whether it has a `measure`, which the criterion `displacement` needs."""
    parts: tuple["Scheme", ...] = ()
    """Schemes that this one asks. Each of them, too, serves one refiner only."""

    def bind(
        self, connectivity: Connectivity, rest_positions: Floats64, rest_normals: Floats32
    ) -> None:
        """Learn the mesh: `rest_positions` and `rest_normals`, shape (V, 3)."""

    def prepare(self, frame: FrameBuffers) -> None:
        """Look at the deformed mesh, before the criterion decides.

        Keep differences of positions only: refined normals call `place` twice, first
        for the mesh as seen from its first vertex with every edge split once.
        """

    def place(self, frame: FrameBuffers) -> None:
        """Write positions and normals of vertices and of points on split edges into the rows."""
        raise NotImplementedError(f"{type(self).__name__} must have a method place")

    def place_positions(self, frame: FrameBuffers) -> None:
        """Write positions only; calls `place` unless a subclass writes it."""
        self.place(frame)

    def place_centres(self, frame: FrameBuffers) -> None:
        """Correct the points in the middle of triangles, when blending has written them."""

    def measure(self, displacements: Floats32, turns: Floats32) -> None:
        """Write how far a split would move the middle of each edge and turn its normal, (E,) each.

        The turn is an angle [rad] times the length of the edge. The criterion `displacement` reads
        both.
        """
        raise NotImplementedError(f"{type(self).__name__} has no method measure")


schemes: Registry[Scheme] = Registry("scheme", "risorius.schemes")
"""Schemes by name; a factory is called without arguments, once for each refiner that asks."""


class LoopScheme(Scheme):
    """The paper's scheme: Loop's rules with Warren's weights (section 4.2)."""

    def bind(
        self, connectivity: Connectivity, rest_positions: Floats64, rest_normals: Floats32
    ) -> None:
        """Work out the weights of every vertex."""
        self._around = connectivity.around
        self._rings = vertex_rings(connectivity)
        self._vertex_geomorph = np.zeros(connectivity.vertex_count, dtype=np.float32)
        self._middles = np.zeros((len(connectivity.edges), 3), dtype=np.float32)
        self._frame: FrameBuffers | None = None

    def place(self, frame: FrameBuffers) -> None:
        """Write moved vertices, first level, second level."""
        if threads_for(len(frame.points) + int(frame.counts[ONCE])) > 1:
            self._place_shared(frame)
            return
        if frame is not self._frame:
            self._frame = frame
            self._arrays = (
                frame.points,
                frame.normals,
                self._around.points,
                self._around.wings,
                *self._rings,
                frame.splits,
                frame.first_points,
                frame.split_once,
                frame.split_twice,
                frame.counts,
                frame.geomorph_once,
                frame.geomorph_twice,
                self._vertex_geomorph,
                self._middles,
                frame.rows,
            )
        place_by_loop(*self._arrays)

    def _place_shared(self, frame: FrameBuffers) -> None:
        """Do the same in loops that threads share, to the same bits."""
        around = self._around.points
        edges = frame.split_edges
        mesh = frame.points, frame.normals
        of_edges = frame.splits, frame.first_points, frame.geomorph_once
        to = self._middles, frame.rows
        geomorph_vertices(around, edges, frame.geomorph_once, self._vertex_geomorph)
        to_vertices = self._vertex_geomorph, frame.rows
        share(place_vertices, len(frame.points), *mesh, *self._rings, *to_vertices)
        share(place_middles, len(edges), *mesh, around, edges, *of_edges, *to)
        edges = frame.twice_split_edges
        of_twice = *of_edges, frame.geomorph_twice, *to
        share(place_quarters, len(edges), mesh[0], around, self._around.wings, edges, *of_twice)


@njit
def write_mean_normal(rows: Floats32, p: np.uint32, q: np.uint32, row: np.uint32) -> None:
    """Write the unit mean of the normals of two rows."""
    total = plus(row_of(rows, p, 3), row_of(rows, q, 3))
    write_row(rows, row, unit(total), 3)


@njit
def geomorph_vertices(
    ends: Unsigned32, edges: Unsigned32, geomorph: Floats32, vertex_geomorph: Floats32
) -> None:
    """A vertex moves as much as the most grown edge at it: 0 where none is split, shape (V,).

    `ends`: of edges, in the first two columns of (E, 4); `edges`: those that are split, shape (N,);
    `geomorph`: of edges, shape (E,).
    """
    vertex_geomorph[:] = ZERO
    for e in edges:
        a = ends[e, 0]
        b = ends[e, 1]
        vertex_geomorph[a] = max(vertex_geomorph[a], geomorph[e])
        vertex_geomorph[b] = max(vertex_geomorph[b], geomorph[e])


@njit
def place_vertices(  # noqa: PLR0913 - arrays: tuples take longer to hand over
    first: int,
    last: int,
    points: Floats32,
    normals: Floats32,
    own: Floats32,
    ring: Floats32,
    near: Unsigned32,
    starts: Unsigned32,
    others: Unsigned32,
    geomorph: Floats32,
    vertices: Floats32,
) -> None:
    """Write the original vertices, those at split edges moved by the vertex rule (Fig. 3).

    `own` to `others`: the arrays of `Rings`; `geomorph`: of each vertex, shape (V,).
    """
    assert points.shape[1] == normals.shape[1] == WIDTH and near.shape[1] == NEAR_COUNT
    for v in range(first, last):
        point = row_of(points, v)
        if geomorph[v] > ZERO:
            total = row_of(points, near[v, 0])
            for k in range(1, NEAR_COUNT):
                total = plus(total, row_of(points, near[v, k]))
            for k in range(starts[v], starts[v + 1]):
                total = plus(total, row_of(points, others[k]))
            moved = plus(times(own[v], point), times(ring[v], total))
            point = mix(point, moved, geomorph[v])
        write_row(vertices, v, point)
        write_row(vertices, v, row_of(normals, v), 3)


@njit
def place_middles(  # noqa: PLR0913 - arrays: tuples take longer to hand over
    first: int,
    last: int,
    points: Floats32,
    normals: Floats32,
    around: Unsigned32,
    edges: Unsigned32,
    splits: Unsigned8,
    first_points: Unsigned32,
    geomorph: Floats32,
    middles: Floats32,
    vertices: Floats32,
) -> None:
    """Write the first-level point of every split edge (Fig. 3), and keep it in `middles`.

    `around`: a, b, c, d of every edge, shape (E, 4); `edges`: those that are split, shape (N,);
    `middles`: points as they are when fully grown, shape (E, 3).
    """
    for e in edges[first:last]:
        a = around[e, 0]
        b = around[e, 1]
        c = around[e, 2]
        d = around[e, 3]
        row = first_points[e] + (splits[e] >> 1)
        ends = plus(row_of(points, a), row_of(points, b))
        middle = times(BORDER_END_WEIGHT, ends)
        if c != a:  # an edge inside the mesh
            wings = plus(row_of(points, c), row_of(points, d))
            middle = plus(times(EDGE_END_WEIGHT, ends), times(EDGE_WING_WEIGHT, wings))
        write_row(middles, e, middle)
        if geomorph[e] < ONE:
            straight = times(HALF, plus(row_of(vertices, a), row_of(vertices, b)))
            middle = mix(straight, middle, geomorph[e])
        write_row(vertices, row, middle)
        normal = unit(plus(row_of(normals, a), row_of(normals, b)))
        write_row(vertices, row, normal, 3)


@njit
def wing(
    points: Floats32, middles: Floats32, ends: tuple[int, int], e: np.uint32, geomorph: np.float32
) -> Vector:
    """The first-level point of a neighbour edge, as far as it has grown out of its midpoint."""
    start = row_of(points, ends[0])
    end = row_of(points, ends[1])
    straight = times(HALF, plus(start, end))
    return mix(straight, row_of(middles, e), geomorph)


@njit
def geomorph_of_split(splits: Unsigned8, geomorph: Floats32, e: np.uint32) -> np.float32:
    """How far the middle of an edge has grown; 0 where it has none."""
    return geomorph[e] if splits[e] > 0 else ZERO


@njit
def place_quarters(  # noqa: PLR0913 - arrays: tuples take longer to hand over
    first: int,
    last: int,
    points: Floats32,
    around: Unsigned32,
    wings: Unsigned32,
    edges: Unsigned32,
    splits: Unsigned8,
    first_points: Unsigned32,
    once: Floats32,
    twice: Floats32,
    middles: Floats32,
    vertices: Floats32,
) -> None:
    """Write the quarter points of every edge that is split twice, and move its middle (Fig. 4).

    `around`, `wings`: as in `Surroundings`; `edges`: those split twice, shape (N,); `once`,
    `twice`: geomorph weights of edges; `middles`: as `place_middles` left them.
    """
    for e in edges[first:last]:
        near_a = first_points[e]
        centre = np.uint32(near_a + 1)
        near_b = np.uint32(near_a + 2)
        a = around[e, 0]
        b = around[e, 1]
        c = around[e, 2]
        d = around[e, 3]
        m = row_of(middles, e)
        moved_a = row_of(vertices, a)
        moved_b = row_of(vertices, b)
        ends_a = plus(moved_a, m)
        ends_b = plus(moved_b, m)
        moved = plus(moved_a, moved_b)
        if c != a:  # an edge inside the mesh
            ac = wings[e, 0]
            bc = wings[e, 1]
            ad = wings[e, 2]
            bd = wings[e, 3]
            p = wing(points, middles, (a, c), ac, geomorph_of_split(splits, once, ac))
            q = wing(points, middles, (b, c), bc, geomorph_of_split(splits, once, bc))
            r = wing(points, middles, (a, d), ad, geomorph_of_split(splits, once, ad))
            s = wing(points, middles, (b, d), bd, geomorph_of_split(splits, once, bd))
            wings_a = plus(p, r)
            wings_b = plus(q, s)
            ring = plus(moved, plus(wings_a, wings_b))
            beside_a = plus(times(EDGE_END_WEIGHT, ends_a), times(EDGE_WING_WEIGHT, wings_a))
            beside_b = plus(times(EDGE_END_WEIGHT, ends_b), times(EDGE_WING_WEIGHT, wings_b))
            middle = plus(times(MIDDLE_OWN_WEIGHT, m), times(MIDDLE_RING_WEIGHT, ring))
        else:
            beside_a = times(BORDER_END_WEIGHT, ends_a)
            beside_b = times(BORDER_END_WEIGHT, ends_b)
            middle = plus(times(BORDER_OWN_WEIGHT, m), times(BORDER_RING_WEIGHT, moved))
        geomorph = twice[e]
        write_row(vertices, near_a, mix(times(HALF, ends_a), beside_a, geomorph))
        write_row(vertices, centre, mix(m, middle, geomorph))
        write_row(vertices, near_b, mix(times(HALF, ends_b), beside_b, geomorph))
        write_mean_normal(vertices, a, centre, near_a)
        write_mean_normal(vertices, b, centre, near_b)


@njit
def place_by_loop(  # noqa: PLR0913 - all of it at once: four calls take longer than their work
    points: Floats32,
    normals: Floats32,
    around: Unsigned32,
    wings: Unsigned32,
    own: Floats32,
    ring: Floats32,
    near: Unsigned32,
    starts: Unsigned32,
    others: Unsigned32,
    splits: Unsigned8,
    first_points: Unsigned32,
    split_once: Unsigned32,
    split_twice: Unsigned32,
    counts: Integers64,
    once: Floats32,
    twice: Floats32,
    vertex_geomorph: Floats32,
    middles: Floats32,
    rows: Floats32,
) -> None:
    """Write moved vertices, the first level and the second level of a frame.

    The arrays are those of `Surroundings`, `Rings` and `FrameBuffers`; `vertex_geomorph`, shape
    (V,), and `middles`, shape (E, 3), are scratch.
    """
    edges = split_once[: counts[ONCE]]
    geomorph_vertices(around, edges, once, vertex_geomorph)
    rings = own, ring, near, starts, others
    place_vertices(0, len(points), points, normals, *rings, vertex_geomorph, rows)
    of_edges = splits, first_points, once
    place_middles(0, len(edges), points, normals, around, edges, *of_edges, middles, rows)
    edges = split_twice[: counts[TWICE]]
    place_quarters(0, len(edges), points, around, wings, edges, *of_edges, twice, middles, rows)
