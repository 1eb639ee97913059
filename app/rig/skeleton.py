"""Write bones of a scene as nodes of a glTF file; each node lies at the pivot of its bone.

    neck ── cranium ─┬─ eye_left, eye_right ── eyeballs
                     ├─ mandible
                     └─ teeth, tongue, hair, ...

The skin follows cranium and neck; the neck does not move.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import scipy

from risorius.geometry.arrays import Floats64

from ..scenes import Scene
from .glb import Glb
from .poses import CRANIUM_BONE
from .surface import METRES_PER_MILLIMETRE

NECK_BONE = "neck"  # name of a bone
MANDIBLE_BONE = "mandible"  # name of a bone


class Skeleton:
    """The nodes of the bones that carry surfaces.

    roots: indices of the nodes without a parent.
    skin: index of a face's glTF skin; None for a scene without a face.
    """

    def __init__(
        self,
        scene: Scene,
        used: set[str],
        glb: Glb,
        motion: Mapping[str, Floats64] | None = None,
        *,
        skins: bool = True,
    ) -> None:
        """Add the nodes to a file.

        used: bones that carry surfaces. motion: bone -> matrix in each frame, (N, 4, 4); None: no
        motion. skins: whether to add a glTF skin of cranium and neck.
        """
        self._glb = glb
        still = np.eye(4)[None]
        self._motion = motion or {}
        count = len(next(iter(self._motion.values()), still))
        self._still = np.broadcast_to(still, (count, 4, 4))
        self._nodes: dict[str, dict[str, Any]] = {}
        self._pivots: dict[str, Floats64] = {}
        self.skin: int | None = None
        if scene.face is None:
            self.roots = [self._add(bone, None) for bone in sorted(used)]
            return
        pivots = scene.face.simulation.bones.pivots()
        self._pivots = {NECK_BONE: pivots[CRANIUM_BONE], **pivots}
        self.roots = [self._add(NECK_BONE, None)]
        head = self._add(CRANIUM_BONE, NECK_BONE)
        # Shapes move all parts at the jaw, so no part but a beard belongs to the mandible.
        for bone in sorted((used | {MANDIBLE_BONE}) - {CRANIUM_BONE, NECK_BONE}):
            self._add(bone, CRANIUM_BONE)
        if not skins:
            return
        to_bone = np.eye(4, dtype=np.float32)
        to_bone[3, :3] = -METRES_PER_MILLIMETRE * pivots[CRANIUM_BONE]  # stored by columns
        matrices = glb.accessor(np.stack([to_bone, to_bone]))
        joints = {"joints": [*self.roots, head], "inverseBindMatrices": matrices}
        self.skin = glb.add("skins", joints)

    def pivot(self, bone: str | None) -> Floats64:
        """Return the position of a bone's node at rest [mm], (3,); None gives the origin."""
        return np.zeros(3) if bone is None else self._pivots.get(bone, np.zeros(3))

    def add_child(self, node: int, bone: str) -> None:
        """Make a node a child of a bone's node."""
        self._nodes[bone].setdefault("children", []).append(node)

    def note(self, bone: str, extras: dict[str, Any]) -> None:
        """Set the extras of a bone's node."""
        self._nodes[bone]["extras"] = extras

    def _add(self, bone: str, parent: str | None) -> int:
        """Add a bone's node, with its motion relative to the parent."""
        local = self._motions(bone)
        if parent is not None:
            local = np.linalg.inv(self._motions(parent)) @ local
        shift = METRES_PER_MILLIMETRE * (self.pivot(bone) - self.pivot(parent))
        self._nodes[bone] = {"name": bone, "translation": shift.tolist()}
        node = self._glb.add("nodes", self._nodes[bone])
        translations = METRES_PER_MILLIMETRE * local[:, :3, 3]
        still_motion = 1e-7  # [m] or change of a quaternion; smaller motion is left out
        if np.abs(translations - shift).max() > still_motion:
            self._glb.animate(node, "translation", translations)
        rotations = scipy.spatial.transform.Rotation.from_matrix(local[:, :3, :3]).as_quat(
            canonical=True
        )
        if np.abs(rotations[:, :3]).max() > still_motion:
            # q and -q are the same rotation, but interpolated values differ.
            is_opposite = (rotations[1:] * rotations[:-1]).sum(axis=1) < 0.0
            rotations[1:] *= np.cumprod(np.where(is_opposite, -1.0, 1.0))[:, None]
            self._glb.animate(node, "rotation", rotations)
        if parent is not None:
            self.add_child(node, parent)
        return node

    def _motions(self, bone: str) -> Floats64:
        """Return matrices (N, 4, 4) from a bone's node to the scene [mm]."""
        to_pivot = np.eye(4)
        to_pivot[:3, 3] = self.pivot(bone)
        motions: Floats64 = self._motion.get(bone, self._still) @ to_pivot
        return motions
