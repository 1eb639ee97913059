"""Simplify the mesh of a head that has too many triangles for simulation in real time."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import scipy

from ...geometry.arrays import Flags, Floats32, Floats64, Integers32
from ...geometry.mesh_graph import pieces_of
from ...geometry.read_only import make_read_only
from ...geometry.sides import numbered_edges, sides_of
from ..errors import AssetError
from ..model import Eye, Layer, Part
from ..topology import border_vertices, collapsed, is_manifold
from .landmark_file import nearest_vertices
from .mesh_validation import SkinPiece

MOST_SIMULATED = 20_000  # triangles; more would take longer, and motion would look the same
SIMPLIFIED_COUNT = 15_000  # number of triangles of a simplified mesh


@dataclass(frozen=True)
class SimulatedHead:
    """A mesh with all data for `sim.create`; it has the attributes of `Head`.

    uv: texture coordinates in the built-in texture, (V, 2).
    jaw_axis: condyles [mm], (2, 3); with None, `sim.create` guesses them from the landmarks.
    """

    vertices: Floats64
    faces: Integers32
    landmarks: Integers32
    bone_depth: Floats64
    mandible_weight: Floats64
    eyes: tuple[Eye, ...]
    parts: tuple[Part, ...]
    rig: dict[str, Any]
    layers: tuple[Layer, ...]
    uv: Floats32
    jaw_axis: Floats64 | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        make_read_only(self)


def simplified(skin: SkinPiece, landmarks: Floats64) -> SkinPiece:
    """Simplify a skin [mm] to about SIMPLIFIED_COUNT triangles, most of them on the head.

    landmarks: points [mm], (68, 3). Raises AssetError if no attempt gives a manifold surface.
    """
    distance = scipy.spatial.cKDTree(landmarks).query(skin.vertices)[0]
    head_reach = 100.0  # [mm] around the landmarks; the body lies farther away
    is_head = (distance < head_reach)[skin.faces].any(axis=1)
    most_attempts = 8  # to get a manifold surface
    for attempt in range(most_attempts):
        vertices, faces = unpinched(*_with_fewer_triangles(skin, is_head, attempt))
        if is_manifold(faces):
            break
    else:
        raise AssetError(
            f"its {len(skin.faces)} triangles cannot be simplified; reduce the mesh to "
            f"{MOST_SIMULATED} in a modelling program"
        )
    nearest = scipy.spatial.cKDTree(skin.vertices).query(vertices)[1]
    indices = nearest_vertices(landmarks, vertices, faces)
    return SkinPiece(
        vertices=vertices,
        faces=faces,
        landmarks=indices,
        file_vertices=skin.file_vertices[nearest],
        file_faces=np.arange(0),
    )


def _with_fewer_triangles(
    skin: SkinPiece, is_head: Flags, attempt: int
) -> tuple[Floats64, Integers32]:
    """Simplify a skin to SIMPLIFIED_COUNT triangles; returns vertices and faces.

    The head gets up to four fifths of these triangles, or more if the body is small. The body gets
    the rest.
    is_head: flags of the skin's triangles, (F,).
    """
    body = skin.faces[~is_head]
    if not len(body):
        return collapsed(skin.vertices, skin.faces, SIMPLIFIED_COUNT, attempt)
    least_body = SIMPLIFIED_COUNT * min(0.2, len(body) / len(skin.faces))  # triangles for the body
    head = skin.faces[is_head]
    head_count = min(len(head), SIMPLIFIED_COUNT - int(least_body))
    vertices, faces = _part_with(skin.vertices, head, head_count, attempt)
    more, body = _part_with(skin.vertices, body, SIMPLIFIED_COUNT - head_count, attempt)
    return _joined(vertices, faces, more, body)


def _part_with(
    vertices: Floats64, faces: Integers32, count: int, attempt: int
) -> tuple[Floats64, Integers32]:
    """Simplify a part of a mesh to `count` triangles; its border stays in place."""
    used, indices = np.unique(faces, return_inverse=True)
    part = indices.reshape(-1, 3).astype(np.int32)
    if len(part) <= count:
        return vertices[used], part
    return collapsed(vertices[used], part, count, attempt)


def unpinched(vertices: Floats64, faces: Integers32) -> tuple[Floats64, Integers32]:
    """Split vertices at edges where more than two triangles meet; returns vertices and faces.

    `collapsed` makes such edges when it pinches folds of a dense mesh. A vertex is not split if
    edges with two triangles connect all triangles around it. Only the largest piece is kept; others
    were attached only by pinched edges.
    """
    sides = sides_of(faces)
    _, edge = numbered_edges(faces)
    uses = np.bincount(edge)
    if uses.max() <= 2:
        return vertices, faces
    corners = sides_of(np.arange(faces.size).reshape(faces.shape))
    corners = np.take_along_axis(corners, np.argsort(sides, axis=1), axis=1)
    is_shared = uses[edge] == 2
    by_edge = np.argsort(edge[is_shared], kind="stable")
    ends = corners[is_shared][by_edge].reshape(-1, 2, 2)  # edge, triangle, end
    links = ends.swapaxes(1, 2).reshape(-1, 2)  # corners of two triangles at one end of an edge
    number = pieces_of(links, faces.size)
    _, first_corner = np.unique(number, return_index=True)
    parted = number.reshape(faces.shape)
    piece = pieces_of(parted, len(first_corner))
    face_piece = piece[parted[:, 0]]
    largest = np.bincount(face_piece).argmax()
    used, indices = np.unique(parted[face_piece == largest], return_inverse=True)
    old_vertices = faces.ravel()[first_corner[used]]
    return vertices[old_vertices], indices.reshape(-1, 3).astype(np.int32)


def _joined(
    vertices: Floats64, faces: Integers32, more: Floats64, more_faces: Integers32
) -> tuple[Floats64, Integers32]:
    """Join two parts of a mesh along their common border."""
    edge = border_vertices(faces)
    more_edge = border_vertices(more_faces)
    joined_share = 2e-4  # relative to the size of both parts; `collapsed` moves borders by less
    widths = np.ptp(np.vstack([vertices, more]), axis=0)
    joined_distance = joined_share * float(widths.max())
    distance, nearest = scipy.spatial.cKDTree(vertices[edge]).query(more[more_edge])
    is_joined = distance < joined_distance
    number = np.full(len(more), -1, np.int32)
    number[more_edge[is_joined]] = edge[nearest[is_joined]]
    is_own = number < 0
    number[is_own] = len(vertices) + np.arange(is_own.sum())
    return np.vstack([vertices, more[is_own]]), np.vstack([faces, number[more_faces]])
