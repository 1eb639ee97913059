"""The 68 iBug landmarks and the pupils of a face, in space and in a picture, and which are seen.

Landmarks are vertices of the simulated mesh, through which the refined surface goes, too. The
pupils, 68 the right one and 69 the left, are the points of the eyeballs that look straight ahead.

A point is visible where it is seen: what the depth map has at its own pixel is as far away as the
point, within a tolerance. That is 2 mm for landmarks, since the drawn skin has wrinkles of up to
1 mm and may be steep within a pixel, and 0.6 mm for pupils, over which a lid of a millimetre may
close; and the width of a pixel where that is more.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..scenes import FaceScene
from .camera_labels import SIDES, CameraLabels, Floats

COUNT = 70
TOLERANCE, PUPIL_TOLERANCE = 2.0, 0.6  # [mm] along the camera's axis


@dataclass(frozen=True)
class Landmarks:
    """The points of one picture: 68 landmarks, the right pupil, the left pupil.

    points: in the scene [mm], (70, 3). pixels: x to the right and y down; the middle of the first
    pixel is (0.5, 0.5), (70, 2). visible: neither hidden nor beside the picture, (70,).
    """

    points: Floats
    pixels: Floats
    visible: npt.NDArray[np.bool_]


def points_of(scene: FaceScene) -> Floats:
    """Where the landmarks and the pupils of a face are now [mm], shape (70, 3)."""
    bones = scene.bone_transforms()
    pupils = []
    for side in SIDES:
        bone = f"eye_{side}"
        ball = next(part for part in scene.parts if part.bone == bone)
        front = ball.vertices[ball.vertices[:, 2].argmax()]
        pupils.append(bones[bone][:3, :3] @ front + bones[bone][:3, 3])
    return np.vstack([scene.positions[scene.landmarks], pupils])


def landmarks_in(
    scene: FaceScene, camera: CameraLabels, depth: npt.NDArray[np.float32]
) -> Landmarks:
    """The landmarks of a face in the picture of which `depth`, (H, W), is the depth map."""
    points = points_of(scene)
    pixels, depths = camera.project(points), camera.to_camera(points)[:, 2]
    height, width = depth.shape
    columns, rows = np.floor(pixels).astype(int).T
    is_inside = (columns >= 0) & (columns < width) & (rows >= 0) & (rows < height)
    seen = depth[np.clip(rows, 0, height - 1), np.clip(columns, 0, width - 1)]
    tolerance = np.where(np.arange(COUNT) < len(scene.landmarks), TOLERANCE, PUPIL_TOLERANCE)
    tolerance = np.maximum(tolerance, depths / camera.intrinsics[0, 0])
    # Background has the depth 0.
    visible = is_inside & (seen > 0.0) & (np.abs(seen - depths) <= tolerance)
    return Landmarks(points, pixels, visible)
