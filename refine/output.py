"""Rows of the output: numbering of new points, texture seams, and the subtriangles.

Kähler, Haber, Seidel 2003, section 4.3. The output begins with one row per wedge, so that vertex v
of the input is row v. The points of a rim follow in a block, in the direction of its edge: the
middle point, or quarter, middle, quarter.

A row is x y z, nx ny nz[, u v]. Texture coordinates of new points are interpolated linearly along
their edge, with the values of their own side of a seam (section 4.4, first paragraph).
"""

import numpy as np
import numpy.typing as npt

from .kernels import kernel

Floats = npt.NDArray[np.float32]
Unsigned = npt.NDArray[np.uint32]
Small = npt.NDArray[np.uint8]

GEOMETRY_COLUMNS = 6
"""x y z, nx ny nz: columns of a row before texture coordinates."""
QUARTER = np.float32(0.25)
HALF = np.float32(0.5)
THREE_QUARTERS = np.float32(0.75)


@kernel
def points_on(split: int) -> int:
    """New points on an edge that was split 0, 1 or 2 times: 0, 1 or 3."""
    return split + (split >> 1)


@kernel
def number_points(
    rim_splits: Small,
    edge_points: Unsigned,
    rim_edges: Unsigned,
    wedge_count: int,
    first_points: Unsigned,
    split_once: Unsigned,
    split_twice: Unsigned,
    moved: Small,
) -> tuple[int, int, int]:
    """Give new points their rows, list the split edges, flag the vertices that move.

    `split_once` gets every split edge, `split_twice` those split twice. Edges that are not split
    are skipped at once, because they are most; their entry of `first_points` has no meaning.
    Returns the numbers of rows, of split edges, and of edges split twice.
    """
    edge_count = edge_points.shape[0]
    moved[:] = 0
    row, once_count, twice_count = wedge_count, 0, 0
    for e in range(edge_count):
        split = rim_splits[e]
        if split == 0:
            continue
        first_points[e] = row
        row += points_on(split)
        split_once[once_count] = e
        once_count += 1
        if split == 2:
            split_twice[twice_count] = e
            twice_count += 1
        moved[edge_points[e, 0]] = moved[edge_points[e, 1]] = 1
    for r in range(edge_count, len(rim_edges)):
        rim_splits[r] = rim_splits[rim_edges[r]]
        first_points[r] = row
        row += points_on(rim_splits[r])
    return row, once_count, twice_count


@kernel
def place_unmoved(positions: npt.NDArray[np.floating], normals: Floats, vertices: Floats) -> None:
    """Write vertices as they are, rounded to float32."""
    for v in range(positions.shape[0]):
        for i in range(3):
            vertices[v, i] = positions[v, i]
            vertices[v, 3 + i] = normals[v, i]


@kernel
def copy_wedges(vertex_count: int, wedge_vertices: Unsigned, vertices: Floats) -> None:
    """Copy position and normal of vertices on texture seams to their other sides."""
    for w in range(vertex_count, len(wedge_vertices)):
        for i in range(GEOMETRY_COLUMNS):
            vertices[w, i] = vertices[wedge_vertices[w], i]


@kernel
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


@kernel
def place_texture(
    wedge_uv: Floats,
    rim_uv: Floats,
    rim_splits: Small,
    first_points: Unsigned,
    vertices: Floats,
) -> None:
    """Write texture coordinates: of wedges as given, of new points linearly along their rim."""
    for w in range(wedge_uv.shape[0]):
        vertices[w, 6], vertices[w, 7] = wedge_uv[w, 0], wedge_uv[w, 1]
    for r in range(rim_uv.shape[0]):
        split, row = rim_splits[r], first_points[r]
        for i in range(2):
            at_a, at_b = rim_uv[r, 0, i], rim_uv[r, 1, i]
            if split == 1:
                vertices[row, 6 + i] = HALF * (at_a + at_b)
            elif split == 2:
                vertices[row, 6 + i] = THREE_QUARTERS * at_a + QUARTER * at_b
                vertices[row + 1, 6 + i] = HALF * (at_a + at_b)
                vertices[row + 2, 6 + i] = QUARTER * at_a + THREE_QUARTERS * at_b


@kernel
def look_up_triangles(
    corners: Unsigned,
    triangle_rims: Unsigned,
    rim_splits: Small,
    first_points: Unsigned,
    subtriangle_counts: Small,
    subtriangles: Small,
    triangles: Unsigned,
    source: npt.NDArray[np.int32],
) -> int:
    """Write the subtriangles of every triangle by its table entry (section 4.3); return how many.

    A rim keeps its points in the direction of the edge; a triangle that runs against it reads the
    quarter points in reverse.
    """
    points = np.empty(12, np.uint32)
    count = 0
    for t in range(corners.shape[0]):
        configuration, place_value = 0, 1
        for i in range(3):
            configuration += place_value * rim_splits[triangle_rims[t, i] >> 1]
            place_value *= 3
        # Most triangles are not split: hand them through.
        if configuration == 0:
            for i in range(3):
                triangles[count, i] = corners[t, i]
            source[count] = t
            count += 1
            continue
        # The 12 numbered points; those of edges that are not split are never looked up.
        for i in range(3):
            rim, against = triangle_rims[t, i] >> 1, triangle_rims[t, i] & 1
            first = first_points[rim]
            points[i] = corners[t, i]
            points[3 + 3 * i] = first + (rim_splits[rim] >> 1)  # the only point, or the second
            points[4 + 3 * i] = first + 2 * against
            points[5 + 3 * i] = first + 2 - 2 * against
        for k in range(subtriangle_counts[configuration]):
            for i in range(3):
                triangles[count, i] = points[subtriangles[configuration, k, i]]
            source[count] = t
            count += 1
    return count
