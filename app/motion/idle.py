"""A face that nobody moves: it lives, and looks at the viewer, beneath whatever is asked of it.

Controls that somebody else moves are left to him, together with those that belong to them: who sets
one way of the gaze has both eyes, who lowers a lid has both lids.

The eyes turn to the viewer first, each on its own, so that they meet there; beyond some degrees the
head turns, too. Who stands further aside than that is not followed. Source: own; a head takes part
in shifts of gaze of more than some 15 or 20 degrees (Freedman and Sparks 1997; Stahl 1999).
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from ..scenes import FaceScene, Scene
from .life import EYE_RANGE, HEAD_RANGES, Life, Values

EYES_ALONE = 10.0  # [degrees] off straight ahead that are left to the eyes
SHARE_OF_HEAD = 0.5  # of what lies beyond
EYES_MOST = 25.0  # [degrees] that eyes turn without strain
# [degrees] aside, and above or below: as far the viewer is looked at; and not at all.
FOLLOWED, LOST = (45.0, 32.0), (65.0, 45.0)


class Idle:
    """The life of a scene's face; a scene without one is left as it is."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._life = Life()

    def beneath(
        self,
        moved: frozenset[str],
        viewer: npt.NDArray[np.float64],
        time: float,
        *,
        is_still: bool = False,
    ) -> Values:
        """What to add to the scene's controls at `time` [s] of its life.

        moved: lowest controls that are left alone. viewer: where he stands [mm], shape (3,).
        is_still: that it looks at the viewer is all.
        """
        if not isinstance(self.scene, FaceScene):
            return {}
        parts = {} if is_still else self._life.parts(time)
        for part, values in looking_at(self.scene, viewer).items():
            own = parts.get(part, {})
            sums = {name: own.get(name, 0.0) + value for name, value in values.items()}
            parts[part] = {**own, **sums}
        return {
            name: value
            for part in parts.values()
            if not moved & part.keys()
            for name, value in part.items()
            if name in self.scene.limits  # a rig may lack a muscle
        }


def looking_at(scene: FaceScene, viewer: npt.NDArray[np.float64]) -> dict[str, Values]:
    """The gaze and the pose of the head with which a face looks at a point [mm], shape (3,).

    The eyes make up for how the head is turned now. By parts, as `Life.parts`.
    """
    centres = {eye.name: np.asarray(eye.centre) for eye in scene.head.eyes}
    if not centres:
        return {}
    aside = _angles(viewer - np.mean(list(centres.values()), axis=0))
    share = math.prod(map(_followed, aside, FOLLOWED, LOST))
    turn, rise = (share * SHARE_OF_HEAD * _beyond(angle, EYES_ALONE) for angle in aside)
    to_rest = np.linalg.inv(scene.bone_transforms()["cranium"])
    seen = (to_rest @ [*viewer, 1.0])[:3]  # the viewer, as the turned head has him
    eyes = {}
    for side, centre in centres.items():
        for way, angle in zip(("horizontal", "vertical"), _angles(seen - centre), strict=True):
            angle = min(max(share * angle, -EYES_MOST), EYES_MOST)
            eyes[f"gaze_{way}_{side}"] = angle / EYE_RANGE
    head = {
        "head_yaw": turn / HEAD_RANGES["head_yaw"],
        "head_pitch": rise / HEAD_RANGES["head_pitch"],
    }
    return {"eyes": eyes, "head": head}


def _angles(way: npt.NDArray[np.float64]) -> tuple[float, float]:
    """To the left and up from straight ahead [degrees]."""
    x, y, z = way
    return math.degrees(math.atan2(x, z)), math.degrees(math.atan2(y, math.hypot(x, z)))


def _beyond(angle: float, least: float) -> float:
    return math.copysign(max(abs(angle) - least, 0.0), angle)


def _followed(angle: float, whole: float, none: float) -> float:
    """1 as far as `whole`, 0 from `none` on, and smooth between."""
    left = min(max((none - abs(angle)) / (none - whole), 0.0), 1.0)
    return left * left * (3.0 - 2.0 * left)
