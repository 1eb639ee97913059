"""The parameters of a camera in OpenCV's convention."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from risorius import render
from risorius.geometry.arrays import Floats64


@dataclass(frozen=True)
class CameraLabels:
    """A camera in OpenCV's convention.

    size: width and height of the picture [pixels]. intrinsics: K, (3, 3). rotation: R, (3, 3).
    translation: t, (3,) [mm].
    """

    size: tuple[float, float]
    intrinsics: Floats64
    rotation: Floats64
    translation: Floats64

    @classmethod
    def from_camera(cls, camera: render.OrbitCamera, size: tuple[float, float]) -> CameraLabels:
        """Return the parameters of `camera` for a picture of `size` [pixels]."""
        width, height = size
        focal = camera.focal(width / height, height)
        right, up, back = camera.axes()
        rotation = np.stack([right, -up, -back])
        intrinsics = np.array([[focal, 0, width / 2], [0, focal, height / 2], [0, 0, 1.0]])
        return cls(size, intrinsics, rotation, -rotation @ camera.eye)

    def to_camera(self, points: Floats64) -> Floats64:
        """Convert points of the scene, (n, 3), to the camera's coordinates [mm]."""
        seen: Floats64 = points @ self.rotation.T + self.translation
        return seen

    def project(self, points: Floats64) -> Floats64:
        """Project points of the scene, (n, 3), into the picture [pixels], (n, 2)."""
        seen = self.to_camera(points) @ self.intrinsics.T
        pixels: Floats64 = seen[:, :2] / seen[:, 2:]
        return pixels

    def from_picture(self, pixels: Floats64, depths: Floats64) -> Floats64:
        """Return points at pixels (n, 2) with depths (n,), in the camera's coordinates, (n, 3)."""
        middle = self.intrinsics[:2, 2]
        focal = self.intrinsics[[0, 1], [0, 1]]
        aside = (pixels - middle) / focal * depths[:, None]
        return np.column_stack([aside, depths])
