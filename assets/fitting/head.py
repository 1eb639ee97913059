"""Fit the built-in head's anatomy to another head by 68 landmarks.

    landmarks  ->  similarity to millimetres and the face space
               ->  warp of the built-in head  ->  depth of bone, texture
                                              ->  eyes, teeth, tongue, mouth

Muscles, jaw axis and what belongs to the mandible need no fitting: the rig is written in landmarks
(sim/rig.py) and its seeds for the jaw were fitted on scans. Carried over from the built-in head
instead, an open jaw was less like a scanned one (cosine 0.88 against 0.93, 2026-11-21).

Source: Kähler, Haber, Yamauchi, Seidel 2002, "Head shop".
Differs from it: no mesh is fitted to scanned points; the mesh that is brought is animated itself.
"""

from __future__ import annotations

import contextlib
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
import scipy

from risorius.geometry.normals import vertex_normals

from ...geometry.arrays import Floats32, Floats64, Integers32
from ..data_files import Image
from ..errors import AssetError
from ..loading import load
from ..meshes import Mesh, read_mesh
from ..model import Eye, FineShape, Head, Part, Wrinkles
from ..topology import boundary_loops
from ..user_files import named
from . import simplifying
from .landmark_file import (
    COUNT,
    UnfinishedError,
    check_lips,
    groups_in_disorder,
    read_landmarks,
)
from .mesh_validation import (
    ShutMouthError,
    SkinPiece,
    check_manifold,
    check_openings,
    skin_of,
    with_seams_joined,
    without_bag,
)
from .mouth_walls import FittedSkin
from .organs import place_eyes, place_parts, with_eyelid_rims
from .painting import Layout, drawn_over, maps_in, own_picture, plain_skin, spread_uv
from .topologies import recognised
from .warp import Similarity, ThinPlateSpline, nearest_on

ORIENTING = slice(17, COUNT)  # without the jaw line, which everybody places elsewhere


@dataclass(frozen=True)
class FittedHead(simplifying.SimulatedHead):
    """A head that somebody brought, with all that `sim.create` and a renderer read.

    The attributes are those of `Head`, in its millimetres and axes, but for the jaw's, which
    `sim.create` finds by the landmarks. What hangs together with no landmark (eyeballs, teeth of
    the mesh's own) was left away.

    to_millimetres: takes the file's coordinates to these.
    file_vertices: numbers in the file of the vertices, or of the nearest, shape (V,), int32.
    notes: changes of the mesh that its owner should know, a line each.
    called: its name or number, "" where it has none.
    simplified: the mesh to simulate instead, where this one has too many triangles; else None.
    files: of the mesh and its landmarks, where it was read from such.
    """

    uv: Floats32
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

    def fade(self) -> tuple[float, float, float, float] | None:
        """A x + b y + c z + d is 0 along the neck's edge, 1 FADE above; None: there is no edge.

        Skin that ends in the middle of a picture may fade so toward its end.
        """
        chin_landmark = 8
        chin = self.vertices[self.landmarks[chin_landmark]]
        eye_landmarks = slice(36, 48)
        eyes = self.vertices[self.landmarks[eye_landmarks], 1].mean()
        edges = [self.vertices[loop] for loop in boundary_loops(self.faces)]
        edges = [edge for edge in edges if edge[:, 1].max() < eyes]  # that of a mask goes around it
        ways = [np.roll(edge, -1, axis=0) - edge for edge in edges]
        points, along = (np.vstack([np.empty((0, 3)), *each]) for each in (edges, ways))
        is_level = np.abs(along[:, 1]) < 0.5 * np.linalg.norm(along, axis=1)  # not of a half head
        points = points[is_level & (points[:, 1] < chin[1])]
        if len(points) < 3:
            return None
        up = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2][2]
        up = up * np.sign(up[1]) if abs(up[1]) > 0.5 else np.array([0.0, 1.0, 0.0])
        bottom = float((points @ up).max())
        full_height = 25.0  # [mm] above a neck's edge, at most half the way to the chin
        height = min(full_height, 0.5 * (float(chin @ up) - bottom))
        a, b, c = (up / max(height, 1e-9)).tolist()
        return (a, b, c, -bottom / height) if height > 0.0 else None


def fit_head(mesh: str | Path, landmarks: str | Path | None = None) -> FittedHead:
    """Read a mesh and its landmark file (see landmark_file.py) and fit the built-in head to it.

    landmarks: None for a mesh whose vertices are known by their numbers, see topologies.py.
    Raises AssetError, one line that names the file, where a file is missing, broken or unusable;
    its subclass UnfinishedError where landmarks are missing.
    """
    found = read_mesh(mesh)
    if landmarks is None:
        return _fit_known(found, Path(mesh))
    files = (Path(mesh), Path(landmarks))
    numbers, points = read_landmarks(files[1], found)
    try:
        try:
            return replace(fit(found, numbers, points=points), files=files)
        except ShutMouthError:
            parted = lips_parted(found, found.vertices[numbers] if points is None else points)
            if parted is None:
                raise
            numbers, points = read_landmarks(files[1], parted)
            return replace(fit(parted, numbers, points=points), files=files)
    except AssetError as error:
        reason = error
        is_face = [_is_face(found.vertices[numbers - first]) for first in (0, 1)]
        if points is None and is_face == [False, True]:
            reason = AssetError("landmarks count vertices from 1; count from 0: take 1 off each")
        raise AssetError(f"{named(mesh)}: {reason}") from None


def _fit_known(mesh: Mesh, path: Path) -> FittedHead:
    """Fit a mesh whose landmarks are known; its errors are those of `fit_head`."""
    known = recognised(mesh)
    if known is None:
        raise UnfinishedError(
            f"{named(path)}: its vertices are those of no known head, so mesh and landmark file "
            "go together; `risorius view --head MESH` helps to mark the landmarks"
        )
    note = f"its vertices are those of {known.name}, whose landmarks are known"
    try:
        fitted = fit(mesh, known.landmarks)
    except AssetError as error:
        raise AssetError(f"{named(path)}: {note}; but {error}") from None
    return replace(fitted, files=(path,), notes=(note, *fitted.notes))


def lips_parted(mesh: Mesh, landmarks: Floats64) -> Mesh | None:
    """The mesh with those vertices apart that its file doubles where the lips touch.

    A file doubles vertices along seams of its texture, and the reader makes them one; between lips
    they are not. landmarks: where they lie [unit of the mesh], shape (68, 3). None where no vertex
    is doubled there.
    """
    if mesh.corners is None or mesh.same is None:
        return None
    upper_lip = (60, 61, 62, 63, 64)
    lower_lip = (60, 67, 66, 65, 64)
    line = (landmarks[list(upper_lip)] + landmarks[list(lower_lip)]) / 2.0
    # Share of the way between the outer eye corners: lips that touch lie nearer to their line.
    most_gap = 0.01
    near = most_gap * float(np.linalg.norm(np.diff(landmarks[[36, 45]], axis=0)))
    place_count = 33  # on each part of that line
    steps = np.linspace(0.0, 1.0, place_count)[:, None, None]
    places = (line[:-1] + steps * np.diff(line, axis=0)).reshape(-1, 3)
    off = scipy.spatial.cKDTree(places).query(mesh.vertices)[0]
    at_corner = scipy.spatial.cKDTree(line[[0, -1]]).query(mesh.vertices)[0] < near
    is_lip = (off < near) & ~at_corner
    same = np.where(is_lip, np.arange(len(mesh.vertices)), mesh.same)
    if np.array_equal(same, mesh.same):
        return None
    return replace(mesh, faces=same[mesh.corners].astype(np.int32), same=same)


def fit(mesh: Mesh, landmarks: Integers32, *, points: Floats64 | None = None) -> FittedHead:
    """Fit the built-in head to a mesh with 68 landmarks.

    landmarks: vertex numbers, shape (68,); points: where they lie exactly [unit of the mesh], shape
    (68, 3), unless at those vertices. Raises AssetError for a mesh that cannot work.
    """
    known = load("head")
    points = mesh.vertices[landmarks] if points is None else points
    faces, landmarks = with_seams_joined(mesh.vertices, mesh.faces, landmarks)
    skin = skin_of(mesh.vertices, faces, landmarks)
    check_manifold(faces[skin.file_faces], skin.file_faces)
    similarity = _placed(points, known)
    skin = _sound(replace(skin, vertices=similarity.points(skin.vertices)))
    own = None
    if mesh.texture is not None:
        own = own_picture(mesh.texture, skin.file_faces, skin.is_turned)
    target = similarity.points(points)
    notes = mesh.notes
    simplified = None
    if len(skin.faces) > simplifying.MOST_SIMULATED:
        coarse = simplifying.simplified(skin, target)
        count = len(coarse.faces)
        notes += (f"its {len(skin.faces)} triangles follow a simplified mesh of {count}",)
        carried = _carried_over(known, coarse, target)
        simplified = simplifying.SimulatedHead(
            vertices=coarse.vertices,
            faces=coarse.faces,
            landmarks=coarse.landmarks,
            bone_depth=carried.bone_depth,
            eyes=carried.eyes,
            parts=carried.parts,
            rig=known.rig,
            layers=known.layers,
        )
        carried = _on_finer(carried, coarse, skin)
    else:
        carried = _carried_over(known, skin, target)
    layout, albedo, maps = _painted(mesh, own, skin, Layout(carried.uv, skin.faces))
    wrinkles, segments, light = maps
    return FittedHead(
        vertices=skin.vertices,
        faces=skin.faces,
        landmarks=skin.landmarks,
        bone_depth=carried.bone_depth,
        eyes=carried.eyes,
        parts=with_eyelid_rims(carried.parts, skin.vertices, skin.faces, carried.eyes),
        uv=layout.uv,
        face_uv=layout.face_uv,
        albedo=albedo,
        wrinkles=replace(wrinkles, across=carried.across),
        segments=segments,
        ambient_occlusion=light,
        rig=known.rig,
        layers=known.layers,
        to_millimetres=similarity,
        file_vertices=skin.file_vertices,
        notes=notes,
        simplified=simplified,
    )


class _Carried(NamedTuple):
    """All that is carried over from the built-in head to a skin of V vertices."""

    eyes: tuple[Eye, ...]
    parts: tuple[Part, ...]
    uv: Floats32  # (V, 2) in the built-in picture
    across: Floats32  # (V, 3) of wrinkles
    bone_depth: Floats64  # (V,) [mm]


def _carried_over(known: Head, skin: SkinPiece, target: Floats64) -> _Carried:
    """Warp the built-in head to a skin [mm] whose 68 landmarks lie at `target`, and read it off."""
    normals = vertex_normals(skin.vertices, skin.faces)
    warp = ThinPlateSpline(known.vertices[known.landmarks], target)
    warped = warp.points(known.vertices)
    nearest = nearest_on(skin.vertices, normals, warped, known.faces)
    weight = nearest.interpolate(known.mandible_weight)
    fitted = FittedSkin(skin.vertices, normals, skin.faces, target, weight)
    eyes = place_eyes(known, fitted)
    parts = place_parts(known, fitted, warp, eyes)
    neck_part = "neck"  # the shirt of the built-in head, which has its shoulders
    return _Carried(
        eyes=eyes,
        # Landmarks do not say exactly enough where a lid ends for lashes and tears.
        parts=tuple(part for part in parts if part.bone != neck_part and part.roots is None),
        uv=spread_uv(known, warped, nearest, (skin.vertices, normals, skin.faces)),
        across=nearest.interpolate(known.wrinkles.across).astype(np.float32),
        bone_depth=nearest.interpolate(known.bone_depth),
    )


def _on_finer(carried: _Carried, coarse: SkinPiece, fine: SkinPiece) -> _Carried:
    """The same for the skin of which `coarse` is the simplified mesh."""
    normals = vertex_normals(fine.vertices, fine.faces)
    nearest = nearest_on(fine.vertices, normals, coarse.vertices, coarse.faces)
    return carried._replace(
        uv=nearest.interpolate(carried.uv).astype(np.float32),
        across=nearest.interpolate(carried.across).astype(np.float32),
        bone_depth=nearest.interpolate(carried.bone_depth),
    )


def _sound(skin: SkinPiece) -> SkinPiece:
    """The skin [mm] facing outward, without what lies behind its lips; AssetError if unusable."""
    _check_size(skin)
    skin = _facing_outward(skin)
    check_openings(skin)
    check_lips(skin)
    return without_bag(skin)


def _painted(
    mesh: Mesh,
    own: tuple[Image, Layout] | None,
    skin: SkinPiece,
    built_in: Layout,
) -> tuple[Layout, Image, tuple[Wrinkles, Image, Image]]:
    """The picture of the skin, its layout, and maps in this layout (see `maps_in`).

    own: the file's picture of the skin, None where it has none. built_in: layout of the skin in
    the built-in picture.
    """
    known = load("head")
    if own is not None:
        height, width = own[0].shape[:2]
        return own[1], own[0], maps_in(known, built_in, own[1], (height, width))
    picture, light = plain_skin(known)
    has_colours = mesh.colours is not None
    if mesh.has_colour is not None:
        has_colours = bool(mesh.has_colour[skin.file_vertices].all())
    if has_colours and mesh.colours is not None:
        colours = mesh.colours[skin.file_vertices].astype(np.float64)
        picture = drawn_over(picture, built_in, colours[skin.faces])
    return built_in, picture, (known.wrinkles, known.segments, light)


def _placed(points: Floats64, known: Head) -> Similarity:
    """The similarity to millimetres and the face space; AssetError if this is no face."""
    template = known.vertices[known.landmarks]
    extent = np.ptp(points[ORIENTING], axis=0).max()
    least_size = 1e-9  # between the outermost landmarks: below it, squares leave too few digits
    if extent < least_size:
        raise AssetError(
            f"the landmarks lie within {extent:.3g} units; allowed are {least_size:g} and more: "
            "give 68 different ones, in metres or millimetres"
        )
    similarity = Similarity.between(points[ORIENTING], template[ORIENTING])
    off = np.linalg.norm(similarity.points(points) - template, axis=1)
    disordered = groups_in_disorder(similarity.points(points), template)
    farthest_from_a_face = 14.0  # [mm] mean distance of landmarks from those of the built-in head
    is_far = off[ORIENTING].mean() > farthest_from_a_face
    most_disordered = 3  # groups of landmarks: with more of them no order is meant
    if disordered and not (is_far and len(disordered) > most_disordered):
        _check_different(similarity.points(points), template)
        raise AssetError(disordered[0].complaint)
    if is_far:
        raise AssetError(
            f"the landmarks are no face: landmark {off.argmax()} lies {off.max():.0f} mm off, the "
            f"mean one {off[ORIENTING].mean():.0f} mm; give the 68 iBug points in their order"
        )
    if similarity.is_mirrored:
        raise AssetError(
            "left and right are swapped in the landmarks, or the mesh is mirrored; landmarks 0-16 "
            "run from the subject's right ear to the left one, 36-41 are the right eye"
        )
    _check_different(similarity.points(points), template)
    return similarity


def _is_face(points: Floats64) -> bool:
    """Whether landmarks [unit of the mesh] are those of a face, in their order."""
    with contextlib.suppress(AssetError):
        return bool(_placed(points, load("head")))
    return False


def _check_size(skin: SkinPiece) -> None:
    """AssetError for a vertex [mm] that is nowhere near the face."""
    off = np.linalg.norm(skin.vertices, axis=1)
    most_distance = 10_000.0  # [mm] from the middle of the face: farther off, a vertex is a mistake
    if off.max() > most_distance:
        where = int(off.argmax())
        raise AssetError(
            f"vertex {skin.file_vertices[where]} lies {off[where] / 1000.0:.3g} m off the face; "
            f"allowed are {most_distance / 1000.0:g} m: remove stray vertices and "
            "everything that is not the head"
        )


def _check_different(points: Floats64, template: Floats64) -> None:
    """AssetError where landmarks [mm] that are far apart on any face are one place."""
    ways, known = (np.linalg.norm(x[:, None] - x[None], axis=2) for x in (points, template))
    # Landmarks so far apart on the built-in head cannot be one place: no muscle spans no way.
    least_built_in_distance = 30.0  # [mm]
    a, b = np.unravel_index(
        (ways + np.where(known > least_built_in_distance, 0.0, np.inf)).argmin(), ways.shape
    )
    least_distance = 1.0  # [mm]
    if ways[a, b] < least_distance:
        raise AssetError(
            f"landmarks {a} and {b} are {ways[a, b]:.2g} mm apart, on the built-in head "
            f"{known[a, b]:.0f} mm; give each its own place"
        )


def _facing_outward(skin: SkinPiece) -> SkinPiece:
    """The same skin with its triangles counter-clockwise seen from outside."""
    normals = vertex_normals(skin.vertices, skin.faces)
    if normals[skin.landmarks[ORIENTING], 2].mean() > 0.0:
        return skin
    return replace(skin, faces=np.ascontiguousarray(skin.faces[:, ::-1]), is_turned=True)
