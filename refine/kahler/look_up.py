"""Numbering of new points, and look-up of subtriangles.

Kähler, Haber, Seidel 2003, section 4.3. The output begins with one row per wedge, so that vertex v
of the input is row v. The points of an attribute edge follow in a block, in the direction of its
edge: the middle point, or quarter, middle, quarter. Points in the middle of triangles come last;
only blending has them (beyond/blending.py).

Attributes (texture coordinates, colours) of new points are interpolated linearly along their edge,
separately on each side of a seam (section 4.4, first paragraph).

Loops run over split edges instead of triangles where possible, because most triangles are not
split.
"""

import numpy as np

from ...geometry.arrays import Floats32, Integers32, Integers64, Unsigned8, Unsigned16, Unsigned32
from ...geometry.vectors import HALF, QUARTER, ROW_WIDTH, THREE_QUARTERS, row_of, write_row
from ...jit import njit
from ..border.rows import GEOMETRY_COLUMNS
from .frame import ROWS, SPLIT_EDGES, TRIANGLES, TWICE_SPLIT_EDGES, FrameBuffers
from .table import CENTRE_POINT

SIDE_BITS = np.uint32(2)
SIDE_MASK = np.uint32(3)
"""A side of an edge is 4 x triangle + the index of the edge in it (connectivity.py)."""
PLACE_VALUES = np.array([1, 3, 9], dtype=np.uint16)
"""Factors of the splits of a triangle's three edges in the number of its configuration."""


@njit
def points_on(split: int) -> int:
    """New points on an edge that was split 0, 1 or 2 times: 0, 1 or 3."""
    return int(split + (split >> 1))


@njit
def number_points(
    edge_sides: Unsigned32,
    more_sides: Unsigned32,
    attribute_edges: Unsigned32,
    wedge_count: int,
    splits: Unsigned8,
    first_points: Unsigned32,
    split_once: Unsigned32,
    split_twice: Unsigned32,
    configurations: Unsigned16,
    counts: Integers64,
) -> tuple[int, int, int]:
    """List the split edges, give new points their rows, and triangles their configuration.

    `splits` and all later arguments are arrays of `FrameBuffers`. `split_once` receives every split
    edge, and `split_twice` the edges split twice. The entries of `first_points` for edges without a
    split have no meaning. `counts` receives all counts except the number of centres. Returns the
    numbers of output rows and triangles, and the most splits of an edge.
    """
    edge_count = edge_sides.shape[0]
    face_count = configurations.shape[0] - 1
    once_count = twice_count = most = 0
    for e in range(edge_count):
        # The edge is always written, but counted only if it is split: this avoids a branch that a
        # processor could mispredict.
        split_once[once_count] = e
        once_count += splits[e] > 0
    configurations[:] = 0
    row = wedge_count
    triangle_count = face_count
    for k in range(once_count):
        e = split_once[k]
        split = splits[e]
        split_twice[twice_count] = e
        twice_count += split > 1
        most = max(most, split)
        points = points_on(split)
        first_points[e] = row
        row += points
        for i in range(2):
            t = edge_sides[e, i] >> SIDE_BITS
            place = edge_sides[e, i] & SIDE_MASK
            configurations[t] += split * PLACE_VALUES[place]
            triangle_count += points * (t < face_count)
    for k in range(more_sides.shape[0]):
        split = splits[more_sides[k, 0]]
        side = more_sides[k, 1]
        configurations[side >> SIDE_BITS] += split * PLACE_VALUES[side & SIDE_MASK]
        triangle_count += points_on(split)
    for r in range(edge_count, attribute_edges.shape[0]):
        splits[r] = splits[attribute_edges[r]]
        first_points[r] = row
        row += points_on(splits[r])
    counts[ROWS] = row
    counts[TRIANGLES] = triangle_count
    counts[SPLIT_EDGES] = once_count
    counts[TWICE_SPLIT_EDGES] = twice_count
    return row, triangle_count, int(most)


@njit
def copy_along_attribute_edges(attribute_edges: Unsigned32, frame: FrameBuffers) -> None:
    """Copy position and normal of new points on texture seams to their other sides."""
    for r in range(frame.geomorph_once.shape[0], attribute_edges.shape[0]):
        for point in range(points_on(frame.splits[r])):
            original = frame.first_points[attribute_edges[r]] + point
            copy = frame.first_points[r] + point
            for i in range(GEOMETRY_COLUMNS):
                frame.rows[copy, i] = frame.rows[original, i]


@njit
def place_attributes(attribute_edge_uv: Integers32, frame: FrameBuffers, values: Floats32) -> None:
    """Write attributes of new points, linearly along attribute edges; `values`: shape (A, k)."""
    vertices = frame.rows
    for r in range(attribute_edge_uv.shape[0]):
        split = frame.splits[r]
        row = frame.first_points[r]
        if split == 0:
            continue
        a = attribute_edge_uv[r, 0]
        b = attribute_edge_uv[r, 1]
        for i in range(values.shape[1]):
            at_a = values[a, i]
            at_b = values[b, i]
            column = GEOMETRY_COLUMNS + i
            vertices[row + (split >> 1), column] = HALF * (at_a + at_b)
            if split == 2:
                vertices[row, column] = THREE_QUARTERS * at_a + QUARTER * at_b
                vertices[row + 2, column] = QUARTER * at_a + THREE_QUARTERS * at_b


@njit
def look_up_triangles(
    corners: Unsigned32,
    triangle_attribute_edges: Unsigned32,
    splits: Unsigned8,
    first_points: Unsigned32,
    table_rows: Unsigned16,
    subtriangle_counts: Unsigned8,
    subtriangles: Unsigned8,
    first_centre: int,
    triangles: Unsigned32,
    source: Integers32,
) -> None:
    """Write the subtriangles of every triangle by its row in the table (section 4.3).

    `splits`, `first_points`: arrays of `FrameBuffers`. `subtriangle_counts`, `subtriangles`: arrays
    of `Patterns`. `first_centre`: the row of the first centre of a triangle. `triangles`, `source`:
    arrays of a stream, written.

    An attribute edge keeps its points in the direction of the edge; a triangle that runs against it
    reads the quarter points in reverse. Centres are numbered in the order of the triangles that
    have one.
    """
    assert corners.shape[1] == triangle_attribute_edges.shape[1] == ROW_WIDTH
    assert triangles.shape[1] == subtriangles.shape[2] == ROW_WIDTH
    points = np.zeros(CENTRE_POINT + 1, np.uint32)
    points[CENTRE_POINT] = first_centre
    one = np.uint32(1)
    two = np.uint32(2)
    count = np.uint32(0)
    for t in range(np.uint32(corners.shape[0])):
        row = table_rows[t]
        if row == 0:  # most triangles are not split
            write_row(triangles, count, row_of(corners, t))
            source[count] = t
            count += one
            continue
        # The 12 numbered points; points of edges that are not split are never looked up.
        for i in range(3):
            side = triangle_attribute_edges[t, i]
            edge = side >> one
            against = side & one
            first = first_points[edge]
            points[i] = corners[t, i]
            points[3 + 3 * i] = first + (splits[edge] >> 1)  # the only point, or the second
            points[4 + 3 * i] = first + two * against
            points[5 + 3 * i] = first + two - two * against
        for k in range(subtriangle_counts[row]):
            a, b, c = row_of(subtriangles[row], k)
            write_row(triangles, count, (points[a], points[b], points[c]))
            source[count] = t
            count += one
        points[CENTRE_POINT] += subtriangles[row, 0, 0] == CENTRE_POINT
