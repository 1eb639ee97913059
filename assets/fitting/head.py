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

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import AssetError
from ..files import Image
from ..loading import load
from ..meshes import Mesh, read_mesh
from ..model import (
    Eye,
    FloatArray,
    Head,
    IndexArray,
    Layer,
    Part,
    SingleArray,
    Wrinkles,
)
from ..topology import vertex_normals
from ..user_files import named
from .landmark_file import COUNT, read_landmarks
from .organs import FittedSkin, place_eyes, place_parts
from .soundness import SkinPiece, check_manifold, check_openings, skin_of
from .warp import Similarity, Warp, nearest_on

ORIENTING = slice(17, COUNT)  # without the jaw line, which everybody places elsewhere
SMALLEST = 1e-9  # between the outermost landmarks: below it, squares leave too few digits
LARGEST = 10_000.0  # [mm] from the middle of the face: farther off, a vertex is a mistake
# Landmarks so far apart on the built-in head cannot be one place: no muscle spans no way.
APART = 30.0  # [mm]
ONE_PLACE = 1.0  # [mm]
NECK = "neck"  # what hangs there, a shirt, is the built-in head's: another may have its shoulders
TEARS = "wet_edges"  # half a millimetre wide: landmarks do not say where lids end so exactly
FARTHEST_FROM_A_FACE = 14.0  # [mm] mean distance of landmarks from those of the built-in head


@dataclass(frozen=True)
class FittedHead:
    """A head that somebody brought, with all that `sim.create` and a renderer ask for.

    The attributes are those of `Head`, in its millimetres and axes, but for the jaw's, which
    `sim.create` finds by the landmarks. What hangs together with no landmark (eyeballs, teeth of
    the mesh's own) was left away.

    to_millimetres: takes the file's coordinates to these.
    file_vertices: numbers in the file of the vertices, shape (V,), int32.
    """

    vertices: FloatArray
    faces: IndexArray
    landmarks: IndexArray
    bone_depth: FloatArray
    eyes: tuple[Eye, ...]
    parts: tuple[Part, ...]
    uv: SingleArray
    face_uv: IndexArray
    albedo: Image
    wrinkles: Wrinkles
    segments: Image
    rig: dict[str, Any]
    layers: tuple[Layer, ...]
    to_millimetres: Similarity
    file_vertices: IndexArray


def fit_head(mesh: str | Path, landmarks: str | Path) -> FittedHead:
    """Read a mesh and its landmark file (see landmark_file.py) and fit the built-in head to it.

    Raises AssetError, one line that names the file, for what is missing, broken or cannot work.
    """
    found = read_mesh(mesh)
    numbers, points = read_landmarks(Path(landmarks), found)
    try:
        return fit(found, numbers, points=points)
    except AssetError as error:
        raise AssetError(f"{named(mesh)}: {error}") from None


def fit(
    mesh: Mesh,
    landmarks: IndexArray,
    *,
    points: FloatArray | None = None,
    template: Head | None = None,
) -> FittedHead:
    """Fit a head (`template`, the built-in one unless told) to a mesh with 68 landmarks.

    landmarks: vertex numbers, shape (68,); points: where they lie exactly [unit of the mesh], shape
    (68, 3), unless at those vertices. Raises AssetError for a mesh that cannot work.
    """
    points = mesh.vertices[landmarks] if points is None else points
    known = load("head") if template is None else template
    skin = skin_of(mesh.vertices, mesh.faces, landmarks)
    check_manifold(mesh.faces)
    similarity = _placed(points, known)
    skin = replace(skin, vertices=similarity.points(skin.vertices))
    _check_size(skin)
    skin = _facing_outward(skin)
    check_openings(skin)
    normals = vertex_normals(skin.vertices, skin.faces)
    target = similarity.points(points)
    warp = Warp(*_distinct(known.vertices[known.landmarks], target))
    warped = warp.points(known.vertices)
    nearest = nearest_on(skin.vertices, normals, warped, known.faces)
    weight = nearest.interpolate(known.mandible_weight)
    fitted = FittedSkin(skin.vertices, normals, target, weight)
    eyes = place_eyes(known, fitted)
    return FittedHead(
        vertices=skin.vertices,
        faces=skin.faces,
        landmarks=skin.landmarks,
        bone_depth=nearest.interpolate(known.bone_depth),
        eyes=eyes,
        parts=tuple(
            part
            for part in place_parts(known, fitted, warp, eyes)
            if part.bone != NECK and part.name != TEARS
        ),
        uv=nearest.interpolate(known.uv).astype(np.float32),
        face_uv=skin.faces,
        albedo=known.albedo,
        wrinkles=replace(
            known.wrinkles, across=nearest.interpolate(known.wrinkles.across).astype(np.float32)
        ),
        segments=known.segments,
        rig=known.rig,
        layers=known.layers,
        to_millimetres=similarity,
        file_vertices=skin.file_vertices,
    )


def _placed(points: FloatArray, known: Head) -> Similarity:
    """The similarity to millimetres and the face space; AssetError if this is no face."""
    template = known.vertices[known.landmarks]
    extent = np.ptp(points[ORIENTING], axis=0).max()
    if extent == 0.0:
        raise AssetError("all landmarks are one point; give 68 different ones")
    if extent < SMALLEST:
        raise AssetError(
            f"the landmarks lie within {extent:.3g} units; allowed are {SMALLEST:g} and more: "
            "save the mesh in metres or millimetres"
        )
    similarity = Similarity.between(points[ORIENTING], template[ORIENTING])
    off = np.linalg.norm(similarity.points(points) - template, axis=1)
    if off[ORIENTING].mean() > FARTHEST_FROM_A_FACE:
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


def _check_size(skin: SkinPiece) -> None:
    """AssetError for a vertex [mm] that is nowhere near the face."""
    off = np.linalg.norm(skin.vertices, axis=1)
    if off.max() > LARGEST:
        where = int(off.argmax())
        raise AssetError(
            f"vertex {skin.file_vertices[where]} lies {off[where] / 1000.0:.3g} m off the face; "
            f"allowed are {LARGEST / 1000.0:g} m: remove stray vertices and whatever is not the "
            "head"
        )


def _check_different(points: FloatArray, template: FloatArray) -> None:
    """AssetError where landmarks [mm] that are far apart on any face are one place."""
    ways, known = (np.linalg.norm(x[:, None] - x[None], axis=2) for x in (points, template))
    a, b = np.unravel_index((ways + np.where(known > APART, 0.0, np.inf)).argmin(), ways.shape)
    if ways[a, b] < ONE_PLACE:
        raise AssetError(
            f"landmarks {a} and {b} are {ways[a, b]:.2g} mm apart, on the built-in head "
            f"{known[a, b]:.0f} mm; give each its own place"
        )


def _facing_outward(skin: SkinPiece) -> SkinPiece:
    """The same skin with its triangles counter-clockwise seen from outside."""
    normals = vertex_normals(skin.vertices, skin.faces)
    if normals[skin.landmarks[ORIENTING], 2].mean() > 0.0:
        return skin
    return replace(skin, faces=np.ascontiguousarray(skin.faces[:, ::-1]))


def _distinct(source: FloatArray, target: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Both point sets without those that repeat in the first one."""
    first = np.sort(np.unique(source.round(6), axis=0, return_index=True)[1])
    return source[first], target[first]
