"""All that is told of one picture beside its pixels, as plain numbers for JSON."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from risorius import render

from ..scenes import FaceScene, Scene
from .camera_labels import SIDES, CameraLabels, gaze, head_pose
from .landmarks import landmarks_in

DIGITS = 8  # behind the point: whoever projects points anew is off by less than 1e-4 pixels
Floats = npt.NDArray[np.float64]


def labels_of(
    scene: Scene,
    camera: render.OrbitCamera,
    size: tuple[int, int],
    depth: npt.NDArray[np.float32] | None = None,
) -> dict[str, Any]:
    """What is known of the picture that `camera` takes of `scene` now, `size` pixels large.

    depth: its depth map, for the landmarks; None leaves them out. `docs/passes.md` tells of the
    keys. A scene without a face has its camera and controls alone.
    """
    placed = CameraLabels.of(camera, size)
    labels: dict[str, Any] = {
        "camera": {
            "width": size[0],
            "height": size[1],
            "K": _plain(placed.intrinsics),
            "R": _plain(placed.rotation),
            "t": _plain(placed.translation),
        },
        "controls": {name: value for name, value in scene.values.items() if value},
    }
    if not isinstance(scene, FaceScene):
        return labels
    pose = head_pose(scene, placed)
    to_head = scene.bone_transforms()["cranium"][:3, :3].T
    ways = {side: gaze(scene, side) for side in SIDES}
    labels["activations"] = {
        name: round(value, DIGITS) for name, value in scene.simulation.sums.items() if value
    }
    labels["head"] = {
        "R": _plain(pose.rotation),
        "t": _plain(pose.translation),
        "yaw": round(pose.yaw, DIGITS),
        "pitch": round(pose.pitch, DIGITS),
        "roll": round(pose.roll, DIGITS),
    }
    labels["gaze"] = {
        side: {"camera": _plain(placed.rotation @ way), "head": _plain(to_head @ way)}
        for side, way in ways.items()
    }
    if depth is not None:
        found = landmarks_in(scene, placed, depth)
        labels["landmarks"] = {
            "points": _plain(found.points),
            "pixels": _plain(found.pixels),
            "visible": found.visible.tolist(),
        }
    return labels


def _plain(numbers: Floats) -> Any:
    """Lists of rounded numbers; no negative zeros."""
    return (np.round(numbers, DIGITS) + 0.0).tolist()
