"""Check that a mesh can be a face; each check raises an error with a message of one line.

A mesh must be a manifold, oriented surface. Mouth and eyes must be open or at least slit, because
muscles cannot part welded lips.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import scipy
from scipy.sparse import csgraph

from ...geometry.arrays import Flags, Floats64, Integers, Integers32, Integers64
from ...geometry.mesh_graph import length_graph, path_lengths, path_to, pieces_of
from ...geometry.numbering import numbered_by_first_use
from ...geometry.sides import border_edges, different_pairs, numbered_edges, side_lengths, sides_of
from ..errors import AssetError
from ..topology import border_vertices

MOST_FITTED_TRIANGLES = 250_000
FEWEST_TRIANGLES = 300  # chosen; with fewer, eyes and mouth have no shape
# Skin joins two lips, or two lids, if the shortest path between them is shorter than this fraction
# of the path around a corner of the opening. The path through a bag behind them is longer.
JOINED_SHARE = 0.6
# Skin down to this depth [mm] behind the lids' edges covers an eye; sockets are deeper.
COVER_DEPTH = 6.0
# Pairs of landmarks on the upper and the lower lid; landmarks at the corners of the eyes.
LID_PAIRS = {"right": ((37, 41), (38, 40)), "left": ((43, 47), (44, 46))}
EYE_CORNERS = {"right": (36, 39), "left": (42, 45)}


class CoveredError(AssetError):
    """Skin covers the mouth or an eye, which must be open."""


class ShutMouthError(CoveredError):
    """Skin joins the lips."""


@dataclass(frozen=True)
class SkinPiece:
    """The piece of a mesh that has the landmarks, with its indices in the whole mesh."""

    vertices: Floats64  # (V, 3)
    faces: Integers32  # (F, 3)
    landmarks: Integers32  # (68,) vertex indices in this piece
    file_vertices: Integers32  # (V,) vertex indices in the whole mesh
    file_faces: Integers64  # (F,) triangle indices in the whole mesh
    is_turned: bool = False  # whether the file's triangles faced inward


def check_size(skin: SkinPiece) -> None:
    """Raise AssetError if a vertex [mm] lies far away from the face."""
    off = np.linalg.norm(skin.vertices, axis=1)
    most_distance = 10_000.0  # [mm] from the centre of the face; more is a mistake
    if off.max() > most_distance:
        where = int(off.argmax())
        raise AssetError(
            f"vertex {skin.file_vertices[where]} lies {off[where] / 1000.0:.3g} m off the face; "
            f"allowed are {most_distance / 1000.0:g} m: remove stray vertices and "
            "everything that is not the head"
        )


def skin_of(vertices: Floats64, faces: Integers32, landmarks: Integers32) -> SkinPiece:
    """Return the piece of a mesh that has the landmarks; it lacks eyeballs and loose vertices.

    Triangles that name a vertex twice are left out, too. Raises AssetError if the landmarks lie on
    several pieces or on none, or if the piece has too few or too many triangles.
    """
    _check_count(faces, FEWEST_TRIANGLES, math.inf)
    is_triangle = ~_names_twice(faces)
    piece = pieces_of(faces[is_triangle], len(vertices))
    others = np.flatnonzero(piece[landmarks] != np.bincount(piece[landmarks]).argmax())
    if len(others):
        raise AssetError(
            f"landmark {others[0]} lies on another piece of the mesh than most; the skin must be "
            "one piece: weld its seams"
        )
    is_in_piece = piece == piece[landmarks[0]]
    used = np.flatnonzero(is_in_piece).astype(np.int32)
    number = np.cumsum(is_in_piece).astype(np.int32) - 1
    file_faces = np.flatnonzero(is_in_piece[faces[:, 0]] & is_triangle)
    skin = number[faces[file_faces]]
    _check_count(skin, FEWEST_TRIANGLES, MOST_FITTED_TRIANGLES)
    return SkinPiece(
        vertices=vertices[used],
        faces=skin,
        landmarks=number[landmarks],
        file_vertices=used,
        file_faces=file_faces,
    )


def with_seams_joined(
    vertices: Floats64, faces: Integers32, landmarks: Integers32
) -> tuple[Integers32, Integers32]:
    """Join the seams between pieces of a mesh; returns triangles and landmarks.

    Programs double vertices where texture or material changes, or in every triangle. If the
    landmarks lie on several pieces, coinciding vertices on borders are merged. If the result is not
    manifold, the arguments are returned unchanged.
    """
    piece = pieces_of(faces, len(vertices))
    if (piece[landmarks] == piece[landmarks[0]]).all():
        return faces, landmarks
    border = border_vertices(faces)
    first, number = numbered_by_first_use(vertices[border] + 0.0)  # + 0.0 turns -0.0 into 0.0
    same = np.arange(len(vertices), dtype=np.int32)
    same[border] = border[first[number]]
    joined = same[faces]
    marked = same[landmarks]
    piece = pieces_of(joined, len(vertices))
    is_skin = (piece[joined[:, 0]] == piece[marked[0]]) & ~_names_twice(joined)
    try:
        check_manifold(joined[is_skin])
    except AssetError:
        return faces, landmarks
    has_all_landmarks = (piece[marked] == piece[marked[0]]).all()
    return (joined, marked) if has_all_landmarks else (faces, landmarks)


def _check_count(faces: Integers32, fewest: float, most: float) -> None:
    if not fewest <= len(faces) <= most:
        cure = "reduce" if len(faces) > most else "subdivide"
        raise AssetError(
            f"the head has {len(faces)} triangles; allowed are {FEWEST_TRIANGLES} to "
            f"{MOST_FITTED_TRIANGLES}: {cure} it in a modelling program"
        )


def vertices_of_pieces(piece: Integers32, faces: Integers32) -> list[Integers]:
    """Return the vertices of each piece of a mesh, in rising order, without loose vertices.

    piece: piece of each vertex, see `pieces_of`, (V,).
    """
    used = np.unique(faces)
    order = used[np.argsort(piece[used], kind="stable")]
    starts = np.flatnonzero(np.diff(piece[order])) + 1
    return np.split(order, starts)


def _names_twice(faces: Integers32) -> Flags:
    """Whether each triangle names a vertex twice; flags (F,)."""
    return np.asarray((faces == np.roll(faces, 1, axis=1)).any(axis=1))


def check_manifold(faces: Integers32) -> None:
    """Raise AssetError unless each edge has one triangle, or two with equal orientation."""
    edges, edge_of_side = numbered_edges(faces)
    uses = np.bincount(edge_of_side)
    if (uses > 2).any():
        a, b = edges[uses.argmax()]
        raise AssetError(
            f"the mesh is not manifold: {uses.max()} triangles meet at the edge of its vertices "
            f"{a} and {b}; remove doubled faces and inner walls"
        )
    sides, number = different_pairs(sides_of(faces))
    uses = np.bincount(number)
    if (uses > 1).any():
        a, b = sides[uses.argmax()]
        raise AssetError(
            f"the mesh is not oriented: both triangles at the edge of its vertices {a} and {b} run "
            "along it in the same direction; make its normals agree"
        )


def check_pieces(faces: Integers32, count: int) -> None:
    """Raise AssetError if no piece of a mesh with `count` vertices could be a skin.

    The message is about the largest piece.
    """
    faces = faces[~_names_twice(faces)]
    if not len(faces):
        return
    piece = pieces_of(faces, count)[faces[:, 0]]
    triangles = np.bincount(piece)
    enough = min(FEWEST_TRIANGLES, triangles.max())
    complaint = None
    for each in np.argsort(-triangles, kind="stable"):
        if triangles[each] < enough:
            break
        try:
            check_manifold(faces[piece == each])
            return
        except AssetError as error:
            complaint = complaint or error
    if complaint is not None:
        raise complaint


def check_openings(skin: SkinPiece) -> None:
    """Raise AssetError if lips are joined, or skin covers an eye; skin: in the face space [mm]."""
    middle_of_lips = (62, 66)  # inner landmarks, above and below
    over, under = skin.landmarks[list(middle_of_lips)]
    across, around = _across_and_around(skin, middle_of_lips, corners=(60, 64))
    if over == under or across < JOINED_SHARE * around:
        raise ShutMouthError(
            "the mouth is shut: skin joins landmarks "
            f"{middle_of_lips[0]} and {middle_of_lips[1]} over {across:.0f} mm; "
            "cut the mesh open between the lips"
        )
    corners = skin.vertices[skin.faces]
    for side, pairs in LID_PAIRS.items():
        numbers = [number for pair in pairs for number in pair]
        centre = skin.vertices[skin.landmarks[numbers]].mean(axis=0)
        if is_covered(corners, centre) and not _is_slit(skin, side):
            raise CoveredError(
                f"the {side} eye has no opening: skin lies between landmarks {pairs[0][0]} and "
                f"{pairs[0][1]}; cut the mesh open between the lids (a head with its eyes open)"
            )


def notes_of_shut_eyes(skin: SkinPiece) -> tuple[str, ...]:
    """Return a line for the user about eyes that are shut at rest; empty if both are open."""
    sides = [side for side in LID_PAIRS if _is_slit(skin, side)]
    if not sides:
        return ()
    eyes = "eyes are" if len(sides) > 1 else "eye is"
    return (
        f"its {' and '.join(sides)} {eyes} shut at rest, so these lids hardly move; for blinks and "
        "gaze, open them in a modelling program",
    )


def _is_slit(skin: SkinPiece, side: str) -> bool:
    """Whether the lids of an eye touch without being joined, except around its corners."""
    most_gap = 1.5  # [mm] between landmarks of touching lids, because margins of lids are rounded
    for above, below in LID_PAIRS[side]:
        over, under = skin.landmarks[[above, below]]
        between = skin.vertices[over] - skin.vertices[under]
        if np.linalg.norm(between[1:]) > most_gap:  # without x, because shut lids slide sideways
            return False
        across, around = _across_and_around(skin, (above, below), EYE_CORNERS[side])
        if across < JOINED_SHARE * around:
            return False
    return True


def _across_and_around(
    skin: SkinPiece, pair: tuple[int, int], corners: tuple[int, int]
) -> tuple[float, float]:
    """Measure two paths along the skin between landmarks above and below an opening [mm].

    The first path is the shortest one. The second is the shortest path around a corner of the
    opening.
    """
    paths = path_lengths(skin.vertices, skin.faces, skin.landmarks[list(pair)])
    ends = skin.landmarks[list(corners)]
    across = paths[0, skin.landmarks[pair[1]]]
    around = paths[:, ends].sum(axis=0).min()
    return float(across), float(around)


def without_bag(skin: SkinPiece) -> SkinPiece:
    """Remove a bag behind the lips: the built-in mouth replaces it; skin: in face space [mm]."""
    inner_lips = slice(60, 68)
    edge = skin.landmarks[inner_lips]
    graph = length_graph(skin.vertices, skin.faces)
    _, before = csgraph.dijkstra(graph, directed=False, indices=edge, return_predecessors=True)
    is_edge = np.zeros(len(skin.vertices), np.bool_)
    for from_start, end in zip(before, np.roll(edge, -1), strict=True):
        is_edge[path_to(end, from_start)] = True
    touches_edge = is_edge[skin.faces].any(axis=1)
    piece = pieces_of(skin.faces[~touches_edge], len(skin.vertices))
    landmark_pieces = piece[skin.landmarks[: inner_lips.start]]
    is_behind = ~is_edge & ~np.isin(piece, landmark_pieces)
    deepest = skin.vertices[is_behind, 2].min(initial=np.inf)
    least_bag_depth = 15.0  # [mm]
    if deepest > skin.vertices[is_edge, 2].mean() - least_bag_depth:
        return skin
    is_behind &= ~rim_behind(skin, is_edge, is_behind)
    left = np.flatnonzero(~is_behind[skin.faces].any(axis=1))
    part = skin_of(skin.vertices, skin.faces[left], skin.landmarks)
    return replace(
        part,
        file_vertices=skin.file_vertices[part.file_vertices],
        file_faces=skin.file_faces[left[part.file_faces]],
        is_turned=skin.is_turned,
    )


def rim_behind(skin: SkinPiece, is_edge: Flags, is_behind: Flags) -> Flags:
    """Return flags of the part of a bag that stays behind the lips, (V,).

    A rim of equal depth ends as saw teeth, which show from the side when lips are rounded. A rim of
    whole rows of vertices ends along edges of a regular mesh. The rim with the shorter border is
    the smoother one.

    is_edge: whether a vertex lies on the inner edge of the lips, (V,). is_behind: whether it
    belongs to the bag, (V,).
    """
    rim_depth = 4.0  # [mm]
    depth = scipy.spatial.cKDTree(skin.vertices[is_edge]).query(skin.vertices)[0]
    faces = skin.faces[(is_edge | is_behind)[skin.faces].all(axis=1)]
    rows = np.zeros(len(skin.vertices), np.bool_)
    row = is_edge
    reached = 0.0  # [mm] mean depth of the last row; that of the rim's last row is nearest to 4 mm
    while True:
        touches_row = row[faces].any(axis=1)
        beside = np.zeros(len(rows), np.bool_)
        beside[faces[touches_row]] = True
        row = beside & is_behind & ~rows
        if not row.any():
            break
        row_depth = float(depth[row].mean())
        if abs(row_depth - rim_depth) > abs(reached - rim_depth):
            break
        rows |= row
        reached = row_depth
    rims = rows, is_behind & (depth <= rim_depth)
    return min(rims, key=lambda rim: _border_length(skin, is_behind & ~rim))


def _border_length(skin: SkinPiece, is_removed: Flags) -> float:
    """Return the length of the borders of a skin [mm] without some of its vertices, (V,)."""
    loses_corner = is_removed[skin.faces].any(axis=1)
    border = border_edges(skin.faces[~loses_corner])
    return float(side_lengths(skin.vertices, border).sum())


def is_covered(corners: Floats64, point: Floats64) -> bool:
    """Whether a ray from the front meets a triangle near a point (3,); corners: (F, 3, 3) [mm]."""
    return bool(covering(corners, point).any())


def covering(corners: Floats64, point: Floats64) -> Flags:
    """Return flags of the triangles (F, 3, 3) that cover a point (3,) [mm], shape (F,)."""
    sides = np.roll(corners, -1, axis=1) - corners
    edge_x, edge_y, _ = np.moveaxis(sides, 2, 0)
    to_x, to_y, _ = np.moveaxis(point - corners, 2, 0)
    turn = edge_x * to_y - edge_y * to_x
    is_hit = (turn > -1e-6).all(axis=1) | (turn < 1e-6).all(axis=1)
    depth = corners[:, :, 2].mean(axis=1)
    return np.asarray(is_hit & (depth > point[2] - COVER_DEPTH))
