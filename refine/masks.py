r"""The paper's smoothing: weights of the rules for vertices and for new points on split edges.

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
rings.py.

The paper leaves open, and we decide: m, p, q, r, s enter the second level as the first level left
them, so that the order of edges cannot matter.

*Growth* is how much of its way from the straight edge a point has gone: 0 to 1, for each level of
each edge, and 1 always unless the frame is blended (blend.py). A mix with growth 0 or 1 returns one
of its two sides to the last bit, so the same code serves both.

Normals of new points are interpolated between their two neighbours on the edge and normalised
(section 4.4, first paragraph). Whole passes and not one function per point: numba pays for every
array argument of a call, and a call per element made such loops five times slower (measured).
"""

import numpy as np
import numpy.typing as npt

from .kernels import kernel
from .native import native

Floats = npt.NDArray[np.float32]
Unsigned = npt.NDArray[np.uint32]

EDGE_END = np.float32(3 / 8)
"""First and second level, interior: end points of the edge or half-edge (Fig. 3, Fig. 4 left)."""
EDGE_WING = np.float32(1 / 8)
"""First and second level, interior: the two points beside it (Fig. 3, Fig. 4 left)."""
BORDER_EDGE_END = np.float32(1 / 2)
"""Border edge: end points (Fig. 3, bottom left)."""
BORDER_MIDDLE_OWN = np.float32(3 / 4)
"""Middle point of a border edge split twice: the rule of a vertex on a border (Fig. 3)."""
BORDER_MIDDLE_RING = np.float32(1 / 8)
"""The moved ends of this edge."""
MIDDLE_OWN = np.float32(5 / 8)
"""Middle point of an interior edge split twice: valence six, 1 - 6/16 (Fig. 4 right)."""
MIDDLE_RING = np.float32(1 / 16)
"""Its six neighbours, 3/(8 x 6) (Fig. 4 right)."""

ZERO = np.float32(0.0)
HALF = np.float32(0.5)
ONE = np.float32(1.0)
TINY = np.finfo(np.float32).tiny
"""Squared length below which a vector is left as it is instead of being normalised."""


@kernel
def unit(x: np.float32, y: np.float32, z: np.float32) -> tuple[np.float32, np.float32, np.float32]:
    """Normalise a vector; zero stays zero."""
    scale = ONE / np.sqrt(max(x * x + y * y + z * z, TINY))
    return x * scale, y * scale, z * scale


@kernel
def mix(from_: np.float32, to: np.float32, growth: np.float32) -> np.float32:
    """One side at growth 0, the other at growth 1, to the last bit."""
    return (ONE - growth) * from_ + growth * to


@native
def grow_vertices(
    edge_points: Unsigned,
    growth_once: Floats,
    split_once: Unsigned,
    once_count: int,
    vertex_growth: Floats,
) -> None:
    """A vertex moves as much as the most grown edge at it: 0 where none is split."""
    vertex_growth[:] = ZERO
    for k in range(once_count):
        e = split_once[k]
        a, b, growth = edge_points[e, 0], edge_points[e, 1], growth_once[e]
        vertex_growth[a] = max(vertex_growth[a], growth)
        vertex_growth[b] = max(vertex_growth[b], growth)


@native
def place_vertices(
    points: Floats,
    normals: Floats,
    vertex_growth: Floats,
    own: Floats,
    ring: Floats,
    ring_starts: Unsigned,
    ring_vertices: Unsigned,
    vertices: Floats,
) -> None:
    """Write the original vertices, those at split edges moved by the vertex rule (Fig. 3)."""
    for v in range(points.shape[0]):
        x = points[v, 0]
        y = points[v, 1]
        z = points[v, 2]
        if vertex_growth[v] > ZERO:
            sum_x = sum_y = sum_z = ZERO
            for k in range(ring_starts[v], ring_starts[v + 1]):
                neighbour = ring_vertices[k]
                sum_x += points[neighbour, 0]
                sum_y += points[neighbour, 1]
                sum_z += points[neighbour, 2]
            x = mix(x, own[v] * x + ring[v] * sum_x, vertex_growth[v])
            y = mix(y, own[v] * y + ring[v] * sum_y, vertex_growth[v])
            z = mix(z, own[v] * z + ring[v] * sum_z, vertex_growth[v])
        vertices[v, 0], vertices[v, 1], vertices[v, 2] = x, y, z
        vertices[v, 3], vertices[v, 4], vertices[v, 5] = normals[v, 0], normals[v, 1], normals[v, 2]


@native
def place_middles(
    points: Floats,
    normals: Floats,
    edge_points: Unsigned,
    is_interior: npt.NDArray[np.bool_],
    splits: npt.NDArray[np.uint8],
    growth_once: Floats,
    first_points: Unsigned,
    split_once: Unsigned,
    once_count: int,
    middles: Floats,
    vertices: Floats,
) -> None:
    """Write the first-level point of every split edge (Fig. 3), and keep it in `middles`."""
    for k in range(once_count):
        e = split_once[k]
        a, b, c, d = edge_points[e, 0], edge_points[e, 1], edge_points[e, 2], edge_points[e, 3]
        row = np.uint32(first_points[e] + (splits[e] >> 1))
        end, wing = (EDGE_END, EDGE_WING) if is_interior[e] else (BORDER_EDGE_END, ZERO)
        growth = growth_once[e]
        for i in range(3):
            ends = points[a, i] + points[b, i]
            wings = points[c, i] + points[d, i]
            middle = end * ends + wing * wings
            middles[e, i] = vertices[row, i] = middle
        if growth < ONE:
            for i in range(3):
                straight = HALF * (vertices[a, i] + vertices[b, i])
                vertices[row, i] = mix(straight, middles[e, i], growth)
        vertices[row, 3], vertices[row, 4], vertices[row, 5] = unit(
            normals[a, 0] + normals[b, 0],
            normals[a, 1] + normals[b, 1],
            normals[a, 2] + normals[b, 2],
        )


@native
def place_quarter_normals(vertices: Floats, a: int, b: int, near_a: int) -> None:
    """Write the normals of both quarter points of an edge from a to b; the middle has its own."""
    centre, near_b = np.uint32(near_a + 1), np.uint32(near_a + 2)
    x, y, z = vertices[centre, 3], vertices[centre, 4], vertices[centre, 5]
    vertices[near_a, 3], vertices[near_a, 4], vertices[near_a, 5] = unit(
        vertices[a, 3] + x, vertices[a, 4] + y, vertices[a, 5] + z
    )
    vertices[near_b, 3], vertices[near_b, 4], vertices[near_b, 5] = unit(
        vertices[b, 3] + x, vertices[b, 4] + y, vertices[b, 5] + z
    )


@native
def grown(e: np.uint32, splits: npt.NDArray[np.uint8], growth_once: Floats) -> np.float32:
    """How far the middle of an edge has grown, 0 where it has none."""
    return np.float32(growth_once[e] if splits[e] > 0 else ZERO)


@native
def place_quarters(
    points: Floats,
    edge_points: Unsigned,
    edge_wings: Unsigned,
    is_interior: npt.NDArray[np.bool_],
    splits: npt.NDArray[np.uint8],
    growth_once: Floats,
    growth_twice: Floats,
    first_points: Unsigned,
    split_twice: Unsigned,
    twice_count: int,
    middles: Floats,
    vertices: Floats,
) -> None:
    """Write the quarter points of every edge that is split twice, and move its middle (Fig. 4)."""
    for k in range(twice_count):
        e = split_twice[k]
        a, b, c, d = edge_points[e, 0], edge_points[e, 1], edge_points[e, 2], edge_points[e, 3]
        near_a = first_points[e]
        centre, near_b = np.uint32(near_a + 1), np.uint32(near_a + 2)
        growth = growth_twice[e]
        if is_interior[e]:
            wing_p, wing_q = edge_wings[e, 0], edge_wings[e, 1]
            wing_r, wing_s = edge_wings[e, 2], edge_wings[e, 3]
            grown_p = grown(wing_p, splits, growth_once)
            grown_q = grown(wing_q, splits, growth_once)
            grown_r = grown(wing_r, splits, growth_once)
            grown_s = grown(wing_s, splits, growth_once)
            if min(growth, grown_p, grown_q, grown_r, grown_s) == ONE:
                # All of it has grown: the same without mixing, in half the time.
                for i in range(3):
                    m, moved_a, moved_b = middles[e, i], vertices[a, i], vertices[b, i]
                    wings_a = middles[wing_p, i] + middles[wing_r, i]
                    wings_b = middles[wing_q, i] + middles[wing_s, i]
                    ring = (moved_a + moved_b) + (wings_a + wings_b)
                    vertices[near_a, i] = EDGE_END * (moved_a + m) + EDGE_WING * wings_a
                    vertices[centre, i] = MIDDLE_OWN * m + MIDDLE_RING * ring
                    vertices[near_b, i] = EDGE_END * (moved_b + m) + EDGE_WING * wings_b
            else:
                for i in range(3):
                    at_a, at_b = points[a, i], points[b, i]
                    at_c, at_d = points[c, i], points[d, i]
                    p = mix(HALF * (at_a + at_c), middles[wing_p, i], grown_p)
                    q = mix(HALF * (at_b + at_c), middles[wing_q, i], grown_q)
                    r = mix(HALF * (at_a + at_d), middles[wing_r, i], grown_r)
                    s = mix(HALF * (at_b + at_d), middles[wing_s, i], grown_s)
                    m, moved_a, moved_b = middles[e, i], vertices[a, i], vertices[b, i]
                    ring = (moved_a + moved_b) + ((p + r) + (q + s))
                    beside_a = EDGE_END * (moved_a + m) + EDGE_WING * (p + r)
                    beside_b = EDGE_END * (moved_b + m) + EDGE_WING * (q + s)
                    vertices[near_a, i] = mix(HALF * (moved_a + m), beside_a, growth)
                    vertices[centre, i] = mix(m, MIDDLE_OWN * m + MIDDLE_RING * ring, growth)
                    vertices[near_b, i] = mix(HALF * (moved_b + m), beside_b, growth)
        else:
            for i in range(3):
                m, moved_a, moved_b = middles[e, i], vertices[a, i], vertices[b, i]
                moved = BORDER_MIDDLE_OWN * m + BORDER_MIDDLE_RING * (moved_a + moved_b)
                vertices[near_a, i] = BORDER_EDGE_END * (moved_a + m)
                vertices[centre, i] = mix(m, moved, growth)
                vertices[near_b, i] = BORDER_EDGE_END * (moved_b + m)
        place_quarter_normals(vertices, a, b, near_a)


@native
def place_points(
    points: Floats,
    normals: Floats,
    edge_points: Unsigned,
    edge_wings: Unsigned,
    is_interior: npt.NDArray[np.bool_],
    own: Floats,
    ring: Floats,
    ring_starts: Unsigned,
    ring_vertices: Unsigned,
    splits: npt.NDArray[np.uint8],
    growth_once: Floats,
    growth_twice: Floats,
    first_points: Unsigned,
    split_once: Unsigned,
    split_twice: Unsigned,
    counts: npt.NDArray[np.int64],
    vertex_growth: Floats,
    middles: Floats,
    vertices: Floats,
) -> None:
    """Write moved vertices, first level, second level: all passes in one call of compiled code.

    `counts`: of edges split once and twice at 1 and 2 (schemes.Frame).
    """
    once_count, twice_count = counts[1], counts[2]
    grow_vertices(edge_points, growth_once, split_once, once_count, vertex_growth)
    place_vertices(points, normals, vertex_growth, own, ring, ring_starts, ring_vertices, vertices)
    place_middles(
        points, normals, edge_points, is_interior, splits, growth_once, first_points, split_once,
        once_count, middles, vertices,
    )  # fmt: skip
    place_quarters(
        points, edge_points, edge_wings, is_interior, splits, growth_once, growth_twice,
        first_points, split_twice, twice_count, middles, vertices,
    )  # fmt: skip


ROWS = 18
"""Place of the output, which may be another in every frame, among the arguments of that."""
