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
each edge, in arrays of one column; unless the frame is blended (blend.py) these have no column, and
growth is 1. A mix with growth 0 or 1 returns one of its two sides to the last bit.

Normals of new points are interpolated between their two neighbours on the edge and normalised
(section 4.4, first paragraph).

Positions are handled four numbers at a time (lanes.py). So a row of the output gets its position
first and then, over the fourth number, its normal (half the time on an edge that is split twice).
"""

import numpy as np
import numpy.typing as npt

from .lanes import Four, four, write
from .native import native
from .normals import unit

Floats = npt.NDArray[np.float32]
Unsigned = npt.NDArray[np.uint32]

NEAR = 8
"""Neighbours that every vertex has in its table (rings.py)."""
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
ALL_GROWN = np.zeros((0, 0), dtype=np.float32)
"""Growth of edges where nothing is blended."""


@native
def mix(from_: Four, to: Four, growth: np.float32) -> Four:
    """One side at growth 0, the other at growth 1, to the last bit."""
    return (ONE - growth) * from_ + growth * to


@native
def growth_of(e: int | np.uint32, growth: Floats) -> np.float32:
    """How far a point of an edge has grown; without columns the compiler knows that it is 1."""
    return growth[e, 0] if growth.shape[1] else ONE


@native
def grown(from_: Four, to: Four, e: int | np.uint32, growth: Floats) -> Four:
    """Mix as far as a point of an edge has grown."""
    return mix(from_, to, growth[e, 0]) if growth.shape[1] else to


@native
def write_normal(
    vertices: Floats, row: int | np.uint32, x: np.float32, y: np.float32, z: np.float32
) -> None:
    """Write a normal, after its position."""
    vertices[row, 3], vertices[row, 4], vertices[row, 5] = x, y, z


@native
def grow_vertices(
    edge_points: Unsigned,
    growth_once: Floats,
    split_once: Unsigned,
    once_count: int,
    vertex_growth: Floats,
) -> None:
    """A vertex moves as much as the most grown edge at it: 0 where none is split."""
    for v in range(vertex_growth.shape[0]):
        vertex_growth[v] = ZERO
    for k in range(once_count):
        e = split_once[k]
        a, b, growth = edge_points[e, 0], edge_points[e, 1], growth_of(e, growth_once)
        if growth == ONE:  # there is no more: nothing has to be read, and nothing waits for it
            vertex_growth[a] = vertex_growth[b] = ONE
        else:
            vertex_growth[a] = max(vertex_growth[a], growth)
            vertex_growth[b] = max(vertex_growth[b], growth)


@native
def place_vertices(
    points: Floats,
    normals: Floats,
    vertex_growth: Floats,
    own: Floats,
    ring: Floats,
    near: Unsigned,
    starts: Unsigned,
    others: Unsigned,
    vertices: Floats,
) -> None:
    """Write the original vertices, those at split edges moved by the vertex rule (Fig. 3)."""
    for v in range(points.shape[0]):
        point = four(points, v)
        if vertex_growth[v] > ZERO:
            total = four(points, near[v, 0])
            for k in range(1, NEAR):
                total = total + four(points, near[v, k])
            for k in range(starts[v], starts[v + 1]):
                total = total + four(points, others[k])
            point = mix(point, own[v] * point + ring[v] * total, vertex_growth[v])
        write(vertices, v, point)
        write_normal(vertices, v, normals[v, 0], normals[v, 1], normals[v, 2])


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
        ends = four(points, a) + four(points, b)
        if is_interior[e]:
            middle = EDGE_END * ends + EDGE_WING * (four(points, c) + four(points, d))
        else:
            middle = BORDER_EDGE_END * ends
        write(middles, e, middle)
        if growth_of(e, growth_once) < ONE:
            straight = HALF * (four(vertices, a) + four(vertices, b))
            middle = grown(straight, middle, e, growth_once)
        write(vertices, row, middle)
        x, y, z = unit(
            normals[a, 0] + normals[b, 0],
            normals[a, 1] + normals[b, 1],
            normals[a, 2] + normals[b, 2],
        )
        write_normal(vertices, row, x, y, z)


@native
def wing(
    straight: Four,
    e: np.uint32,
    splits: npt.NDArray[np.uint8],
    growth_once: Floats,
    middles: Floats,
) -> Four:
    """The first-level point of a neighbour edge, its middle where it has none."""
    middle = four(middles, e)
    is_split = splits[e] > 0
    if growth_once.shape[1]:
        return mix(straight, middle, growth_once[e, 0] * np.float32(is_split))  # no branch
    return middle if is_split else straight


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
        near_a = first_points[e]
        centre, near_b = np.uint32(near_a + 1), np.uint32(near_a + 2)
        a, b = edge_points[e, 0], edge_points[e, 1]
        m, moved_a, moved_b = four(middles, e), four(vertices, a), four(vertices, b)
        ends_a, ends_b = moved_a + m, moved_b + m
        if is_interior[e]:
            at_a, at_b = four(points, a), four(points, b)
            at_c, at_d = four(points, edge_points[e, 2]), four(points, edge_points[e, 3])
            wing_p, wing_q = edge_wings[e, 0], edge_wings[e, 1]
            wing_r, wing_s = edge_wings[e, 2], edge_wings[e, 3]
            p = wing(HALF * (at_a + at_c), wing_p, splits, growth_once, middles)
            q = wing(HALF * (at_b + at_c), wing_q, splits, growth_once, middles)
            r = wing(HALF * (at_a + at_d), wing_r, splits, growth_once, middles)
            s = wing(HALF * (at_b + at_d), wing_s, splits, growth_once, middles)
            wings_a, wings_b = p + r, q + s
            ring = (moved_a + moved_b) + (wings_a + wings_b)
            beside_a = EDGE_END * ends_a + EDGE_WING * wings_a
            beside_b = EDGE_END * ends_b + EDGE_WING * wings_b
            middle = MIDDLE_OWN * m + MIDDLE_RING * ring
        else:
            beside_a, beside_b = BORDER_EDGE_END * ends_a, BORDER_EDGE_END * ends_b
            middle = BORDER_MIDDLE_OWN * m + BORDER_MIDDLE_RING * (moved_a + moved_b)
        x, y, z = vertices[centre, 3], vertices[centre, 4], vertices[centre, 5]
        write(vertices, near_a, grown(HALF * ends_a, beside_a, e, growth_twice))
        write(vertices, centre, grown(m, middle, e, growth_twice))
        write(vertices, near_b, grown(HALF * ends_b, beside_b, e, growth_twice))
        x_a, y_a, z_a = unit(vertices[a, 3] + x, vertices[a, 4] + y, vertices[a, 5] + z)
        x_b, y_b, z_b = unit(vertices[b, 3] + x, vertices[b, 4] + y, vertices[b, 5] + z)
        write_normal(vertices, near_a, x_a, y_a, z_a)
        write_normal(vertices, centre, x, y, z)
        write_normal(vertices, near_b, x_b, y_b, z_b)


@native
def place_points(
    points: Floats,
    normals: Floats,
    edge_points: Unsigned,
    edge_wings: Unsigned,
    is_interior: npt.NDArray[np.bool_],
    own: Floats,
    ring: Floats,
    near: Unsigned,
    starts: Unsigned,
    others: Unsigned,
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
    place_vertices(
        points, normals, vertex_growth, own, ring, near, starts, others, vertices
    )  # fmt: skip
    place_middles(
        points, normals, edge_points, is_interior, splits, growth_once, first_points, split_once,
        once_count, middles, vertices,
    )  # fmt: skip
    place_quarters(
        points, edge_points, edge_wings, is_interior, splits, growth_once, growth_twice,
        first_points, split_twice, twice_count, middles, vertices,
    )  # fmt: skip
