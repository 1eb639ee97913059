"""A clip as binary glTF (.glb), which Blender, browsers and game engines read: metres, y up.

Bones are animated nodes, each standing where its bone turns; all other motion is weights of morph
targets. Every frame of the clip is a keyframe. The motion by the head's pose is taken out of the
skin's shapes, since the bone of the head adds it again. docs/export.md describes the content of a
file, and how other programs show it.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ..rig.glb import Glb
from ..rig.poses import CRANIUM, without_head_pose
from ..rig.scene_meshes import Piece, add_mesh
from ..rig.skeleton import Skeleton
from ..rig.surface import Floats, RefinedSurface
from ..text import as_text
from .clip import Clip
from .formats import ExportRequest
from .morphs import TOLERANCE, decompose, follow


def write_gltf(clip: Clip, part: Path, request: ExportRequest) -> str | None:
    """Write the file; return a remark where it differs visibly from the clip."""
    pieces, error = moving_pieces(clip)
    part.write_bytes(_packed(clip, pieces))
    if error <= TOLERANCE:
        return None
    count = max(len(piece.targets) for piece in pieces)
    return f"{count} morph targets do not suffice: up to {error:.2f} mm off"


def moving_pieces(clip: Clip) -> tuple[list[Piece], float]:
    """The surfaces of a clip with the targets that its motion needs; how far off they are [mm]."""
    pieces = []
    error = 0.0
    for surface, part in zip(clip.surfaces, [None, *clip.scene.parts], strict=True):
        bone = None if part is None else part.bone
        if surface.shapes is None:
            none = np.zeros((0, *surface.rest.shape))
            normals = part.normals.astype(np.float64)
            pieces.append(Piece(surface, bone, normals, (), none, none, np.zeros((0, 0))))
            continue
        shapes = surface.shapes.astype(np.float64)
        if part is None:
            _take_pose_out(clip, shapes)
        morphs = decompose(shapes - surface.rest)
        normals = surface.normals_of(surface.rest, None)
        bent = np.array([surface.normals_of(shape, k) for k, shape in enumerate(shapes)])
        if isinstance(surface, RefinedSurface):  # its normals are those of the turned head
            _take_pose_out(clip, bent, are_places=False)
        bends = follow(morphs.weights, bent - normals)
        names = tuple(f"motion {index + 1}" for index in range(len(morphs.targets)))
        pieces.append(Piece(surface, bone, normals, names, morphs.targets, bends, morphs.weights))
        error = max(error, morphs.error)
    return pieces, error


def _take_pose_out(clip: Clip, shapes: Floats, *, are_places: bool = True) -> None:
    """Leave shapes of the skin, (N, V, 3), as the head's bone finds them.

    are_places: the bone moves and turns them; normals are turned only.
    """
    face = clip.scene.face
    if face is None:
        return
    share = clip.skin.carried(face.head_weight)
    for shape, bone in zip(shapes, clip.bones[CRANIUM], strict=True):
        matrix = bone.copy()
        if not are_places:
            matrix[:3, 3] = 0.0
        shape[:] = without_head_pose(shape, matrix, share)


def _packed(clip: Clip, pieces: list[Piece]) -> bytes:
    """The whole file."""
    glb = Glb(clip.times)
    bones = {piece.bone for piece in pieces if piece.bone is not None}
    skeleton = Skeleton(clip.scene, bones, glb, clip.bones)
    roots = list(skeleton.roots)
    for piece in pieces:
        node: dict[str, Any] = {"name": piece.surface.name}
        share = None
        if piece.bone is None and clip.scene.face is not None:
            node["skin"] = skeleton.skin
            share = clip.skin.carried(clip.scene.face.head_weight)
        node["mesh"] = add_mesh(glb, clip.scene, piece, skeleton.pivot(piece.bone), share)
        number = glb.add("nodes", node)
        if piece.bone is None:
            roots.append(number)
        else:
            skeleton.hang(number, piece.bone)
        if len(piece.targets):
            glb.animate(number, "weights", piece.weights)
    return glb.to_bytes(as_text(clip.script.title) or "motion", roots)
