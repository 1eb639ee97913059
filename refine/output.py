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

from ..jit import njit
from .connectivity import Connectivity
from .frame import ONCE, ROWS, TRIANGLES, TWICE, Frame
from .patterns import CENTRE, Patterns

Floats = npt.NDArray[np.float32]
Indices = npt.NDArray[np.int32]
Unsigned = npt.NDArray[np.uint32]
Short = npt.NDArray[np.uint16]

GEOMETRY_COLUMNS = 6
"""x y z, nx ny nz: columns of a row before attributes."""
QUARTER = np.float32(0.25)
HALF = np.float32(0.5)
THREE_QUARTERS = np.float32(0.75)
SIDE_BITS, SIDE_MASK = np.uint32(2), np.uint32(3)
"""A side of an edge is 4 x triangle + the number of the edge in it (connectivity.py)."""
PLACE_VALUES = np.array([1, 3, 9], dtype=np.uint16)
"""Of the splits of a triangle's three edges in the number of its configuration."""


@njit
def points_on(split: int) -> int:
    """New points on an edge that was split 0, 1 or 2 times: 0, 1 or 3."""
    return int(split + (split >> 1))


@njit
def number_points(mesh: Connectivity, frame: Frame) -> None:
    """List the split edges, give new points their rows, and triangles their configuration.

    `split_once` gets every split edge, `split_twice` those split twice. The entries of
    `first_points` for edges that are not split have no meaning. `counts` gets all but centres.
    """
    splits, sides = frame.splits, mesh.edge_sides
    edge_count, face_count = sides.shape[0], mesh.faces.shape[0]
    once_count = twice_count = 0
    for e in range(edge_count):
        # Written always and counted when split: no branch that a processor could guess wrong.
        frame.split_once[once_count] = e
        once_count += splits[e] > 0
    frame.configurations[:] = 0
    row, triangle_count = mesh.wedge_vertices.shape[0], face_count
    for k in range(once_count):
        e = frame.split_once[k]
        split = splits[e]
        frame.split_twice[twice_count] = e
        twice_count += split > 1
        points = points_on(split)
        frame.first_points[e] = row
        row += points
        for i in range(2):
            t, place = sides[e, i] >> SIDE_BITS, sides[e, i] & SIDE_MASK
            frame.configurations[t] += split * PLACE_VALUES[place]
            triangle_count += points * (t < face_count)
    for k in range(mesh.more_sides.shape[0]):
        split, side = splits[mesh.more_sides[k, 0]], mesh.more_sides[k, 1]
        frame.configurations[side >> SIDE_BITS] += split * PLACE_VALUES[side & SIDE_MASK]
        triangle_count += points_on(split)
    for r in range(edge_count, mesh.rim_edges.shape[0]):
        splits[r] = splits[mesh.rim_edges[r]]
        frame.first_points[r] = row
        row += points_on(splits[r])
    frame.counts[ROWS], frame.counts[ONCE], frame.counts[TWICE] = row, once_count, twice_count
    frame.counts[TRIANGLES] = triangle_count


@njit
def place_unmoved(points: Floats, normals: Floats, vertices: Floats) -> None:
    """Write vertices as they are."""
    for v in range(points.shape[0]):
        for i in range(3):
            vertices[v, i] = points[v, i]
            vertices[v, 3 + i] = normals[v, i]


@njit
def copy_wedges(mesh: Connectivity, vertices: Floats) -> None:
    """Copy position and normal of vertices on texture seams to their other sides."""
    for w in range(mesh.vertex_count, mesh.wedge_vertices.shape[0]):
        for i in range(GEOMETRY_COLUMNS):
            vertices[w, i] = vertices[mesh.wedge_vertices[w], i]


@njit
def copy_rims(mesh: Connectivity, frame: Frame) -> None:
    """Copy position and normal of new points on texture seams to their other sides."""
    for r in range(mesh.edges.shape[0], mesh.rim_edges.shape[0]):
        for point in range(points_on(frame.splits[r])):
            original = frame.first_points[mesh.rim_edges[r]] + point
            copy = frame.first_points[r] + point
            for i in range(GEOMETRY_COLUMNS):
                frame.rows[copy, i] = frame.rows[original, i]


@njit
def place_wedge_attributes(mesh: Connectivity, values: Floats, vertices: Floats) -> None:
    """Write attributes of wedges as given, 0 where none is.

    `values`: shape (A, k); the mesh says which row of it a wedge has.
    """
    for w in range(mesh.wedge_uv.shape[0]):
        k = mesh.wedge_uv[w]
        for i in range(values.shape[1]):
            vertices[w, GEOMETRY_COLUMNS + i] = values[k, i] if k >= 0 else np.float32(0.0)


@njit
def place_rim_attributes(mesh: Connectivity, frame: Frame, values: Floats) -> None:
    """Write attributes of new points, linearly along their rim; `values`: shape (A, k)."""
    vertices = frame.rows
    for r in range(mesh.rim_uv.shape[0]):
        split, row = frame.splits[r], frame.first_points[r]
        if split == 0:
            continue
        a, b = mesh.rim_uv[r, 0], mesh.rim_uv[r, 1]
        for i in range(values.shape[1]):
            at_a, at_b, column = values[a, i], values[b, i], GEOMETRY_COLUMNS + i
            vertices[row + (split >> 1), column] = HALF * (at_a + at_b)
            if split == 2:
                vertices[row, column] = THREE_QUARTERS * at_a + QUARTER * at_b
                vertices[row + 2, column] = QUARTER * at_a + THREE_QUARTERS * at_b


@njit
def look_up_triangles(
    mesh: Connectivity,
    frame: Frame,
    patterns: Patterns,
    rows: Short,
    triangles: Unsigned,
    source: Indices,
) -> None:
    """Write the subtriangles of every triangle by its row in the table (section 4.3).

    A rim keeps its points in the direction of the edge; a triangle that runs against it reads the
    quarter points in reverse. Centres are numbered in the order of the triangles that have one.
    """
    points = np.zeros(CENTRE + 1, np.uint32)
    points[CENTRE] = frame.counts[ROWS]
    one, two = np.uint32(1), np.uint32(2)
    count = 0
    for t in range(mesh.corners.shape[0]):
        row = rows[t]
        if row == 0:  # most triangles are not split
            for i in range(3):
                triangles[count, i] = mesh.corners[t, i]
            source[count] = t
            count += 1
            continue
        # The 12 numbered points; those of edges that are not split are never looked up.
        for i in range(3):
            rim, against = mesh.triangle_rims[t, i] >> one, mesh.triangle_rims[t, i] & one
            first = frame.first_points[rim]
            points[i] = mesh.corners[t, i]
            points[3 + 3 * i] = first + (frame.splits[rim] >> 1)  # the only point, or the second
            points[4 + 3 * i] = first + two * against
            points[5 + 3 * i] = first + two - two * against
        for k in range(patterns.counts[row]):
            for i in range(3):
                triangles[count, i] = points[patterns.subtriangles[row, k, i]]
            source[count] = t
            count += 1
        points[CENTRE] += patterns.subtriangles[row, 0, 0] == CENTRE
