"""Fit the built-in head's anatomy to a user's head by 68 landmarks.

    landmarks  ->  similarity to millimetres and the face space
               ->  warp of the built-in head  ->  depth of bone, texture
                                              ->  weights of the mandible
                                              ->  eyes, teeth, tongue, mouth

Muscles need no fitting, because the rig names landmarks (sim/rig.py). Each skin vertex takes its
weight of the mandible's motion from the built-in head, so that chins of all heads follow the jaw
equally stiffly.

Source: Kähler, Haber, Yamauchi, Seidel 2002, "Head shop". That paper fits a mesh to scanned points;
here the user's mesh itself is animated.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ...geometry.arrays import Floats32, Floats64, Integers32
from ...geometry.mesh_graph import pieces_of
from ...geometry.normals import vertex_normals
from ..data_files import Image
from ..errors import AssetError
from ..loading import load
from ..meshes import Mesh, read_mesh
from ..model import Eye, FineShape, Head, Part, Wrinkles
from ..user_files import named
from . import simplifying
from .coarse_painting import TexturePlaces, repainted, small_triangles, texture_places
from .face_place import ORIENTING_LANDMARKS, is_face, placed
from .fillings import filling_of
from .jaw_place import jaw_axis_of, with_human_opening
from .landmark_file import (
    LANDMARK_COUNT,
    MisfitError,
    UnfinishedError,
    check_lips,
    nearest_vertices,
    read_landmarks,
)
from .lips import LipCut, lip_cut, lips_parted
from .mesh_validation import (
    CoveredError,
    ShutMouthError,
    SkinPiece,
    check_manifold,
    check_openings,
    check_size,
    notes_of_shut_eyes,
    skin_of,
    vertices_of_pieces,
    with_seams_joined,
    without_bag,
)
from .mouth_walls import FittedSkin, opened_jaws
from .neck_fading import fading_last, neck_fade
from .organs import place_eyes, place_parts, with_eyelid_rims
from .own_lip import nearest_own
from .painting import TextureLayout, drawn_over, maps_in, own_picture, own_skin, spread_uv
from .topologies import recognised
from .warp import Similarity, landmark_warp, nearest_on


@dataclass(frozen=True)
class FittedHead(simplifying.SimulatedHead):
    """A user's head with all data for `sim.create` and a renderer.

    It has the attributes of `Head`, in the face space [mm]. Pieces of the mesh without a landmark,
    such as eyeballs and teeth, are left out.

    to_millimetres: similarity from the file's coordinates to the face space.
    file_vertices: for each vertex the index of the nearest vertex in the file, (V,), int32.
    notes: changes of the mesh that the user should know, one line for each.
    called: name or number of the head; "" if it has none.
    simplified: simulated mesh of a head with too many triangles; None for other heads.
    files: paths of the mesh and of the landmark file; empty if the head was not read from files.
    lip_cut: the cut between lips that are joined in the file; None for other heads.
    """

    face_uv: Integers32
    albedo: Image
    wrinkles: Wrinkles
    segments: Image
    ambient_occlusion: Image
    to_millimetres: Similarity
    file_vertices: Integers32
    notes: tuple[str, ...] = field(default=(), kw_only=True)
    fine_shape: FineShape | None = field(default=None, kw_only=True)
    called: str = field(default="", kw_only=True)
    simplified: simplifying.SimulatedHead | None = field(default=None, kw_only=True)
    files: tuple[Path, ...] = field(default=(), kw_only=True)
    lip_cut: LipCut | None = field(default=None, kw_only=True)

    def fade(self) -> Floats32 | None:
        """Return the result of `neck_fade`, (V, 2): how the skin fades at the neck."""
        return neck_fade(self.vertices, self.faces, self.landmarks)


def fit_head(mesh: str | Path, landmarks: str | Path | None = None) -> FittedHead:
    """Read a mesh and its landmark file (see landmark_file.py), and fit the built-in head to it.

    landmarks: path of the landmark file; None for a mesh of a known topology (topologies.py).

    Raises AssetError if a file is missing, broken or unusable. Raises its subclass UnfinishedError
    if landmarks are missing, or if the landmarks of a known topology do not fit.
    """
    path = Path(mesh)
    found = read_mesh(path)
    if landmarks is None:
        return _fit_known_topology(found, path)
    file = Path(landmarks)
    indices, points = read_landmarks(file, found)
    try:
        fitted = _fit_shut_or_not(found, (indices, points), partial(read_landmarks, file))
    except AssetError as error:
        reason = error
        are_faces = [is_face(found.vertices[indices - first]) for first in (0, 1)]
        if points is None and are_faces == [False, True]:
            reason = AssetError(
                "vertex indices of the landmarks count from 1; subtract 1 from each"
            )
        raise AssetError(f"{named(mesh)}: {reason}") from None
    return replace(fitted, files=(path, file))


LandmarksAndPoints = tuple[Integers32, Floats64 | None]  # landmarks, see `read_landmarks`


def _fit_shut_or_not(
    mesh: Mesh, marks: LandmarksAndPoints, marks_of: Callable[[Mesh], LandmarksAndPoints]
) -> FittedHead:
    """Fit a mesh; if skin covers mouth or eyes, remove fillings and part joined lips first.

    marks_of: function that returns the landmarks of a mesh with the same vertices, but other
        triangles.
    """
    indices, points = marks
    landmark_points = mesh.vertices[indices] if points is None else points
    try:
        return fit(mesh, indices, points=points)
    except CoveredError as error:
        reason = error
    filling = filling_of(mesh, indices, landmark_points)
    if filling is not None:
        opened = mesh.without(filling.triangles)
        fitted = _fit_shut_or_not(opened, marks_of(opened), marks_of)
        return replace(fitted, notes=(*fitted.notes, filling.in_words))
    if not isinstance(reason, ShutMouthError):
        raise reason
    parted = lips_parted(mesh, landmark_points)
    if parted is not None:
        parted_indices, parted_points = marks_of(parted)
        with contextlib.suppress(ShutMouthError):
            return fit(parted, parted_indices, points=parted_points)
    cut = lip_cut(mesh, indices, landmark_points)
    if cut is None:
        raise reason
    opened = cut.applied(mesh)
    try:
        fitted = fit(opened, cut.landmarks, points=cut.points)
    except AssetError as error:
        raise AssetError(f"{cut.in_words}; but {error}") from None
    return replace(fitted, lip_cut=cut, notes=(*fitted.notes, cut.in_words))


def _fit_known_topology(mesh: Mesh, path: Path) -> FittedHead:
    """Fit a mesh of a known topology; raises the errors of `fit_head`."""
    known = recognised(mesh)
    if known is None:
        raise UnfinishedError(
            f"{named(path)}: needs a landmark file, because the topology of its mesh is unknown; "
            "mark the landmarks in the window: `risorius view --head MESH`"
        )

    def marks_of(parted: Mesh) -> LandmarksAndPoints:
        """Return the known landmarks; inner lips that were parted get vertices of their own lip."""
        indices = known.landmarks
        nearest = nearest_vertices(mesh.vertices[indices], parted.vertices, parted.faces)
        inner_lips = np.arange(LANDMARK_COUNT) >= 60
        return np.where(inner_lips, nearest, indices), None

    note = f"its vertices are those of {known.name}, whose landmarks are known"
    try:
        fitted = _fit_shut_or_not(mesh, (known.landmarks, None), marks_of)
    except AssetError as error:
        raise MisfitError(
            f"{named(path)}: {note}; but {error}; else mark its landmarks: "
            "`risorius view --head MESH`"
        ) from None
    return replace(fitted, files=(path,), notes=(note, *fitted.notes))


def fit(mesh: Mesh, landmarks: Integers32, *, points: Floats64 | None = None) -> FittedHead:
    """Fit the built-in head to a mesh with 68 landmarks.

    landmarks: vertex indices, (68,). points: exact positions [unit of the mesh], (68, 3); None for
    the positions of the vertices. Raises AssetError for an unusable mesh.
    """
    known = load("head")
    are_exact = points is not None
    points = mesh.vertices[landmarks] if points is None else points
    faces, landmarks = with_seams_joined(mesh.vertices, mesh.faces, landmarks)
    skin = skin_of(mesh.vertices, faces, landmarks)
    check_manifold(faces[skin.file_faces])
    similarity = placed(points, known)
    skin = _checked_skin(replace(skin, vertices=similarity.points(skin.vertices)))
    own = None
    if mesh.texture is not None:
        own = own_picture(mesh.texture, skin.file_faces, skin.is_turned)
    target = similarity.points(points)
    pieces = tuple(similarity.points(each) for each in _beside_skin(mesh.vertices, faces, skin))
    jaw = _jaw_of(known, skin, target)
    notes = mesh.notes + notes_of_shut_eyes(skin)
    simplified = None
    if len(skin.faces) > simplifying.MOST_SIMULATED:
        coarse = simplifying.simplified(skin, target)
        count = len(coarse.faces)
        notes += (f"its {len(skin.faces)} triangles follow a simplified mesh of {count}",)
        carried = _carried_over(known, coarse, target, pieces, jaw)
        simplified = _simulated_head(known, coarse, carried, jaw)
        carried = _on_finer(carried, coarse, skin)
    else:
        carried = _carried_over(known, skin, target, pieces, jaw)
    places = texture_places(known, skin, target, are_exact, carried.uv)
    layout, albedo, maps = _skin_layout(mesh, own, skin, places)
    wrinkles, segments, light = maps
    order = fading_last(skin.vertices, skin.faces, skin.landmarks)
    return FittedHead(
        vertices=skin.vertices,
        faces=skin.faces[order],
        landmarks=skin.landmarks,
        bone_depth=carried.bone_depth,
        mandible_weight=carried.mandible_weight,
        eyes=carried.eyes,
        parts=with_eyelid_rims(carried.parts, skin.vertices, skin.faces, carried.eyes),
        uv=layout.uv,
        face_uv=layout.face_uv[order],
        albedo=albedo,
        wrinkles=replace(wrinkles, across=carried.across),
        segments=segments,
        ambient_occlusion=light,
        jaw_axis=jaw.axis,
        rig=jaw.rig,
        layers=known.layers,
        to_millimetres=similarity,
        file_vertices=skin.file_vertices,
        notes=notes,
        simplified=simplified,
    )


class _Jaw(NamedTuple):
    """The axis of a head's jaw, and the rig with the angle by which the jaw opens."""

    axis: Floats64  # (2, 3) [mm]
    rig: dict[str, Any]


def _jaw_of(known: Head, skin: SkinPiece, target: Floats64) -> _Jaw:
    """Find the jaw of a skin [mm] with the landmarks `target`, (68, 3) [mm]."""
    axis = jaw_axis_of(skin.vertices, skin.faces, target)
    return _Jaw(axis, with_human_opening(known.rig, axis, target))


def _beside_skin(vertices: Floats64, faces: Integers32, skin: SkinPiece) -> list[Floats64]:
    """Return the vertices (n, 3) of each piece of a mesh except the skin."""
    piece = pieces_of(faces, len(vertices))
    own = piece[skin.file_vertices[0]]
    groups = vertices_of_pieces(piece, faces)
    return [vertices[group] for group in groups if piece[group[0]] != own]


class _Carried(NamedTuple):
    """Data of the built-in head, carried over to a skin of V vertices."""

    eyes: tuple[Eye, ...]
    parts: tuple[Part, ...]
    uv: Floats32  # (V, 2) texture coordinates in the built-in texture
    across: Floats32  # (V, 3) directions across wrinkles
    bone_depth: Floats64  # (V,) [mm]
    mandible_weight: Floats64  # (V,)


def _carried_over(
    known: Head, skin: SkinPiece, target: Floats64, pieces: tuple[Floats64, ...], jaw: _Jaw
) -> _Carried:
    """Warp the built-in head to a skin [mm] with landmarks `target`, and carry its data over."""
    normals = vertex_normals(skin.vertices, skin.faces)
    warp = landmark_warp(known.vertices[known.landmarks], target)
    warped = warp.points(known.vertices)
    nearest = nearest_own(known, warped, skin, normals)
    weight = nearest.interpolate(known.mandible_weight)
    fitted = FittedSkin(skin.vertices, normals, skin.faces, target, weight, pieces)
    eyes = place_eyes(known, fitted)
    parts = place_parts(known, fitted, warp, eyes, opened_jaws(jaw.axis, jaw.rig))
    neck_part = "neck"  # bone of the built-in shirt, which fits no other shoulders
    return _Carried(
        eyes=eyes,
        # Landmarks do not give the edges of lids precisely enough for lashes and tears.
        parts=tuple(part for part in parts if part.bone != neck_part and part.roots is None),
        uv=spread_uv(known, warped, nearest, (skin.vertices, normals, skin.faces)),
        across=nearest.interpolate(known.wrinkles.across).astype(np.float32),
        bone_depth=nearest.interpolate(known.bone_depth),
        mandible_weight=weight,
    )


def _simulated_head(
    known: Head, coarse: SkinPiece, carried: _Carried, jaw: _Jaw
) -> simplifying.SimulatedHead:
    """Make the simulated head of a simplified mesh."""
    return simplifying.SimulatedHead(
        vertices=coarse.vertices,
        faces=coarse.faces,
        landmarks=coarse.landmarks,
        bone_depth=carried.bone_depth,
        mandible_weight=carried.mandible_weight,
        eyes=carried.eyes,
        parts=carried.parts,
        jaw_axis=jaw.axis,
        rig=jaw.rig,
        layers=known.layers,
        uv=carried.uv,
    )


def _on_finer(carried: _Carried, coarse: SkinPiece, fine: SkinPiece) -> _Carried:
    """Interpolate data on the simplified mesh `coarse` at the vertices of the dense skin `fine`."""
    normals = vertex_normals(fine.vertices, fine.faces)
    nearest = nearest_on(fine.vertices, normals, coarse.vertices, coarse.faces)
    return carried._replace(
        uv=nearest.interpolate(carried.uv).astype(np.float32),
        across=nearest.interpolate(carried.across).astype(np.float32),
        bone_depth=nearest.interpolate(carried.bone_depth),
        mandible_weight=nearest.interpolate(carried.mandible_weight),
    )


def _checked_skin(skin: SkinPiece) -> SkinPiece:
    """Check a skin [mm], turn it outward, and remove a bag behind its lips.

    Raises AssetError for an unusable skin.
    """
    check_size(skin)
    skin = _facing_outward(skin)
    check_openings(skin)
    check_lips(skin)
    return without_bag(skin)


def _skin_layout(
    mesh: Mesh,
    own: tuple[Image, TextureLayout] | None,
    skin: SkinPiece,
    places: TexturePlaces,
) -> tuple[TextureLayout, Image, tuple[Wrinkles, Image, Image]]:
    """Return layout and texture of the skin, and maps in this layout (see `maps_in`).

    own: texture of the file, and its layout; None if the file has no texture.
    """
    known = load("head")
    if own is not None:
        height, width = own[0].shape[:2]
        drawn = small_triangles(own[1], places.cuts)
        return own[1], own[0], maps_in(known, places.small, drawn, (height, width))
    picture, light = own_skin(known, skin)
    maps = (known.wrinkles, known.segments, light)
    if places.cuts:
        picture, maps = repainted(known, skin, places, picture)
    has_colours = mesh.colours is not None
    if mesh.has_colour is not None:
        has_colours = bool(mesh.has_colour[skin.file_vertices].all())
    if has_colours and mesh.colours is not None:
        colours = mesh.colours[skin.file_vertices].astype(np.float64)
        picture = drawn_over(picture, places.own, colours[skin.faces])
    return places.own, picture, maps


def _facing_outward(skin: SkinPiece) -> SkinPiece:
    """Turn the triangles of a skin, if necessary, to run counter-clockwise seen from outside."""
    normals = vertex_normals(skin.vertices, skin.faces)
    if normals[skin.landmarks[ORIENTING_LANDMARKS], 2].mean() > 0.0:
        return skin
    return replace(skin, faces=np.ascontiguousarray(skin.faces[:, ::-1]), is_turned=True)
