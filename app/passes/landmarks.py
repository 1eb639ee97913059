"""The 68 iBug landmarks and the pupils of a face, in space and in a picture, and which are seen.

Landmarks are vertices of the simulated mesh, through which the refined surface goes, too. The
pupils, 68 the right one and 69 the left, are the points of the eyeballs that look straight ahead.

A point is hidden where the depth map has something in front of it everywhere within REACH. Nearer
than that, the surface to which it belongs may rise in front of it: the margin of a lid behind its
edge, the seam of closed lips. Over 60 random expressions and cameras what remained in front was
below 1 mm for landmarks whose own triangles were in the picture and, but for 1 in 100, above 3 mm
for all others; TOLERANCE lies between. Around a pupil the eye is round and smooth, and a lid that
closes over it is a millimetre thick: PUPIL_TOLERANCE.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..scenes import FaceScene
from .camera_labels import SIDES, CameraLabels, Floats

COUNT = 70
REACH = 1.0  # [mm] across
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
    reaches = np.maximum(np.ceil(REACH * camera.intrinsics[0, 0] / depths), 1.0)
    nearest = depths - np.where(np.arange(COUNT) < len(scene.landmarks), TOLERANCE, PUPIL_TOLERANCE)
    visible = [
        _is_visible(depth, x, y, near, int(reach))
        for (x, y), near, reach in zip(pixels.tolist(), nearest, reaches, strict=True)
    ]
    return Landmarks(points, pixels, np.array(visible))


def _is_visible(
    depth: npt.NDArray[np.float32], x: float, y: float, nearest: float, reach: int
) -> bool:
    """Whether a point at a pixel is in the picture, and not hidden by what is nearer [mm]."""
    height, width = depth.shape
    if not (0.0 <= x < width and 0.0 <= y < height):
        return False
    column, row = math.floor(x), math.floor(y)
    around = depth[
        max(row - reach, 0) : row + reach + 1, max(column - reach, 0) : column + reach + 1
    ]
    return bool(((around == 0.0) | (around > nearest)).any())
