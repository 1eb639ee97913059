"""Small tools for triangle lists: boundary loops, grids, simplification, subdivision."""

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ..geometry.arrays import Floats64, Integers32, Integers64
from ..geometry.sides import border_edges, border_sides, different_pairs, numbered_edges, sides_of

Edge = tuple[int, int]


def boundary_loops(faces: Integers32) -> list[list[int]]:
    """Return closed rows of boundary vertices, in the direction of their faces, longest first.

    At a vertex where holes meet, a row continues around the adjacent faces, and may return to the
    vertex. Raises ValueError if two faces run along an edge in the same direction.
    """
    sides, number = different_pairs(sides_of(faces))
    if len(sides) < len(number):
        first, second = sides[np.bincount(number).argmax()].tolist()
        raise ValueError(f"two faces run from vertex {first} to {second}")
    border = border_sides(faces)
    remaining = {(first, second) for first, second in border.tolist()}
    at_border = np.isin(faces, border).any(axis=1)
    third: dict[Edge, int] = {}  # vertex of the face to the left of each directed edge there
    for a, b, c in faces[at_border].tolist():
        third[a, b] = c
        third[b, c] = a
        third[c, a] = b

    def vertex_after(first: int, second: int) -> int:
        """Go around `second`, face by face, from one side at the border to the next."""
        following = third[first, second]
        while (following, second) in third:
            following = third[following, second]
        return following

    loops = []
    while remaining:
        side = min(remaining)
        loop = []
        while side in remaining:
            remaining.remove(side)
            loop.append(side[0])
            side = side[1], vertex_after(*side)
        loops.append(loop)
    return sorted(loops, key=len, reverse=True)


def strip_triangles(corners: npt.NDArray[np.integer[Any]]) -> Integers64:
    """The triangles of a strip (n,), shape (F, 3), without the degenerate ones that join parts."""
    if len(corners) < 3:
        return np.zeros((0, 3), np.int64)
    windows = np.lib.stride_tricks.sliding_window_view(corners.astype(np.int64), 3)
    triangles: Integers64 = windows.copy()
    triangles[1::2, :2] = windows[1::2, 1::-1]  # every second one runs the other way
    has_area = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
    triangles = triangles[has_area]
    return triangles


def border_vertices(faces: Integers32) -> Integers64:
    """Indices of the vertices on edges with one face, in ascending order."""
    return np.unique(border_edges(faces))


def grid_faces(rows: npt.NDArray[np.integer[Any]], *, closed: bool = False) -> Integers32:
    """Triangles between neighbouring rows of vertex indices (r, n); closed: each row is a ring.

    a--d   a and d are neighbours in a row, b and c in the next row. Triangles: a b c, then a c d.
    | \\|
    b--c
    """
    if closed:
        rows = np.hstack([rows, rows[:, :1]])
    a = rows[:-1, :-1]
    b = rows[1:, :-1]
    c = rows[1:, 1:]
    d = rows[:-1, 1:]
    corners = np.stack([a, b, c, a, c, d], axis=-1)
    return corners.reshape(-1, 3).astype(np.int32)


class Quartered(NamedTuple):
    """A triangle list after one cut, and the ends of each new vertex's edge."""

    faces: Integers32  # (4 F, 3)
    edges: Integers32  # (E, 2), lower number first


def quarter(faces: Integers32, vertex_count: int) -> Quartered:
    """Cut every triangle into four; edge e gets the new vertex `vertex_count` + e.

            c           Old vertices keep their indices. The four children of face f are the faces
           / \\          4 f to 4 f + 3: at corner a, at b, at c, and the central one.
         ca---bc
         / \\ / \\
        a---ab--b
    """
    edges, number = numbered_edges(faces)
    ab, bc, ca = vertex_count + number.reshape(3, -1)
    a, b, c = faces.T
    at_a = np.stack([a, ab, ca], axis=1)
    at_b = np.stack([ab, b, bc], axis=1)
    at_c = np.stack([ca, bc, c], axis=1)
    central = np.stack([ab, bc, ca], axis=1)
    children = np.stack([at_a, at_b, at_c, central], axis=1).reshape(-1, 3)
    return Quartered(children.astype(np.int32), edges.astype(np.int32))


def is_manifold(faces: Integers32) -> bool:
    """Whether each edge has one face, or two faces that run along it in opposite directions."""
    sides = sides_of(faces)
    distinct_sides, _ = different_pairs(sides)
    if len(distinct_sides) < len(sides):
        return False
    _, edge = numbered_edges(faces)
    faces_at_edge = np.bincount(edge)
    return bool(faces_at_edge.max(initial=0) <= 2)


def collapsed(
    vertices: Floats64, faces: Integers32, count: int, attempt: int
) -> tuple[Floats64, Integers32]:
    """Return a simplified mesh of about `count` triangles, which may be non-manifold.

    By quadric error metrics (Garland, Heckbert 1997, "Surface simplification using quadric error
    metrics"), in a maintained library. It may pinch the surface; another `attempt` then has another
    result.
    """
    import fast_simplification  # only dense meshes need it

    unevenness = 5e-5  # share of a mesh's size: 0.01 mm on a head
    # On a plane, such as a subdivided polygon, all places are equally good, and it would merge many
    # vertices.
    uneven = np.random.default_rng(attempt).uniform(-unevenness, unevenness, vertices.shape)
    size = np.ptp(vertices, axis=0).max()
    points, triangles = fast_simplification.simplify(
        np.ascontiguousarray(vertices + uneven * size),
        np.array(faces, np.int32),  # a copy that it may write into
        target_count=count,
        preserve_border=True,
    )
    return np.asarray(points, np.float64), np.asarray(triangles, np.int32)
