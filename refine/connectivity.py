r"""Edges of the bound mesh: found once, walked every frame.

Every question the paper asks of its half-edge structure (section 3, after Campagna et al. 1998) is
answered here once, as flat index arrays, because the connectivity never changes while it deforms:

              c
             / \          edge e runs from a to b in the direction of its first triangle (a, b, c);
        ac  /   \  bc     the second triangle (b, a, d) runs through it the other way.
           /     \        `edge_points` row e = a, b, c, d
          a---e---b        `edge_wings`  row e = the edges ac, bc, ad, bd
           \     /
        ad  \   /  bd     Edge i of a triangle joins its corners i and i + 1.
             \ /
              d

An edge is *interior* when exactly two triangles run through it in opposite directions. Everything
else (one side, three sides, two sides in the same direction) is a *border*: it is split by the
boundary rules, which read the end points only, and so from all sides in the same way.

Texture seams: `faces` say where a corner is, `face_uv` what it looks like. Geometry is worked out
per vertex and edge; the output needs one row per
  *wedge*: a pair (vertex, texture coordinate). Wedges 0..V-1 are the vertices, seam copies follow;
  *rim*:   an edge with the texture coordinates of one side. Rims 0..E-1 are the edges, then copies.
A rim has its own output points, at the very positions of its edge, so a seam cannot crack.

A triangle that names a vertex twice has no area and no edges: it is handed through as it is.
"""

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ..jit import njit
from .arguments import as_indices, checked_positions

Indices = npt.NDArray[np.int32]
Unsigned = npt.NDArray[np.uint32]
Flags = npt.NDArray[np.bool_]
Wide = npt.NDArray[np.int64]


class Connectivity(NamedTuple):
    """Index arrays of one mesh; V vertices, F triangles, E edges, W wedges, R rims.

    Compiled code takes it as it is.
    """

    faces: Unsigned
    """Vertices of each triangle, shape (F, 3)."""
    edges: Indices
    """End points a, b of each edge, in the order of first use, shape (E, 2)."""
    edge_points: Unsigned
    """a, b and the opposite corners c, d, shape (E, 4); c = d = a on a border."""
    edge_wings: Unsigned
    """Edges ac, bc, ad, bd, shape (E, 4); the edge itself on a border."""
    edge_sides: Unsigned
    """The first two sides of each edge, 4 x triangle + i, shape (E, 2); 4 F where there is none."""
    more_sides: Unsigned
    """Edge and side beyond the first two, shape (X, 2): edges of three sheets."""
    is_interior: Flags
    """Whether two triangles run through the edge in opposite directions, shape (E,)."""
    triangle_edges: Indices
    """Edges of each triangle, shape (F, 3); -1 for a triangle that names a vertex twice."""
    corners: Unsigned
    """Wedge of each triangle corner, shape (F, 3); equals `faces` without texture seams."""
    triangle_rims: Unsigned
    """2 x rim + (1 if the triangle runs against it), shape (F, 3); rim R where there is none."""
    wedge_vertices: Unsigned
    """Vertex of each wedge, shape (W,)."""
    wedge_uv: Indices
    """Texture coordinate of each wedge, shape (W,); -1 where no corner gives the vertex one."""
    rim_edges: Unsigned
    """Edge of each rim, shape (R,)."""
    rim_uv: Indices
    """Texture coordinates at the ends a, b of each rim, shape (R, 2)."""
    vertex_count: int
    """V, isolated vertices included."""

    @property
    def is_degenerate(self) -> Flags:
        """Triangles that name a vertex twice, shape (F,)."""
        return np.asarray(self.triangle_edges[:, 0] < 0)


def connect(
    faces: npt.ArrayLike,
    vertex_count: int,
    face_uv: npt.ArrayLike | None = None,
) -> Connectivity:
    """Build the connectivity of triangles `faces`, shape (F, 3), with indices below `vertex_count`.

    `face_uv`: texture coordinate index of each corner, shape (F, 3); None when each vertex has one.
    Raises ValueError for other shapes or types and for indices out of range.
    """
    given = as_indices("faces", faces, vertex_count, "the vertices")
    corners = np.array(given, dtype=np.uint32, order="C")
    if face_uv is not None:
        face_uv = as_indices("face_uv", face_uv, 2**31, "the texture coordinates")
        if len(face_uv) != len(corners):
            raise ValueError(
                f"face_uv must have one row per triangle ({len(corners)}), got {len(face_uv)}"
            )
    half_edge_count = corners.size
    edge_of = np.full(half_edge_count, -1, dtype=np.int32)
    edges = np.empty((half_edge_count, 2), dtype=np.int32)
    sides = np.full((half_edge_count, 2), 4 * len(corners), dtype=np.uint32)
    side_counts = np.zeros(half_edge_count, dtype=np.int32)
    heads = np.full(2 * vertex_count, -1, dtype=np.int32)
    following = np.empty(half_edge_count, dtype=np.int32)
    edge_count = find_edges(corners, edge_of, edges, sides, side_counts, heads, following)
    edges, sides = edges[:edge_count].copy(), sides[:edge_count].copy()
    edge_points = np.empty((edge_count, 4), dtype=np.uint32)
    edge_wings = np.empty((edge_count, 4), dtype=np.uint32)
    is_interior = np.empty(edge_count, dtype=np.bool_)
    look_around(
        corners,
        edge_of,
        edges,
        sides,
        side_counts[:edge_count],
        is_interior,
        edge_points,
        edge_wings,
    )
    seams = _seams(corners, edge_of, edges, sides, vertex_count, face_uv)
    triangle_edges = edge_of.reshape(-1, 3)
    for handed_out in (edges, triangle_edges):
        handed_out.flags.writeable = False
    return Connectivity(
        faces=corners,
        edges=edges,
        edge_points=edge_points,
        edge_wings=edge_wings,
        edge_sides=sides,
        more_sides=_more_sides(edge_of, sides, side_counts[:edge_count]),
        is_interior=is_interior,
        triangle_edges=triangle_edges,
        vertex_count=vertex_count,
        **seams,
    )


@njit
def find_edges(
    faces: Unsigned,
    edge_of: Indices,
    edges: Indices,
    sides: Unsigned,
    side_counts: Indices,
    heads: Indices,
    following: Indices,
) -> int:
    """Number the edges in the order of their first use, and return how many there are.

    The order keeps neighbours in the mesh near each other in memory. Edges are found again in
    lists that are chained by the sum of their end points: short ones, however large a valence is.
    `heads`: -1 for every sum; `following`: scratch, as long as `edge_of`.
    """
    count = 0
    for t in range(faces.shape[0]):
        a, b, c = faces[t, 0], faces[t, 1], faces[t, 2]
        if a == b or b == c or c == a:
            continue
        for i in range(3):
            start, end = np.int32(faces[t, i]), np.int32(faces[t, (i + 1) % 3])
            edge = heads[start + end]
            while edge >= 0:
                if edges[edge, 0] == start and edges[edge, 1] == end:
                    break
                if edges[edge, 0] == end and edges[edge, 1] == start:
                    break
                edge = following[edge]
            if edge < 0:
                edge = np.int32(count)
                count += 1
                edges[edge, 0], edges[edge, 1] = start, end
                following[edge] = heads[start + end]
                heads[start + end] = edge
            edge_of[3 * t + i] = edge
            if side_counts[edge] < 2:
                sides[edge, side_counts[edge]] = 4 * t + i
            side_counts[edge] += 1
    return count


@njit
def look_around(
    faces: Unsigned,
    edge_of: Indices,
    edges: Indices,
    sides: Unsigned,
    side_counts: Indices,
    is_interior: Flags,
    edge_points: Unsigned,
    edge_wings: Unsigned,
) -> None:
    """Find which edges are interior, and the corners and edges around each (see the picture)."""
    for e in range(edges.shape[0]):
        a, b = np.uint32(edges[e, 0]), np.uint32(edges[e, 1])
        edge_points[e, 0], edge_points[e, 1], edge_points[e, 2], edge_points[e, 3] = a, b, a, a
        edge_wings[e, :] = np.uint32(e)
        t, i = sides[e, 0] >> 2, sides[e, 0] & 3
        is_interior[e] = False
        if side_counts[e] != 2:
            continue
        u, j = sides[e, 1] >> 2, sides[e, 1] & 3
        if faces[u, j] != b:
            continue
        is_interior[e] = True
        edge_points[e, 2] = faces[t, (i + 2) % 3]
        edge_points[e, 3] = faces[u, (j + 2) % 3]
        edge_wings[e, 0] = edge_of[3 * t + (i + 2) % 3]
        edge_wings[e, 1] = edge_of[3 * t + (i + 1) % 3]
        edge_wings[e, 2] = edge_of[3 * u + (j + 1) % 3]
        edge_wings[e, 3] = edge_of[3 * u + (j + 2) % 3]


def _more_sides(edge_of: Indices, sides: Unsigned, side_counts: Indices) -> Unsigned:
    """Sides of edges of more than two triangles that `edge_sides` has no room for."""
    proper = np.flatnonzero(edge_of >= 0)
    crowded = proper[side_counts[edge_of[proper]] > 2]
    edges, side = edge_of[crowded], crowded // 3 * 4 + crowded % 3
    is_more = (sides[edges] != side[:, None]).all(axis=1)
    return np.stack([edges[is_more], side[is_more]], axis=1).astype(np.uint32)


def _seams(
    faces: Unsigned,
    edge_of: Indices,
    edges: Indices,
    sides: Unsigned,
    vertex_count: int,
    face_uv: npt.NDArray[np.integer] | None,
) -> dict[str, npt.NDArray[Any]]:
    """Wedges and rims: those of the vertices and edges, and their copies along seams."""
    edge_count = len(edges)
    none = np.uint32(2 * edge_count)
    is_proper = edge_of >= 0
    starts = faces.ravel()
    is_reversed = is_proper & (starts != edges[edge_of, 0]) if edge_count else is_proper
    if face_uv is None:
        rims = np.where(is_proper, 2 * edge_of + is_reversed, none).astype(np.uint32)
        return {
            "corners": faces,
            "triangle_rims": rims.reshape(-1, 3),
            "wedge_vertices": np.arange(vertex_count, dtype=np.uint32),
            "wedge_uv": np.arange(vertex_count, dtype=np.int32),
            "rim_edges": np.arange(edge_count, dtype=np.uint32),
            "rim_uv": edges.copy(),
        }
    corner_uv = np.asarray(face_uv, dtype=np.int64).reshape(-1, 3)
    proper = is_proper.reshape(-1, 3)[:, 0]
    place = np.cumsum(is_proper) - 1  # of a half-edge among those of proper triangles
    rim_of, rim_edges, rim_uv = _rims(
        corner_uv[proper],
        edge_of[is_proper].astype(np.int64),
        is_reversed[is_proper],
        place[(sides[:, 0] >> 2) * 3 + (sides[:, 0] & 3)],
    )
    corners, wedge_vertices, wedge_uv = _wedges(faces.astype(np.int64), corner_uv, vertex_count)
    triangle_rims = np.full(faces.size, 2 * len(rim_edges), dtype=np.uint32)
    triangle_rims[is_proper] = 2 * rim_of + is_reversed[is_proper]
    return {
        "corners": corners.astype(np.uint32),
        "triangle_rims": triangle_rims.reshape(-1, 3),
        "wedge_vertices": wedge_vertices.astype(np.uint32),
        "wedge_uv": wedge_uv.astype(np.int32),
        "rim_edges": rim_edges.astype(np.uint32),
        "rim_uv": rim_uv.astype(np.int32),
    }


def number_by_first_use(keys: Wide) -> tuple[Wide, Wide]:
    """Number equal keys alike, in the order in which they first appear.

    Returns the number of every key, and for every number the place of its first use. The order
    keeps neighbours in the mesh near each other in memory.
    """
    _, first, inverse = np.unique(keys, return_index=True, return_inverse=True)
    order = np.argsort(first, kind="stable")
    rank = np.empty(len(order), dtype=np.int64)
    rank[order] = np.arange(len(order))
    return rank[inverse.reshape(-1)], first[order].astype(np.int64)


def weld(positions: npt.ArrayLike, faces: npt.ArrayLike) -> tuple[Indices, Indices]:
    """Merge vertices with equal positions: for meshes whose vertices were doubled along seams.

    `positions`: shape (V, 3); `faces`: shape (F, 3). Returns the kept vertices, shape (K,), and
    the triangles in terms of them, shape (F, 3). Bind the refiner to these triangles with
    `rest_positions[kept]`, give it the texture coordinates of the doubled vertices as `uv` and the
    original triangles as `face_uv`, and hand it `positions[kept]` in every frame.

    It is a call of its own, never done unasked: closed lips touch at rest and must not be sewn up.
    Raises ValueError for arrays that do not fit together, and for positions that are not finite.
    """
    points = checked_positions(positions, "positions")
    corners = as_indices("faces", faces, len(points), "positions")
    rows = np.unique(points, axis=0, return_inverse=True)[1].reshape(-1).astype(np.int64)
    number, kept = number_by_first_use(rows)
    return kept.astype(np.int32), number[corners].astype(np.int32)


def _rims(
    corner_uv: Wide, edge_of: Wide, is_reversed: Flags, first: Wide
) -> tuple[Wide, Wide, Wide]:
    """Rim of each half-edge, edge of each rim, texture coordinates at the ends of each rim."""
    start_uv = corner_uv.ravel()
    end_uv = np.roll(corner_uv, -1, axis=1).ravel()
    uv_at_a = np.where(is_reversed, end_uv, start_uv)
    uv_at_b = np.where(is_reversed, start_uv, end_uv)
    uv_pair, _ = number_by_first_use(uv_at_a * (corner_uv.max(initial=0) + 1) + uv_at_b)
    number, rim_first = number_by_first_use(edge_of * (uv_pair.max(initial=0) + 1) + uv_pair)
    number, rim_first = _originals_first(number, rim_first, edge_of[rim_first], first)
    return (
        number,
        edge_of[rim_first],
        np.stack([uv_at_a[rim_first], uv_at_b[rim_first]], axis=1),
    )


def _wedges(faces: Wide, corner_uv: Wide, vertex_count: int) -> tuple[Wide, Wide, Wide]:
    """Wedge of each corner, vertex of each wedge, texture coordinate of each wedge."""
    vertices = faces.ravel()
    number, first = number_by_first_use(
        vertices * (corner_uv.max(initial=0) + 1) + corner_uv.ravel()
    )
    vertex_first = np.full(vertex_count, -1, dtype=np.int64)
    used, used_first = np.unique(vertices, return_index=True)
    vertex_first[used] = used_first
    number, first = _originals_first(number, first, vertices[first], vertex_first)
    wedge_vertices = np.concatenate([np.arange(vertex_count), vertices[first[vertex_count:]]])
    uv_or_none = np.append(corner_uv.ravel(), -1)  # first use -1 (never used) reads the -1
    return number.reshape(faces.shape), wedge_vertices, uv_or_none[first]


def _originals_first(
    number: Wide, first: Wide, owner: Wide, owner_first: Wide
) -> tuple[Wide, Wide]:
    """Renumber copies so that copy k < len(owner_first) is the one its owner k was first seen as.

    `owner`: edge (or vertex) of each copy; `owner_first`: first use of each owner, -1 for none.
    """
    is_original = owner_first[owner] == first
    rank = np.empty(len(first), dtype=np.int64)
    rank[is_original] = owner[is_original]
    rank[~is_original] = len(owner_first) + np.arange(np.count_nonzero(~is_original))
    return rank[number], np.concatenate([owner_first, first[~is_original]])
