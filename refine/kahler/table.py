r"""The look-up table: subtriangles for each of the 27 split configurations of a triangle.

Kähler, Haber, Seidel 2003, section 4.3 with Figs. 5 and 6. Edge i joins the corners i and i + 1 and
has been split s_i = 0, 1 or 2 times; the entry is number s_0 + 3 s_1 + 9 s_2. The paper shows the
numbering of points only in a figure. Ours is: the corners, then for each edge its middle point, and
its quarter points near the start and near the end of the edge.

                     2                         edge        0    1    2
                    / \                        middle      3    6    9
                 10     8                      near start  4    7   10
                  /       \                    near end    5    8   11
                 9         6
                /           \                  10 is near corner 2 and 11 near corner 0, because
              11             7                 edge 2 runs from corner 2 to corner 0.
              /               \
             0---4----3----5---1

Each entry is found by ear clipping of the polygon of its points in an equilateral triangle: the ear
with the shortest diagonal first. This cuts off split corners as Loop subdivision does, ends with
its central triangle where all edges are split, and never puts three points of one edge into one
subtriangle. Up to rotation there are eleven patterns. Titles are s_0 s_1 s_2 and the number of
subtriangles; dots are lines at other angles:

          000: 1              100: 2              200: 4              110: 3
            *                   *                   *                   *
           / \                 /|\                 /|\                 /|\
          /   \               / | \               /.|.\               / | \
         /     \             /  |  \             /. | .\             /  |  \
        /       \           /   |   \           / . | . \           /   |   *
       /         \         /    |    \         /  . | .  \         /    |  / \
      /           \       /     |     \       /  .  |  .  \       /     | /   \
     /             \     /      |      \     /  .   |   .  \     /      |/     \
    *---------------*   *-------*-------*   *---*---*---*---*   *-------*-------*

          210: 5              201: 5              220: 7              111: 4
            *                   *                   *                   *
           / \                 / \                 /.\                 / \
          /   \               /   \               /.  *               /   \
         /     \             /     \             /.  / \             /     \
        /      .*           *.      \           / . /  .*           *-------*
       /    .../|\         /|\...    \         /  ./  ./|\         / \     / \
      /  ...../ | \       / | \.....  \       /  ./.../ | *       /   \   /   \
     /... .  /  |  \     /  |  \  . ...\     /  ./.  /  |/ \     /     \ /     \
    *---*---*---*---*   *---*---*---*---*   *---*---*---*---*   *-------*-------*

          211: 6              221: 8             222: 10
            *                   *                   *
           / \                 / \                 / \
          /   \               /  .*               *---*
         /     \             /...  \             /...  \
        *-------*           *-------*           *-------*
       /|\     /|\         /|\     /|\         / \     /|\
      / | \   / | \       / | \   / | *       *.  \   / | *
     /  |  \ /  |  \     /  |  \ /  |/ \     / \...\ /  |/ \
    *---*---*---*---*   *---*---*---*---*   *---*---*---*---*

The other sixteen configurations are rotations of these. Among equal cuts the cut at the near-start
point is taken in every corner, so the table does not depend on the first corner of a triangle. The
table is built at import, in a few milliseconds, and every entry is verified: its subtriangles have
positive area, cover the triangle exactly, use every point, and share inner edges in pairs.
"""

from typing import NamedTuple

import numpy as np

from ...geometry.arrays import Integers64, Unsigned8

CENTRE_POINT = 12
"""Number of a centre of a triangle, which none of the paper's patterns has."""
CONFIGURATION_COUNT = 27
"""Configurations of three edges that are split 0, 1 or 2 times."""
MOST_SPLITS = 2
"""An edge is split at most twice (section 4)."""
POINTS_OF_EDGE = (0, 1, 3)
"""New points on an edge split 0, 1 or 2 times."""

Triangle = tuple[int, int, int]


def _point_coordinates() -> Integers64:
    """Barycentric coordinates of the 12 points in quarters, shape (12, 3); rows sum to 4."""
    corners = 4 * np.eye(3, dtype=np.int64)
    points = list(corners)
    for edge in range(3):
        start = corners[edge]
        end = corners[(edge + 1) % 3]
        points.append((start + end) // 2)
        points.append((3 * start + end) // 4)
        points.append((start + 3 * end) // 4)
    return np.array(points)


POINT_COORDINATES = _point_coordinates()
# The same in plain Python, which is faster for few points.
_POINT_PLACES = [tuple(point) for point in POINT_COORDINATES.tolist()]


def splits_of(configuration: int) -> tuple[int, int, int]:
    """Return the splits on the three edges that belong to a table entry."""
    return configuration % 3, configuration // 3 % 3, configuration // 9


def points_on(edge: int) -> tuple[int, int, int]:
    """Return the points on an edge that has been split twice, from start to end."""
    middle = 3 + 3 * edge
    return middle + 1, middle, middle + 2


def outline(splits: tuple[int, int, int]) -> list[int]:
    """Return the points on the border of a triangle in order, beginning with corner 0."""
    points: list[int] = []
    for edge in range(3):
        near_start, middle, near_end = points_on(edge)
        points.append(edge)
        points += ([], [middle], [near_start, middle, near_end])[splits[edge]]
    return points


def subdivide(splits: tuple[int, int, int]) -> list[Triangle]:
    """Cut a triangle with the given splits into subtriangles of the 12 numbered points.

    A rotation of the splits rotates the result: the first corner of a triangle has no influence.
    """
    rotations = [(splits[k], splits[(k + 1) % 3], splits[(k + 2) % 3]) for k in range(3)]
    turn = max(range(3), key=lambda k: rotations[k])
    return [
        (_rotated_point(a, turn), _rotated_point(b, turn), _rotated_point(c, turn))
        for a, b, c in _cut_ears(outline(rotations[turn]))
    ]


def _rotated_point(point: int, turn: int) -> int:
    """Number of a point after renaming corner 0 to corner `turn`."""
    if point < 3:
        return (point + turn) % 3
    return 3 + (point - 3 + 3 * turn) % 9


def _cut_ears(polygon: list[int]) -> list[Triangle]:
    triangles: list[Triangle] = []
    while len(polygon) > 3:
        ears = [(polygon[k - 1], polygon[k]) for k in range(len(polygon))]
        following = polygon[1:] + polygon[:1]
        candidates = [
            (_squared_distance(before, after), _is_near_end(tip), (before, tip, after))
            for (before, tip), after in zip(ears, following, strict=True)
            if _area((before, tip, after)) > 0 and not _on_one_edge(polygon, without=tip)
        ]
        _, _, ear = min(candidates, key=lambda candidate: candidate[:2])
        triangles.append(ear)
        polygon = [point for point in polygon if point != ear[1]]
    return [*triangles, (polygon[0], polygon[1], polygon[2])]


def _is_near_end(point: int) -> bool:
    """Break ties: of two equal cuts take the cut at a near-start point, in all corners."""
    return point > 2 and point % 3 == 2


def _on_one_edge(polygon: list[int], *, without: int) -> bool:
    """Return whether all points of a polygon but one lie on the same edge of the triangle."""
    left = [_POINT_PLACES[point] for point in polygon if point != without]
    return any(all(place[k] == 0 for place in left) for k in range(3))


def _area(triangle: Triangle) -> int:
    """Signed area in sixteenths of the whole triangle."""
    (a, b, c), (d, e, f), (g, h, i) = (_POINT_PLACES[point] for point in triangle)
    return int(a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)) // 4


def _squared_distance(first: int, second: int) -> int:
    """Squared distance in an equilateral triangle of side 4."""
    u, v, w = (p - q for p, q in zip(_POINT_PLACES[first], _POINT_PLACES[second], strict=True))
    return int(-(u * v + v * w + w * u))


def verify(splits: tuple[int, int, int], triangles: list[Triangle]) -> None:
    """Raise AssertionError unless the subtriangles are a proper triangulation of the outline."""
    points = outline(splits)
    count = 1 + sum(POINTS_OF_EDGE[s] for s in splits)
    assert len(triangles) == count, f"{splits}: {len(triangles)} subtriangles, not {count}"
    areas = [_area(triangle) for triangle in triangles]
    assert min(areas) > 0, f"{splits}: a subtriangle without positive area"
    assert sum(areas) == 16, f"{splits}: the subtriangles do not cover the triangle"
    assert {p for t in triangles for p in t} == set(points), f"{splits}: a point is not used"
    half_edges = [(t[k], t[(k + 1) % 3]) for t in triangles for k in range(3)]
    assert len(set(half_edges)) == len(half_edges), f"{splits}: a half-edge is used twice"
    on_border = {h for h in half_edges if (h[1], h[0]) not in half_edges}
    assert on_border == set(zip(points, points[1:] + points[:1], strict=True)), (
        f"{splits}: the border is not made of the sub-edges that the neighbours have"
    )


class Patterns(NamedTuple):
    """A table of subtriangles; row 0 is the triangle as it is.

    The paper looks up the row s_0 + 3 s_1 + 9 s_2 (section 4.3).
    """

    counts: Unsigned8
    """Subtriangles of each row, shape (K,)."""
    subtriangles: Unsigned8
    """Points of the subtriangles, numbered as above, shape (K, most, 3); unused ones are 0."""


def table_of(rows: list[list[Triangle]]) -> Patterns:
    """Return the rows as read-only arrays."""
    counts = np.array([len(triangles) for triangles in rows], dtype=np.uint8)
    subtriangles = np.zeros((len(rows), counts.max(), 3), dtype=np.uint8)
    for row, triangles in enumerate(rows):
        subtriangles[row, : len(triangles)] = triangles
    for array in (counts, subtriangles):
        array.flags.writeable = False
    return Patterns(counts, subtriangles)


def _build_table() -> Patterns:
    rows = []
    for configuration in range(CONFIGURATION_COUNT):
        splits = splits_of(configuration)
        rows.append(subdivide(splits))
        verify(splits, rows[-1])
    return table_of(rows)


CONFIGURATION_TABLE = _build_table()
"""The paper's 27 patterns."""
