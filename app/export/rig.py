"""A rig: one morph target for each control of a layer, by its name, as avatars have them.

Each target is how the simulated face rests with that control alone at 1. Muscles do not add up as
targets do, so the motion of a script is followed as near as bounded least squares get.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import scipy

from risorius.geometry.normals import vertex_normals

from ..errors import UserError
from ..motion import SETTLING
from ..scenes import FaceScene
from ..scenes.surface_attachment import SurfaceAttachment
from .clip import Clip, Surface
from .formats import RIGS
from .morphs import Floats
from .pieces import HEAD, JAW, Piece, in_head, normals_of, rigid_piece, surfaces_with_parts

LEAST_MOTION = 0.01  # [mm] of any vertex of a part; below it a target leaves the part alone
IN_MOUTH = 0.05  # how much teeth and tongue count in a fit, against the skin's 1; chosen
RESTRAINT = 0.01  # of weights that undo each other, against the strongest target; chosen

Shapes = dict[str, Floats]  # of the surfaces that bend, as the head's bone finds them [mm]


def rigged_pieces(clip: Clip, rig: str) -> tuple[list[Piece], Floats]:
    """The surfaces of a clip with the targets of a rig; how far off the skin is, (N, V) [mm].

    Raises UserError for a scene without such controls. The scene is moved.
    """
    scene, title, skin = clip.scene, RIGS[rig], clip.skin
    if not isinstance(scene, FaceScene) or title not in scene.groups:
        raise UserError(f"--rig {rig}: the scene '{scene.name}' has no {title}; leave it away")
    names = target_names(scene, title)
    base, targets = _resting(scene, {}), _measured(scene, names, title)
    used = _used(clip, names)
    weights = np.zeros((clip.frame_count, len(names)))
    weights[:, used] = fit(
        (targets[each.name][used], _motion(clip, each, part) - base[each.name], part is None)
        for each, part in surfaces_with_parts(clip)
        if each.name in base
    )
    pieces = [
        _piece(surface, part, base[surface.name], names, targets[surface.name], weights)
        if surface.name in base
        else rigid_piece(surface, part)
        for surface, part in surfaces_with_parts(clip)
    ]
    off = _motion(clip, skin, None) - base[skin.name]
    off -= np.tensordot(weights, targets[skin.name], axes=1)
    return pieces, np.linalg.norm(off, axis=2)


def target_names(scene: FaceScene, title: str) -> list[str]:
    """The controls of a layer that bend the face: each side alone where there are sides."""
    return [
        name
        for name in scene.groups[title]
        if f"{name}_left" not in scene.limits and not _only_turns_head(scene, name)
    ]


def fit(surfaces: Iterable[tuple[Floats, Floats, bool]]) -> Floats:
    """Weights 0..1, shape (N, K), by which the targets of all surfaces come nearest to the motion.

    surfaces: targets, shape (K, V, 3), how far the vertices are moved, shape (N, V, 3), and whether
    it is the skin, which counts more.
    """
    products, wanted = [], []
    for targets, moved, is_skin in surfaces:
        rows = targets.reshape(len(targets), -1)
        weighted = rows.T * (1.0 if is_skin else IN_MOUTH)
        products.append(rows @ weighted)
        wanted.append(moved.reshape(len(moved), -1) @ weighted)
    total = np.sum(products, axis=0)
    restraint = RESTRAINT**2 * total.diagonal().max(initial=0.0) + np.finfo(float).tiny
    # The same problem with as few rows as there are targets, by the square root of the products.
    root = np.linalg.cholesky(total + restraint * np.eye(len(total)))
    rows = np.linalg.solve(root, np.sum(wanted, axis=0).T).T
    found = [scipy.optimize.lsq_linear(root.T, row, (0.0, 1.0), method="bvls").x for row in rows]
    return np.asarray(np.clip(found, 0.0, 1.0))  # it may leave its bounds by a rounding error


def _used(clip: Clip, names: Sequence[str]) -> list[int]:
    """Numbers of the targets that take part: those that the script sets, if it sets no others."""
    scene = clip.scene
    assert isinstance(scene, FaceScene)
    are_set = {name for name, values in clip.controls.items() if values.any()}
    bending = {name for name in are_set if not _only_turns_head(scene, name)}
    if not bending.issubset(names):
        bending = set(names)
    return [index for index, name in enumerate(names) if name in bending]


def _only_turns_head(scene: FaceScene, name: str) -> bool:
    """Whether a control moves the head as a whole and nothing else."""
    moved = scene.moved_by(name)
    return bool(moved) and all(each.startswith("head_") for each in moved)


def _piece(
    surface: Surface, part: Any, base: Floats, names: Sequence[str], moved: Floats, weights: Floats
) -> Piece:
    """The skin with all targets, or a part of the jaw with those that move it."""
    farthest = np.linalg.norm(moved, axis=2).max(axis=1)
    kept = [k for k, each in enumerate(farthest) if part is None or each > LEAST_MOTION]
    normals = vertex_normals(base, surface.faces)
    return Piece(
        surface,
        None if part is None else HEAD,
        base,
        normals,
        tuple(names[k] for k in kept),
        moved[kept],
        normals_of(base + moved[kept], surface.faces) - normals,
        weights[:, kept],
    )


def _measured(scene: FaceScene, names: Sequence[str], title: str) -> Shapes:
    """How far each control moves each surface that bends, shape (K, V, 3)."""
    rows = next(layer.rows for layer in scene.head.layers if layer.title == title)
    moved: list[Shapes] = []
    for name in names:
        # What says how much of another control it takes does nothing without that one.
        whole = rows.get(name, {}).get("share_of")
        without = {} if whole is None else {str(whole): 1.0}
        before, after = _resting(scene, without), _resting(scene, {**without, name: 1.0})
        moved.append({each: after[each] - before[each] for each in after})
    return {each: np.stack([shapes[each] for shapes in moved]) for each in moved[0]}


def _resting(scene: FaceScene, pose: Mapping[str, float]) -> Shapes:
    """The skin and what moves with it or with the jaw, in a pose that has been held, (V, 3)."""
    scene.reset()
    if pose:
        scene.pose(pose)
        scene.step(SETTLING)
    bones = {name: matrix[None] for name, matrix in scene.bone_transforms().items()}
    shapes = {
        part.name: in_head(scene, part.bone, part.vertices[None], bones)[0]
        for part in scene.parts
        if part.bone == JAW or isinstance(part, SurfaceAttachment)
    }
    return {"skin": in_head(scene, None, scene.positions[None], bones)[0], **shapes}


def _motion(clip: Clip, surface: Surface, part: Any) -> Floats:
    """The skin, or what moves with it or with the jaw, in all frames, shape (N, V, 3)."""
    shapes = surface.rest[None] if surface.shapes is None else surface.shapes
    return in_head(clip.scene, None if part is None else part.bone, shapes, clip.bones)
