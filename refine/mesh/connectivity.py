r"""Edges of the bound mesh: found once, read in every frame.

Flat index arrays hold all that the paper reads from its half-edge structure (section 3, after
Campagna et al. 1998). They are built once, because the connectivity never changes:

              c
             / \          edge e runs from a to b in the direction of its first triangle (a, b, c);
        ac  /   \  bc     the second triangle (b, a, d) runs through it the other way.
           /     \        `points`  row e = a, b, c, d
          a---e---b        `wings`  row e = the edges ac, bc, ad, bd
           \     /
        ad  \   /  bd     Edge i of a triangle joins its corners i and i + 1.
             \ /
              d

An edge is *interior* when exactly two triangles run through it in opposite directions. Every other
edge (one side, three sides, two sides in the same direction) is a *border*. Rules for borders
split it. They read only the end points of the edge, so all triangles at the edge get equal points.

A *crease* is an edge inside the mesh that stays sharp: it is treated as a border (creases.py).

seams.py describes wedges and attribute edges, the copies along texture seams.

A triangle that names a vertex twice has no area and no edges: it passes unchanged.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ...geometry.arrays import Flags, Integers32, Unsigned32
from ...geometry.read_only import read_only
from ...jit import njit
from .seams import find_seams
from .validation import as_indices

MOST_MESH_VERTICES = 2**31  # the tables that the kernels fill have numbers of 32 bits


class Surroundings(NamedTuple):
    """The surroundings of each edge: all mesh data that the placing of points on edges needs."""

    points: Unsigned32
    """a, b and the opposite corners c, d, shape (E, 4); c = d = a on a border."""
    wings: Unsigned32
    """Edges ac, bc, ad, bd, shape (E, 4); the edge itself on a border."""
    is_interior: Flags
    """Whether two triangles run through the edge in opposite directions, shape (E,)."""


class Connectivity(NamedTuple):
    """Index arrays of one mesh; V vertices, F triangles, E edges, W wedges, R attribute edges."""

    faces: Unsigned32
    """Vertices of each triangle, shape (F, 3)."""
    edges: Integers32
    """End points a, b of each edge, in the order of first use, shape (E, 2)."""
    around: Surroundings
    """The surroundings of each edge."""
    edge_sides: Unsigned32
    """The first two sides of each edge, 4 x triangle + i, shape (E, 2); 4 F for no side."""
    more_sides: Unsigned32
    """Further sides of edges with three triangles or more: edge and side, shape (X, 2)."""
    triangle_edges: Integers32
    """Edges of each triangle, shape (F, 3); -1 for a triangle that names a vertex twice."""
    corners: Unsigned32
    """Wedge of each triangle corner, shape (F, 3); equals `faces` without texture seams."""
    triangle_attribute_edges: Unsigned32
    """2 x attribute edge + (1 if the triangle runs against it), shape (F, 3); 2 R for no edge."""
    wedge_vertices: Unsigned32
    """Vertex of each wedge, shape (W,)."""
    wedge_uv: Integers32
    """Texture coordinate of each wedge, shape (W,); -1 if no corner gives the vertex one."""
    attribute_edges: Unsigned32
    """Edge of each attribute edge, shape (R,)."""
    attribute_edge_uv: Integers32
    """Texture coordinates at the ends a, b of each attribute edge, shape (R, 2)."""
    is_sharp: Flags
    """Flags of creases, which are treated as borders (creases.py), shape (E,)."""
    vertex_count: int
    """V, including isolated vertices."""

    @property
    def is_degenerate(self) -> Flags:
        """Triangles that name a vertex twice, shape (F,)."""
        return np.asarray(self.triangle_edges[:, 0] < 0)

    def read_only(self) -> "Connectivity":
        """The same arrays, as read-only views."""
        fields = self._asdict()
        for name, array in fields.items():
            if isinstance(array, np.ndarray):
                fields[name] = read_only(array)
        fields["around"] = Surroundings._make(map(read_only, self.around))
        return Connectivity(**fields)

    @property
    def first_vertex(self) -> int:
        """The first vertex that a triangle uses; 0 if there are no triangles."""
        return int(self.faces.min()) if len(self.faces) > 0 else 0


def connect(
    faces: npt.ArrayLike,
    vertex_count: int,
    face_uv: npt.ArrayLike | None = None,
) -> Connectivity:
    """Build the connectivity of triangles `faces`, shape (F, 3), with indices below `vertex_count`.

    `face_uv`: texture coordinate index of each corner, shape (F, 3); None when each vertex has one.
    The result is read only.
    Raises ValueError for other shapes or types and for indices out of range.
    """
    return connect_writable(faces, vertex_count, face_uv).read_only()


def connect_writable(
    faces: npt.ArrayLike, vertex_count: int, face_uv: npt.ArrayLike | None = None
) -> Connectivity:
    """Build the result of `connect` with writable arrays, for a refiner that does not share them.

    Compiled code takes writable arrays faster.
    """
    if not isinstance(vertex_count, int | np.integer) or not 0 <= vertex_count < MOST_MESH_VERTICES:
        most = MOST_MESH_VERTICES - 1
        raise ValueError(
            f"vertex_count must be a whole number from 0 to {most}, got {vertex_count!r}"
        )
    given = as_indices("faces", faces, vertex_count, "the vertices")
    corners = np.array(given, dtype=np.uint32, order="C")
    if face_uv is not None:
        face_uv = as_indices("face_uv", face_uv, MOST_MESH_VERTICES, "the texture coordinates")
        if len(face_uv) != len(corners):
            raise ValueError(
                f"face_uv must have one row per triangle ({len(corners)}), got {len(face_uv)}"
            )
    edge_of, edges, sides, side_counts = find_edges(corners, vertex_count)
    around = Surroundings(*find_surroundings(corners, edge_of, edges, sides, side_counts))
    seams = find_seams(corners, edge_of, edges, sides, vertex_count, face_uv)
    return Connectivity(
        faces=corners,
        edges=edges,
        around=around,
        edge_sides=sides,
        more_sides=_more_sides(edge_of, sides, side_counts),
        triangle_edges=edge_of.reshape(-1, 3),
        is_sharp=np.zeros(len(edges), dtype=np.bool_),
        vertex_count=vertex_count,
        **seams,
    )


@njit
def find_edges(
    faces: Unsigned32, vertex_count: int
) -> tuple[Integers32, Integers32, Unsigned32, Integers32]:
    """Number the edges in the order of their first use, so that neighbours are near in memory.

    Returns the edge of each half-edge, -1 for none, shape (3 F,); end points, shape (E, 2); the
    first two sides, shape (E, 2); and the number of sides, shape (E,). Edges whose vertex indices
    have the same sum form a linked list, which is short even at a vertex of large valence.
    """
    half_edge_count = faces.size
    edge_of = np.full(half_edge_count, np.int32(-1))
    edges = np.empty((half_edge_count, 2), np.int32)
    sides = np.full((half_edge_count, 2), np.uint32(4 * faces.shape[0]))
    side_counts = np.zeros(half_edge_count, np.int32)
    heads = np.full(2 * vertex_count, np.int32(-1))
    following = np.empty(half_edge_count, np.int32)
    count = 0
    for t in range(faces.shape[0]):
        a = faces[t, 0]
        b = faces[t, 1]
        c = faces[t, 2]
        if a == b or b == c or c == a:
            continue
        for i in range(3):
            start = np.int32(faces[t, i])
            end = np.int32(faces[t, (i + 1) % 3])
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
                edges[edge, 0] = start
                edges[edge, 1] = end
                following[edge] = heads[start + end]
                heads[start + end] = edge
            edge_of[3 * t + i] = edge
            if side_counts[edge] < 2:
                sides[edge, side_counts[edge]] = 4 * t + i
            side_counts[edge] += 1
    return edge_of, edges[:count].copy(), sides[:count].copy(), side_counts[:count].copy()


@njit
def find_surroundings(
    faces: Unsigned32,
    edge_of: Integers32,
    edges: Integers32,
    sides: Unsigned32,
    side_counts: Integers32,
) -> tuple[Unsigned32, Unsigned32, Flags]:
    """Find the fields of `Surroundings` (see the picture)."""
    points = np.empty((edges.shape[0], 4), np.uint32)
    wings = np.empty((edges.shape[0], 4), np.uint32)
    is_interior = np.zeros(edges.shape[0], np.bool_)
    for e in range(edges.shape[0]):
        a = np.uint32(edges[e, 0])
        b = np.uint32(edges[e, 1])
        points[e, 0] = a
        points[e, 1] = b
        points[e, 2] = a
        points[e, 3] = a
        wings[e, :] = np.uint32(e)
        t = sides[e, 0] >> 2
        i = sides[e, 0] & 3
        if side_counts[e] != 2:
            continue
        u = sides[e, 1] >> 2
        j = sides[e, 1] & 3
        if faces[u, j] != b:
            continue
        is_interior[e] = True
        points[e, 2] = faces[t, (i + 2) % 3]
        points[e, 3] = faces[u, (j + 2) % 3]
        wings[e, 0] = edge_of[3 * t + (i + 2) % 3]
        wings[e, 1] = edge_of[3 * t + (i + 1) % 3]
        wings[e, 2] = edge_of[3 * u + (j + 1) % 3]
        wings[e, 3] = edge_of[3 * u + (j + 2) % 3]
    return points, wings, is_interior


def _more_sides(edge_of: Integers32, sides: Unsigned32, side_counts: Integers32) -> Unsigned32:
    """Sides of edges with more than two triangles that do not fit into `edge_sides`."""
    proper = np.flatnonzero(edge_of >= 0)
    crowded = proper[side_counts[edge_of[proper]] > 2]
    edges = edge_of[crowded]
    side = crowded // 3 * 4 + crowded % 3
    is_more = (sides[edges] != side[:, None]).all(axis=1)
    return np.stack([edges[is_more], side[is_more]], axis=1).astype(np.uint32)
