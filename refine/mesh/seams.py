r"""Texture seams, where corners of one vertex have different data; and a weld of doubled vertices.

`faces` give the vertex of a corner, `face_uv` its texture coordinate. Geometry is computed per
vertex and edge; the output needs one row per

  *wedge*: a pair (vertex, texture coordinate). Wedges 0..V-1 are the vertices, seam copies follow;
  *attribute edge*: an edge with the texture coordinates of one side; 0..E-1 are the edges, then
                    copies.
An attribute edge has its own output points, at exactly the positions of its edge's points, so that
no seam can crack.
"""

import itertools
from numbers import Real
from typing import Any

import numpy as np
import numpy.typing as npt

from ...geometry.arrays import Flags, Floats64, Integers32, Integers64, Unsigned32
from ...geometry.numbering import numbered_by_first_use
from .validation import checked_mesh, size_of, used_vertices

SAME_PLACE = 1e-9
"""Vertices no farther apart than this, in sizes of the mesh, count as doubled: a place computed
twice, for example by sin(0) and sin(2 pi), differs in its last bits.
"""
LAST_BITS = 2.0
"""Rounding steps of the positions' type by which doubled vertices may differ."""


def find_seams(
    faces: Unsigned32,
    edge_of: Integers32,
    edges: Integers32,
    sides: Unsigned32,
    vertex_count: int,
    face_uv: npt.NDArray[np.integer] | None,
) -> dict[str, npt.NDArray[Any]]:
    """Find wedges and attribute edges: vertices and edges, followed by their copies along seams."""
    edge_count = len(edges)
    none = np.uint32(2 * edge_count)
    is_proper = edge_of >= 0
    starts = faces.ravel()
    is_reversed = is_proper & (starts != edges[edge_of, 0]) if edge_count else is_proper
    if face_uv is None:
        directed = np.where(is_proper, 2 * edge_of + is_reversed, none).astype(np.uint32)
        return {
            "corners": faces,
            "triangle_attribute_edges": directed.reshape(-1, 3),
            "wedge_vertices": np.arange(vertex_count, dtype=np.uint32),
            "wedge_uv": np.arange(vertex_count, dtype=np.int32),
            "attribute_edges": np.arange(edge_count, dtype=np.uint32),
            "attribute_edge_uv": edges.copy(),
        }
    corner_uv = np.asarray(face_uv, dtype=np.int64).reshape(-1, 3)
    proper = is_proper.reshape(-1, 3)[:, 0]
    first_sides = 3 * (sides[:, 0] >> 2) + (sides[:, 0] & 3)  # half-edge on which each edge begins
    place = np.cumsum(is_proper) - 1  # of a half-edge among those of proper triangles
    number, attribute_edges, attribute_edge_uv = _attribute_edges(
        corner_uv[proper],
        edge_of[is_proper].astype(np.int64),
        is_reversed[is_proper],
        place[first_sides],
    )
    corners, wedge_vertices, wedge_uv = _wedges(faces.astype(np.int64), corner_uv, vertex_count)
    triangle_attribute_edges = np.full(faces.size, 2 * len(attribute_edges), dtype=np.uint32)
    triangle_attribute_edges[is_proper] = 2 * number + is_reversed[is_proper]
    return {
        "corners": corners.astype(np.uint32),
        "triangle_attribute_edges": triangle_attribute_edges.reshape(-1, 3),
        "wedge_vertices": wedge_vertices.astype(np.uint32),
        "wedge_uv": wedge_uv.astype(np.int32),
        "attribute_edges": attribute_edges.astype(np.uint32),
        "attribute_edge_uv": attribute_edge_uv.astype(np.int32),
    }


def weld(
    positions: npt.ArrayLike, faces: npt.ArrayLike, *, tolerance: float | None = None
) -> tuple[Integers32, Integers32]:
    """Merge vertices at the same place, for meshes whose vertices were doubled along seams.

    `positions`: shape (V, 3); `faces`: shape (F, 3); `tolerance`: largest distance of vertices that
    become one, in sizes of the mesh (longest sides of its box); 0 joins only vertices that are
    equal to the last bit. None, the default, is `SAME_PLACE`, or a few rounding steps of the
    positions' type if these are more. Returns one vertex of each place, shape (K,), and the
    triangles in terms of them, shape (F, 3). Bind the refiner to these triangles with
    `rest_positions[vertices]`; pass the texture coordinates of the doubled vertices as `uv`, the
    original triangles as `face_uv`, and `positions[vertices]` in every frame. A vertex that no
    triangle uses stays separate.

    Vertices are welded only by this call, because closed lips touch at rest and must not be welded.
    Raises ValueError for arrays that do not fit together, and for positions that are not finite.
    """
    points, corners = checked_mesh(positions, faces, ("positions", "faces"))
    used = np.flatnonzero(used_vertices(corners, len(points)))
    if tolerance is not None and not (isinstance(tolerance, Real) and 0.0 <= tolerance < 1.0):
        raise ValueError(
            f"tolerance must be a number from 0 to 1, in sizes of the mesh, got {tolerance!r}"
        )
    distance = (SAME_PLACE if tolerance is None else float(tolerance)) * size_of(points[used])
    given = np.asarray(positions).dtype
    if tolerance is None and given.kind == "f":
        last_bits = LAST_BITS * float(np.finfo(given).eps) * np.abs(points[used]).max(initial=0.0)
        distance = max(distance, last_bits)
    rows = len(points) + np.arange(len(points))
    rows[used] = number_places(points[used], distance)
    first_uses, number = numbered_by_first_use(rows)
    return first_uses.astype(np.int32), number[corners].astype(np.int32)


def number_places(points: Floats64, distance: float) -> Integers64:
    """Number points, shape (N, 3), so that points at the same place have the same number.

    Points are at the same place if they are at most `distance` apart, or if a chain of such points
    joins them.
    """
    positions, numbers = np.unique(points, axis=0, return_inverse=True)
    pairs = _near_pairs(positions, distance) if distance > 0.0 and len(positions) > 0 else None
    joined = np.arange(len(positions))
    while pairs is not None:
        before = joined.copy()
        lowest = joined[pairs].min(axis=1)
        np.minimum.at(joined, pairs, lowest[:, None])
        joined = joined[joined]
        if (joined == before).all():
            break
    return np.asarray(joined[numbers.reshape(-1)], dtype=np.int64)


def _near_pairs(positions: Floats64, distance: float) -> Integers64:
    """Return pairs of different places not farther apart than `distance`, shape (P, 2).

    Places are sorted into cubes, some times larger than the distance. A place within this distance
    of a cube's side is also sorted into the next cube.
    """
    lowest = positions.min(axis=0)
    side = max(4.0 * distance, 1e-6 * size_of(positions))  # a number of 64 bits must name any cube
    first_cube = np.floor((positions - lowest - distance) / side) + 1
    last_cube = np.floor((positions - lowest + distance) / side) + 1
    keys = []
    members = []
    for takes_last in itertools.product((False, True), repeat=3):  # along each axis
        cube = np.where(takes_last, last_cube, first_cube)
        is_another = ~np.array(takes_last) | (last_cube != first_cube)
        chosen = np.flatnonzero(is_another.all(axis=1))
        keys.append(cube[chosen].astype(np.int64) @ [1 << 42, 1 << 21, 1])
        members.append(chosen)
    # Sorted by their cubes, places in one cube follow each other, 1, 2, ... steps apart.
    key = np.concatenate(keys)
    order = np.argsort(key, kind="stable")
    key = key[order]
    member = np.concatenate(members)[order]
    pairs = [np.zeros((0, 2), dtype=np.int64)]
    here = np.arange(len(key))
    step = 1
    while len(here) > 0:
        here = here[here + step < len(key)]
        here = here[key[here] == key[here + step]]
        pair = np.stack([member[here], member[here + step]], axis=1)
        apart = np.linalg.norm(positions[pair[:, 0]] - positions[pair[:, 1]], axis=1)
        pairs.append(pair[apart <= distance])
        step += 1
    return np.concatenate(pairs)


def _attribute_edges(
    corner_uv: Integers64, edge_of: Integers64, is_reversed: Flags, first: Integers64
) -> tuple[Integers64, Integers64, Integers64]:
    """Attribute edge of each half-edge; the edge of each, and texture coordinates at its ends."""
    start_uv = corner_uv.ravel()
    end_uv = np.roll(corner_uv, -1, axis=1).ravel()
    uv_at_a = np.where(is_reversed, end_uv, start_uv)
    uv_at_b = np.where(is_reversed, start_uv, end_uv)
    _, uv_pair = numbered_by_first_use(uv_at_a * (corner_uv.max(initial=0) + 1) + uv_at_b)
    first_uses, number = numbered_by_first_use(edge_of * (uv_pair.max(initial=0) + 1) + uv_pair)
    number, first_uses = _originals_first(number, first_uses, edge_of[first_uses], first)
    return (
        number,
        edge_of[first_uses],
        np.stack([uv_at_a[first_uses], uv_at_b[first_uses]], axis=1),
    )


def _wedges(
    faces: Integers64, corner_uv: Integers64, vertex_count: int
) -> tuple[Integers64, Integers64, Integers64]:
    """Wedge of each corner, vertex of each wedge, texture coordinate of each wedge."""
    vertices = faces.ravel()
    first, number = numbered_by_first_use(
        vertices * (corner_uv.max(initial=0) + 1) + corner_uv.ravel()
    )
    vertex_first = np.full(vertex_count, -1, dtype=np.int64)
    used, used_first = np.unique(vertices, return_index=True)
    vertex_first[used] = used_first
    number, first = _originals_first(number, first, vertices[first], vertex_first)
    wedge_vertices = np.concatenate([np.arange(vertex_count), vertices[first[vertex_count:]]])
    uv_or_none = np.append(corner_uv.ravel(), -1)  # a first use of -1 (never used) reads this -1
    return number.reshape(faces.shape), wedge_vertices, uv_or_none[first]


def _originals_first(
    number: Integers64, first: Integers64, owner: Integers64, owner_first: Integers64
) -> tuple[Integers64, Integers64]:
    """Renumber copies so that copy k < len(owner_first) is the first one of its owner k.

    `owner`: edge (or vertex) of each copy; `owner_first`: first use of each owner, -1 for none.
    """
    is_original = owner_first[owner] == first
    rank = np.empty(len(first), dtype=np.int64)
    rank[is_original] = owner[is_original]
    rank[~is_original] = len(owner_first) + np.arange(np.count_nonzero(~is_original))
    return rank[number], np.concatenate([owner_first, first[~is_original]])
