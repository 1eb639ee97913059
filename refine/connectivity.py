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

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Indices = npt.NDArray[np.int32]
Unsigned = npt.NDArray[np.uint32]
Flags = npt.NDArray[np.bool_]
Wide = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Connectivity:
    """Index arrays of one mesh; V vertices, F triangles, E edges, W wedges, R rims."""

    faces: Unsigned
    """Vertices of each triangle, shape (F, 3)."""
    edges: Indices
    """End points a, b of each edge, in the order of first use, shape (E, 2)."""
    edge_points: Unsigned
    """a, b and the opposite corners c, d, shape (E, 4); c = d = a on a border."""
    edge_wings: Unsigned
    """Edges ac, bc, ad, bd, shape (E, 4); the edge itself on a border."""
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
    """Texture coordinate of each wedge, shape (W,); -1 where no triangle uses the vertex."""
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
    faces: npt.NDArray[np.integer],
    vertex_count: int,
    face_uv: npt.NDArray[np.integer] | None = None,
) -> Connectivity:
    """Build the connectivity of triangles `faces`, shape (F, 3), with indices below `vertex_count`.

    `face_uv`: texture coordinate index of each corner, shape (F, 3); None when each vertex has one.
    """
    wide_faces = np.asarray(faces, dtype=np.int64)
    corner_uv = wide_faces if face_uv is None else np.asarray(face_uv, dtype=np.int64)
    is_proper = _has_three_corners(wide_faces)
    starts = wide_faces[is_proper].ravel()
    ends = np.roll(wide_faces[is_proper], -1, axis=1).ravel()

    low, high = np.minimum(starts, ends), np.maximum(starts, ends)
    edge_of, first = number_by_first_use(low * vertex_count + high)
    edges = np.stack([starts[first], ends[first]], axis=1)
    is_reversed = starts != edges[edge_of, 0]
    is_interior, edge_points, edge_wings = _neighbourhoods(
        wide_faces[is_proper], edges, edge_of, is_reversed, first
    )
    rim_of, rim_edges, rim_uv = _rims(corner_uv[is_proper], edge_of, is_reversed, first)
    corners, wedge_vertices, wedge_uv = _wedges(wide_faces, corner_uv, vertex_count)

    triangle_edges = np.full(wide_faces.shape, -1, dtype=np.int32)
    triangle_edges[is_proper] = edge_of.reshape(-1, 3)
    edge_ends = edges.astype(np.int32)
    for handed_out in (edge_ends, triangle_edges):
        handed_out.flags.writeable = False
    triangle_rims = np.full(wide_faces.shape, 2 * len(rim_edges), dtype=np.uint32)
    triangle_rims[is_proper] = (2 * rim_of + is_reversed).reshape(-1, 3)
    return Connectivity(
        faces=wide_faces.astype(np.uint32),
        edges=edge_ends,
        edge_points=edge_points.astype(np.uint32),
        edge_wings=edge_wings.astype(np.uint32),
        is_interior=is_interior,
        triangle_edges=triangle_edges,
        corners=corners.astype(np.uint32),
        triangle_rims=triangle_rims,
        wedge_vertices=wedge_vertices.astype(np.uint32),
        wedge_uv=wedge_uv.astype(np.int32),
        rim_edges=rim_edges.astype(np.uint32),
        rim_uv=rim_uv.astype(np.int32),
        vertex_count=vertex_count,
    )


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


def weld(
    positions: npt.NDArray[np.floating], faces: npt.NDArray[np.integer]
) -> tuple[Indices, Indices]:
    """Merge vertices with equal positions: for meshes whose vertices were doubled along seams.

    `positions`: shape (V, 3); `faces`: shape (F, 3). Returns the kept vertices, shape (K,), and
    the triangles in terms of them, shape (F, 3). Bind the refiner to these triangles with
    `rest_positions[kept]`, give it the texture coordinates of the doubled vertices as `uv` and the
    original triangles as `face_uv`, and hand it `positions[kept]` in every frame.

    It is a call of its own, never done unasked: closed lips touch at rest and must not be sewn up.
    """
    points = np.asarray(positions) + 0.0  # turns -0.0 into 0.0, which compares equal but differs
    rows = np.unique(points, axis=0, return_inverse=True)[1].reshape(-1).astype(np.int64)
    number, kept = number_by_first_use(rows)
    return kept.astype(np.int32), number[np.asarray(faces)].astype(np.int32)


def _has_three_corners(faces: Wide) -> Flags:
    following = np.roll(faces, -1, axis=1)
    return np.asarray((faces != following).all(axis=1))


def _neighbourhoods(
    faces: Wide, edges: Wide, edge_of: Wide, is_reversed: Flags, first: Wide
) -> tuple[Flags, Wide, Wide]:
    """Which edges are interior, and the corners and edges around each (see the picture above)."""
    side_count = np.bincount(edge_of, minlength=len(edges))
    reversed_count = np.bincount(edge_of, weights=is_reversed, minlength=len(edges))
    is_interior = (side_count == 2) & (reversed_count == 1)

    half_edges = np.arange(len(edge_of))
    following = half_edges - half_edges % 3 + (half_edges + 1) % 3
    preceding = half_edges - half_edges % 3 + (half_edges + 2) % 3
    opposite_corner = np.roll(faces, -2, axis=1).ravel()

    edge_points = np.stack([edges[:, 0], edges[:, 1], edges[:, 0], edges[:, 0]], axis=1)
    edge_wings = np.repeat(np.arange(len(edges))[:, None], 4, axis=1)
    inner = np.flatnonzero(is_interior)
    forward = first[inner]
    backward_of = np.zeros(len(edges), dtype=np.int64)
    backward_of[edge_of[is_reversed]] = half_edges[is_reversed]
    backward = backward_of[inner]
    edge_points[inner, 2] = opposite_corner[forward]
    edge_points[inner, 3] = opposite_corner[backward]
    edge_wings[inner, 0] = edge_of[preceding[forward]]
    edge_wings[inner, 1] = edge_of[following[forward]]
    edge_wings[inner, 2] = edge_of[following[backward]]
    edge_wings[inner, 3] = edge_of[preceding[backward]]
    return is_interior, edge_points, edge_wings


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
