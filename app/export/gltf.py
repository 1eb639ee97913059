"""Writes a clip as binary glTF (.glb), for Blender, browsers and game engines: metres, y up.

Bones are animated nodes at the bones' pivots. Animated weights of morph targets make all other
motion: ARKit's shapes by name, as in an avatar (`risorius rig`), and a few residual targets for the
rest. Every frame of the clip is a keyframe. The motion by the head's pose is removed from the
skin's shapes, because the bone of the head adds it again. docs/export.md describes the content of a
file, and how other programs show it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius.geometry.arrays import Floats64

from ..recordings.names import ARKIT_SHAPES
from ..rig.bodies import Body, PartBody, Shaped, SkinBody, moving, poses_of
from ..rig.curves import nearest_weights, shape_curves
from ..rig.glb import Glb
from ..rig.poses import CRANIUM_BONE, FacePose, without_head_pose
from ..rig.scene_file import add_pieces
from ..rig.scene_meshes import Piece
from ..rig.skeleton import Skeleton
from ..rig.surface import MovingSurface, RefinedSurface
from ..scenes import FaceScene
from ..text import as_text
from .clip import Clip
from .formats import ExportRequest
from .morphs import MORPH_TOLERANCE, Morphs, decompose, follow
from .refined import RefinedSkin

Poses = Mapping[str, tuple[FacePose, FacePose]]


@dataclass(frozen=True)
class Moving:
    """The surfaces of a clip with their targets, and their errors against the simulation.

    pieces: the skin comes first. off: name of a surface that changes its shape -> largest error of
    a vertex in any frame [mm]. mean: root mean square over skin vertices and frames [mm].
    """

    pieces: list[Piece]
    off: Mapping[str, float]
    mean: float

    @property
    def farthest(self) -> str:
        """The name of the surface with the largest error."""
        return max(self.off, key=lambda name: self.off[name])

    @property
    def words(self) -> str:
        """Describe the errors to the user in one line."""
        counts = [sum(name in ARKIT_SHAPES for name in piece.names) for piece in self.pieces]
        named = max(counts)
        others = max(
            len(piece.names) - count for piece, count in zip(self.pieces, counts, strict=True)
        )
        return (
            f"{named} named targets and {others} residual ones, at most "
            f"{self.off[self.farthest]:.2f} mm from the simulation ({self.farthest}), "
            f"RMS of the skin {self.mean:.2f}"
        )


def write_gltf(clip: Clip, part: Path, request: ExportRequest) -> str:
    """Write the file; return a line with the number of targets and their errors."""
    motion = moving_pieces(clip, request)
    glb = Glb(clip.times)
    bones = {piece.bone for piece in motion.pieces if piece.bone is not None}
    skeleton = Skeleton(clip.scene, bones, glb, clip.bones)
    roots = add_pieces(glb, clip.scene, motion.pieces, skeleton)
    title = as_text(clip.script.title) or "motion"
    part.write_bytes(glb.to_bytes(title, [*skeleton.roots, *roots]))
    if motion.off[motion.farthest] > MORPH_TOLERANCE and not request.named_only:
        return f"{motion.words}: the motion needs more targets than readers take"
    return motion.words


def moving_pieces(clip: Clip, request: ExportRequest) -> Moving:
    """Return the surfaces of a clip with the targets that its motion needs."""
    poses: Poses = {}
    weights = np.zeros((clip.frame_count, 0))
    face = clip.scene.face
    if face is not None:
        scene = FaceScene(face.head, face.clone())
        poses = dict(poses_of(scene, ARKIT_SHAPES, progress=request.progress))
        weights = shape_curves(clip.scene, clip.times, clip.activations, clip.controls)
    pieces = []
    off: dict[str, Floats64] = {}
    for surface, part in zip(clip.surfaces, [None, *clip.scene.exported_parts], strict=True):
        if surface.shapes is None:
            pieces.append(_rigid_piece(surface, part))
            continue
        (shaped,) = moving([_body_of(surface, part)], poses)
        displacements = surface.shapes.astype(np.float64)
        if part is None:
            _remove_head_motion(clip, displacements)
        displacements -= surface.rest
        if part is None and poses:
            weights = nearest_weights(shaped.targets, displacements, weights)
        bone = None if part is None else part.bone
        named = _named_piece(surface, bone, shaped, weights)
        left = displacements - _sums_of_changes(named, named.targets)
        if not request.named_only:
            residual = decompose(left)
            left -= np.tensordot(residual.weights, residual.targets, 1)
            bends = follow(
                residual.weights,
                _bends_of_normals(clip, surface) - _sums_of_changes(named, named.bends),
            )
            named = _with_residual(named, residual, bends)
        pieces.append(named)
        off[surface.name] = np.linalg.norm(left, axis=2)
    farthest = {name: float(distances.max()) for name, distances in off.items()}
    return Moving(pieces, farthest, float(np.sqrt((off[clip.skin.name] ** 2).mean())))


def _rigid_piece(surface: MovingSurface, part: Any) -> Piece:
    """Return a surface that a bone moves as a whole, without targets."""
    none = np.zeros((0, *surface.rest.shape))
    normals = part.normals.astype(np.float64)
    return Piece(
        surface=surface,
        bone=part.bone,
        normals=normals,
        names=(),
        targets=none,
        bends=none,
        weights=np.zeros((0, 0)),
    )


def _body_of(surface: MovingSurface, part: Any) -> Body:
    """Return a surface as a body, whose shape in a pose is relative to its bone."""
    if part is not None:
        return PartBody(part, surface.rest, part.bone)
    if isinstance(surface, RefinedSurface):
        return RefinedSkin(surface)
    return SkinBody(surface.rest, surface.faces)


def _named_piece(
    surface: MovingSurface, bone: str | None, shaped: Shaped, weights: Floats64
) -> Piece:
    """Return a surface with the named shapes that move it."""
    count = len(shaped.targets)
    return Piece(
        surface=surface,
        bone=bone,
        normals=surface.normals_of(surface.rest, None),
        names=ARKIT_SHAPES[:count],
        targets=shaped.targets,
        bends=shaped.bends,
        weights=weights[:, :count],
    )


def _with_residual(piece: Piece, residual: Morphs, bends: Floats64) -> Piece:
    """Return a piece with residual targets, which add the rest of the motion."""
    names = tuple(f"residual {index + 1}" for index in range(len(residual.targets)))
    return replace(
        piece,
        names=(*piece.names, *names),
        targets=np.concatenate([piece.targets, residual.targets]),
        bends=np.concatenate([piece.bends, bends]),
        weights=np.hstack([piece.weights, residual.weights]),
    )


def _sums_of_changes(piece: Piece, changes: npt.NDArray[np.floating]) -> Floats64:
    """Return sums of changes (K, V, 3), weighted by a piece's weights in each frame, (N, V, 3)."""
    return np.asarray(np.tensordot(piece.weights, changes, 1))


def _bends_of_normals(clip: Clip, surface: MovingSurface) -> Floats64:
    """Return changes of normals from rest in each frame, relative to the bone, (N, V, 3)."""
    assert surface.shapes is not None
    shapes = surface.shapes.astype(np.float64)
    is_refined = isinstance(surface, RefinedSurface)  # normals include the head's turn
    if surface is clip.skin and not is_refined:
        _remove_head_motion(clip, shapes)
    bent = np.array([surface.normals_of(shape, frame) for frame, shape in enumerate(shapes)])
    if is_refined:
        _remove_head_motion(clip, bent, are_positions=False)
    return bent - surface.normals_of(surface.rest, None)


def _remove_head_motion(clip: Clip, shapes: Floats64, *, are_positions: bool = True) -> None:
    """Remove the head's motion from shapes or normals of the skin, (N, V, 3), in place.

    are_positions: whether shapes are vertices; normals only turn.
    """
    face = clip.scene.face
    if face is None:
        return
    head_weight = clip.skin.carried(face.head_weight)
    for shape, bone in zip(shapes, clip.bones[CRANIUM_BONE], strict=True):
        matrix = bone.copy()
        if not are_positions:
            matrix[:3, 3] = 0.0
        shape[:] = without_head_pose(shape, matrix, head_weight)
