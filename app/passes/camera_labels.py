"""Where the camera stands, how the head is turned to it, and where the eyes look, as numbers.

Axes of the camera are those of OpenCV and of pictures: x right, y down, z away from it. A point p
of the scene [mm] has the camera's coordinates c = R p + t and is seen at the pixel K c / c_z; pixel
(0, 0) reaches from 0 to 1, so the middle of the picture is (width / 2, height / 2).

A head's pose is told in its own axes, which the scene's are as long as it is at rest: x toward the
subject's left, y up, z forward. Yaw, pitch and roll are 0, 0, 0 for a head that faces the camera,
and the head is turned by roll first, then pitch, then yaw: yaw to the subject's left, pitch up,
roll toward the left shoulder. Its controls turn it so, too, but about axes that landmarks give,
some 2 degrees off these.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from risorius import render

from ..scenes import FaceScene

Floats = npt.NDArray[np.float64]
SIDES = ("right", "left")  # the subject's, in the order of landmarks
FORWARD = np.array([0.0, 0.0, 1.0])  # of a head and of an eye at rest
_FACING = np.diag([1.0, -1.0, -1.0])  # the axes of a head that faces the camera, in the camera's


@dataclass(frozen=True)
class CameraLabels:
    """A camera as OpenCV describes one.

    size: of the picture [pixels]. intrinsics: K, (3, 3). rotation, translation: R, (3, 3), and t,
    (3,) [mm].
    """

    size: tuple[float, float]
    intrinsics: Floats
    rotation: Floats
    translation: Floats

    @classmethod
    def of(cls, camera: render.OrbitCamera, size: tuple[float, float]) -> CameraLabels:
        """What `camera` sees in a picture of `size`."""
        width, height = size
        focal = camera.focal(width / height, height)
        right, up, back = camera.axes()
        rotation = np.stack([right, -up, -back])
        intrinsics = np.array([[focal, 0, width / 2], [0, focal, height / 2], [0, 0, 1.0]])
        return cls(size, intrinsics, rotation, -rotation @ camera.eye)

    def to_camera(self, points: Floats) -> Floats:
        """Points of the scene, (n, 3), in the camera's coordinates [mm]."""
        seen: Floats = points @ self.rotation.T + self.translation
        return seen

    def project(self, points: Floats) -> Floats:
        """Where points of the scene, (n, 3), are in the picture [pixels], (n, 2)."""
        seen = self.to_camera(points) @ self.intrinsics.T
        pixels: Floats = seen[:, :2] / seen[:, 2:]
        return pixels


@dataclass(frozen=True)
class HeadPose:
    """A head before a camera.

    rotation, translation: take points of the head at rest [mm] to the camera, (3, 3) and (3,).
    yaw, pitch, roll: [degrees], as this file's text says.
    """

    rotation: Floats
    translation: Floats
    yaw: float
    pitch: float
    roll: float


def head_pose(scene: FaceScene, camera: CameraLabels) -> HeadPose:
    """How the cranium is placed before the camera now."""
    cranium = scene.bone_transforms()["cranium"]
    rotation = camera.rotation @ cranium[:3, :3]
    turned = _FACING @ rotation
    yaw = math.atan2(turned[0, 2], turned[2, 2])
    pitch = math.asin(min(max(turned[1, 2], -1.0), 1.0))
    roll = math.atan2(-turned[1, 0], turned[1, 1])
    return HeadPose(
        rotation,
        camera.to_camera(cranium[None, :3, 3])[0],
        *(math.degrees(angle) for angle in (yaw, pitch, roll)),
    )


def gaze(scene: FaceScene, side: str) -> Floats:
    """Where the eye of that side looks: a unit vector in the scene, shape (3,)."""
    way: Floats = scene.bone_transforms()[f"eye_{side}"][:3, :3] @ FORWARD
    return way
