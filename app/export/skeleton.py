"""The bones of a clip as glTF nodes, each standing where its bone turns.

    neck ── cranium ─┬─ eye_left, eye_right ── eyeballs
                     ├─ mandible ── lower teeth, tongue, ...
                     └─ upper teeth, ...

The skin hangs on both cranium and neck, which stays where it is.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy

from ..scenes import FaceScene
from .clip import METRES, Clip
from .glb import Glb
from .morphs import Floats
from .pieces import HEAD

NECK = "neck"
STILL = 1e-7  # [m, or of a quaternion] by which a node that does not move may be off


class Skeleton:
    """The nodes of the bones that something hangs on.

    root: number of the node that they hang on, None where there are none.
    skin: number of the glTF skin of a face, None for what is none.
    """

    def __init__(self, clip: Clip, used: set[str], glb: Glb) -> None:
        self._glb = glb
        self._bones = {NECK: np.broadcast_to(np.eye(4), (clip.frame_count, 4, 4)), **clip.bones}
        self._nodes: dict[str, dict[str, Any]] = {}
        self._pivots: dict[str, Floats] = {}
        self.skin: int | None = None
        if not isinstance(clip.scene, FaceScene):
            self.roots = [self._add(bone, None) for bone in sorted(used)]
            return
        pivots = clip.scene.simulation.pivots()
        self._pivots = {NECK: pivots[HEAD], **pivots}
        self.roots = [self._add(NECK, None)]
        head = self._add(HEAD, NECK)
        for bone in sorted(used - {HEAD, NECK}):
            self._add(bone, HEAD)
        to_bone = np.eye(4, dtype=np.float32)
        to_bone[3, :3] = -METRES * pivots[HEAD]  # columns first
        matrices = glb.accessor(np.stack([to_bone, to_bone]))
        joints = {"joints": [*self.roots, head], "inverseBindMatrices": matrices}
        self.skin = glb.add("skins", joints)

    def pivot(self, bone: str | None) -> Floats:
        """Where a bone's node stands at rest [mm], shape (3,); the origin unless told."""
        return np.zeros(3) if bone is None else self._pivots.get(bone, np.zeros(3))

    def hang(self, node: int, bone: str) -> None:
        """Let a node hang on a bone."""
        self._nodes[bone].setdefault("children", []).append(node)

    def _add(self, bone: str, parent: str | None) -> int:
        """Add a bone's node, with its motion against the parent's."""
        local = self._places(bone)
        if parent is not None:
            local = np.linalg.inv(self._places(parent)) @ local
        shift = METRES * (self.pivot(bone) - self.pivot(parent))
        self._nodes[bone] = {"name": bone, "translation": shift.tolist()}
        node = self._glb.add("nodes", self._nodes[bone])
        translations = METRES * local[:, :3, 3]
        if np.abs(translations - shift).max() > STILL:
            self._glb.animate(node, "translation", translations)
        rotations = scipy.spatial.transform.Rotation.from_matrix(local[:, :3, :3]).as_quat(
            canonical=True
        )
        if np.abs(rotations[:, :3]).max() > STILL:
            # q and -q turn alike, but not what lies between two keyframes.
            is_opposite = (rotations[1:] * rotations[:-1]).sum(axis=1) < 0.0
            rotations[1:] *= np.cumprod(np.where(is_opposite, -1.0, 1.0))[:, None]
            self._glb.animate(node, "rotation", rotations)
        if parent is not None:
            self.hang(node, parent)
        return node

    def _places(self, bone: str) -> Floats:
        """Matrices (N, 4, 4) from a bone's node to the scene [mm]."""
        to_pivot = np.eye(4)
        to_pivot[:3, 3] = self.pivot(bone)
        places: Floats = self._bones[bone] @ to_pivot
        return places
