"""Rows of the output: numbering of new points, texture seams, and the subtriangles.

Kähler, Haber, Seidel 2003, section 4.3. The output begins with one row per wedge, so that vertex v
of the input is row v. The points of a rim follow in a block, in the direction of its edge: the
middle point, or quarter, middle, quarter. Points in the middle of triangles, which only blending
has (blend.py), come last.

A row is x y z, nx ny nz[, attributes]. Attributes (texture coordinates, colours) of new points are
interpolated linearly along their edge, with the values of their own side of a seam (section 4.4,
first paragraph).

Everything here goes from the edges that are split, not from the triangles: most are not.
"""

import numpy as np
import numpy.typing as npt

from .kernels import kernel
from .lanes import counted_from, four, is_zero, twelve, write
from .native import native

Floats = npt.NDArray[np.float32]
Unsigned = npt.NDArray[np.uint32]
Short = npt.NDArray[np.uint16]
Small = npt.NDArray[np.uint8]

GEOMETRY_COLUMNS = 6
"""x y z, nx ny nz: columns of a row before attributes."""
CENTRE = 12
"""Number of the point in the middle of a triangle (patterns.py)."""
NO_ROOM = -1
"""What `overflow` returns when it is asked to stop; the other calls of a frame return 0 or more."""
QUARTER = np.float32(0.25)
HALF = np.float32(0.5)
THREE_QUARTERS = np.float32(0.75)
SIDE_BITS, SIDE_MASK = np.uint32(2), np.uint32(3)
"""A side of an edge is 4 x triangle + the number of the edge in it (connectivity.py)."""
AT_ONCE = 4
"""Triangles, or edges, that are passed over in one go where none of them is split."""
PLACE_VALUES = np.array([1, 3, 9], dtype=np.uint16)
"""Of the splits of a triangle's three edges in the number of its configuration."""


@kernel
def points_on(split: int) -> int:
    """New points on an edge that was split 0, 1 or 2 times: 0, 1 or 3."""
    return split + (split >> 1)


@native
def listed(e: np.uint64, rim_splits: Small, split_once: Unsigned, count: np.uint32) -> np.uint32:
    """Write an edge behind the `count` in the list; return their number, one more if it is split.

    Written always and counted when split: no branch that a processor could guess wrong.
    """
    split_once[count] = e
    return np.uint32(count + (rim_splits[e] > 0))


@native
def number_points(
    rim_splits: Small,
    rim_edges: Unsigned,
    edge_sides: Unsigned,
    more_sides: Unsigned,
    wedge_count: int,
    first_points: Unsigned,
    split_once: Unsigned,
    split_twice: Unsigned,
    configurations: Short,
    counts: npt.NDArray[np.int64],
) -> None:
    """List the split edges, give new points their rows, and triangles their configuration.

    `split_once` gets every split edge, `split_twice` those split twice. The entries of
    `first_points` for edges that are not split have no meaning. `configurations` has one entry
    more than triangles, for the sides that border edges do not have. `counts` gets the numbers of
    rows, of split edges, of edges split twice, and of subtriangles.
    """
    edge_count = edge_sides.shape[0]
    once_count = twice_count = np.uint32(0)
    beyond = edge_count - edge_count % AT_ONCE
    for first in range(0, beyond, AT_ONCE):
        if not is_zero(four(rim_splits, np.uint64(first))):
            for i in range(AT_ONCE):
                once_count = listed(np.uint64(first + i), rim_splits, split_once, once_count)
    for e in range(beyond, edge_count):
        once_count = listed(np.uint64(e), rim_splits, split_once, once_count)
    configurations[:] = 0
    none = np.uint32(4 * (configurations.shape[0] - 1))
    row, triangle_count = wedge_count, configurations.shape[0] - 1
    for k in range(once_count):
        e = split_once[k]
        split = rim_splits[e]
        split_twice[twice_count] = e
        twice_count = np.uint32(twice_count + (split > 1))
        points = points_on(split)
        first_points[e] = row
        row += points
        for i in range(2):
            side = edge_sides[e, i]
            configurations[side >> SIDE_BITS] += split * PLACE_VALUES[side & SIDE_MASK]
            triangle_count += points * (side < none)
    for k in range(more_sides.shape[0]):
        split, side = rim_splits[more_sides[k, 0]], more_sides[k, 1]
        configurations[side >> SIDE_BITS] += split * PLACE_VALUES[side & SIDE_MASK]
        triangle_count += points_on(split)
    for r in range(edge_count, len(rim_edges)):
        rim_splits[r] = rim_splits[rim_edges[r]]
        first_points[r] = row
        row += points_on(rim_splits[r])
    counts[0], counts[1], counts[2], counts[3] = row, once_count, twice_count, triangle_count


@native
def place_unmoved(points: Floats, normals: Floats, vertices: Floats) -> None:
    """Write vertices as they are; `points` have room (lanes.py)."""
    for v in range(points.shape[0]):
        write(vertices, v, four(points, v))
        for i in range(3):
            vertices[v, 3 + i] = normals[v, i]


@native
def copy_wedges(vertex_count: int, wedge_vertices: Unsigned, vertices: Floats) -> None:
    """Copy position and normal of vertices on texture seams to their other sides."""
    for w in range(vertex_count, len(wedge_vertices)):
        for i in range(GEOMETRY_COLUMNS):
            vertices[w, i] = vertices[wedge_vertices[w], i]


@native
def copy_rims(
    edge_count: int,
    rim_edges: Unsigned,
    rim_splits: Small,
    first_points: Unsigned,
    vertices: Floats,
) -> None:
    """Copy position and normal of new points on texture seams to their other sides."""
    for r in range(edge_count, len(rim_edges)):
        for point in range(points_on(rim_splits[r])):
            original = first_points[rim_edges[r]] + point
            copy = first_points[r] + point
            for i in range(GEOMETRY_COLUMNS):
                vertices[copy, i] = vertices[original, i]


@native
def place_attributes(
    values: Floats,
    wedge_values: npt.NDArray[np.int32],
    rim_values: npt.NDArray[np.int32],
    rim_splits: Small,
    first_points: Unsigned,
    vertices: Floats,
) -> None:
    """Write attributes: of wedges as given, of new points linearly along their rim.

    `values`: shape (A, k); `wedge_values`, shape (W,), and `rim_values`, shape (R, 2), say which
    row of it a wedge and the two ends of a rim have; -1 is zero.
    """
    columns = values.shape[1]
    for w in range(wedge_values.shape[0]):
        k = wedge_values[w]
        for i in range(columns):
            vertices[w, GEOMETRY_COLUMNS + i] = values[k, i] if k >= 0 else np.float32(0.0)
    for r in range(rim_values.shape[0]):
        split, row = rim_splits[r], first_points[r]
        if split == 0:
            continue
        a, b = rim_values[r, 0], rim_values[r, 1]
        for i in range(columns):
            at_a, at_b, column = values[a, i], values[b, i], GEOMETRY_COLUMNS + i
            vertices[row + (split >> 1), column] = HALF * (at_a + at_b)
            if split == 2:
                vertices[row, column] = THREE_QUARTERS * at_a + QUARTER * at_b
                vertices[row + 2, column] = QUARTER * at_a + THREE_QUARTERS * at_b


@native
def look_up_triangles(
    corners: Unsigned,
    triangle_rims: Unsigned,
    rim_splits: Small,
    first_points: Unsigned,
    counts: npt.NDArray[np.int64],
    rows: Short,
    subtriangle_counts: Small,
    subtriangles: Small,
    points: Unsigned,
    triangles: Unsigned,
    source: npt.NDArray[np.int32],
) -> None:
    """Write the subtriangles of every triangle by its table row (section 4.3).

    A rim keeps its points in the direction of the edge; a triangle that runs against it reads the
    quarter points in reverse. Centres are numbered in the order of the triangles that have one.
    `counts`: the row of the first of them at 0 (schemes.Frame); `points`: scratch, shape (13,).
    """
    points[CENTRE] = counts[0]
    one, two = np.uint32(1), np.uint32(2)  # unsigned, or every index is tested for being negative
    next_, at_once, total = np.uint64(1), np.uint64(AT_ONCE), np.uint64(corners.shape[0])
    count = np.uint32(0)
    t = np.uint64(0)
    while t < total:
        # Most triangles are not split: hand them through, and four in one go where it can be.
        if t + at_once <= total and is_zero(four(rows, t)):
            write(triangles, count, twelve(corners, t))
            write(source, count, counted_from(t))
            count = np.uint32(count + np.uint32(AT_ONCE))
            t += at_once
            continue
        row = rows[t]
        if row == 0:
            for i in range(3):
                triangles[count, i] = corners[t, i]
            source[count] = t
            count = np.uint32(count + one)
            t += next_
            continue
        # The 12 numbered points; those of edges that are not split are never looked up.
        for i in range(3):
            rim, against = triangle_rims[t, i] >> one, triangle_rims[t, i] & one
            first = first_points[rim]
            points[i] = corners[t, i]
            points[3 + 3 * i] = first + (rim_splits[rim] >> 1)  # the only point, or the second
            points[4 + 3 * i] = first + two * against
            points[5 + 3 * i] = first + two - two * against
        for k in range(subtriangle_counts[row]):
            for i in range(3):
                triangles[count, i] = points[subtriangles[row, k, i]]
            source[count] = t
            count = np.uint32(count + one)
        points[CENTRE] += subtriangles[row, 0, 0] == CENTRE
        t += next_


@native
def overflow(counts: npt.NDArray[np.int64], room: npt.NDArray[np.int64]) -> int:
    """Return NO_ROOM if a frame is larger than what it may write to, else 0.

    `counts`: see schemes.Frame; `room`: for rows and for subtriangles, shape (2,).
    """
    return NO_ROOM if counts[0] + counts[4] > room[0] or counts[3] > room[1] else 0
