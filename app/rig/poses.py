"""Make poses in which a face has come to rest, and name the shapes that are made of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from risorius.geometry.arrays import Floats32, Floats64
from risorius.geometry.transforms import moved_points

from ..errors import UserError
from ..motion.curves import ACTION_UNIT_LAYER, sided
from ..recordings.names import ARKIT_SHAPES, VISEME_NAMES
from ..scenes import FaceScene

SHAPE_KINDS = ("arkit", "units", "visemes", "expressions")
STILL_STEP = 0.001  # [mm] per step; a face that moves less is at rest
CRANIUM_BONE = "cranium"  # name of a bone
HEAD_CONTROLS = frozenset(("head_yaw", "head_pitch", "head_roll"))


@dataclass(frozen=True)
class FacePose:
    """A face at one moment, relative to its cranium.

    skin: vertices [mm], (V, 3).
    matrices: name of a bone -> matrix for column vectors, (4, 4).
    parts: name of a part -> vertices relative to the part's bone [mm], (n, 3).
    """

    skin: Floats64
    matrices: Mapping[str, Floats64]
    parts: Mapping[str, Floats32]


def pose_of(scene: FaceScene) -> FacePose:
    """Return the current pose of a scene."""
    bones = scene.bone_transforms()
    to_cranium = np.linalg.inv(bones[CRANIUM_BONE])
    weights = scene.face.head_weight
    return FacePose(
        without_head_pose(np.array(scene.positions), bones[CRANIUM_BONE], weights),
        {name: to_cranium @ matrix for name, matrix in bones.items()},
        {part.name: part.vertices for part in scene.parts},
    )


def without_head_pose(skin: Floats64, cranium: Floats64, weights: Floats64) -> Floats64:
    """Remove the cranium's motion from skin (V, 3) that follows it by `weights` (V,)."""
    if np.array_equal(cranium, np.eye(4)):
        return skin
    rotation = cranium[:3, :3]
    shift = cranium[:3, 3]
    turns = np.eye(3) + weights[:, None, None] * (rotation - np.eye(3))
    unshifted = skin - weights[:, None] * shift
    return np.asarray(np.linalg.solve(turns, unshifted[:, :, None])[:, :, 0])


def rest_in(scene: FaceScene, values: Mapping[str, float]) -> FacePose:
    """Return the pose in which a face comes to rest with some controls; all others are 0.

    The face starts from rest each time, so a pose does not depend on earlier poses.
    """
    scene.reset()
    scene.pose(values)
    scene.simulation.jump(scene.values)
    before = np.array(scene.positions)
    calm = 0
    for _ in range(120):  # most faces need a fifth of these steps
        scene.step(1.0 / 60.0)
        moved = float(np.abs(scene.positions - before).max())
        calm = calm + 1 if moved < STILL_STEP else 0
        if calm == 3:  # because motion that reverses is slow for a single step
            break
        before[:] = scene.positions
    return pose_of(scene)


def shape_names(scene: FaceScene, kinds: Sequence[str]) -> tuple[str, ...]:
    """Return the controls that become shapes, in the order of `kinds`; ARKit's in Apple's order.

    Rotations of the head are left out, because the node "cranium" makes them. An unknown kind
    raises UserError.
    """
    found: list[str] = []
    for kind in kinds:
        if kind == "arkit":
            found += ARKIT_SHAPES
        elif kind == "visemes":
            found += VISEME_NAMES
        elif kind == "expressions":
            found += scene.expressions
        elif kind == "units":
            units = sided(scene, ACTION_UNIT_LAYER)
            found += [name for name in units if not set(scene.moved_by(name)) <= HEAD_CONTROLS]
        else:
            raise UserError(f"--shapes: '{kind}' is unknown; allowed are {', '.join(SHAPE_KINDS)}")
    return tuple(dict.fromkeys(found))


def settings_of(scene: FaceScene, name: str) -> tuple[dict[str, float], dict[str, float]]:
    """Return the controls of a shape's pose, and of its reference pose.

    If a control is relative to another control, as `mouthClose` is to `jawOpen`, the other control
    is 1 in both poses.
    """
    whole = scene.simulation.controls.tables.share_of.get(name)
    base: dict[str, float] = {} if whole is None else {whole: 1.0}
    return {**base, name: 1.0}, base


def moved_part(part: Any, pose: FacePose) -> Floats64:
    """Return the vertices of a part in a pose, relative to the cranium [mm], (n, 3)."""
    points = pose.parts[part.name].astype(np.float64)
    return moved_points(pose.matrices[part.bone], points)
