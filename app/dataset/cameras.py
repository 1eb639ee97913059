"""The camera of a sample: round the head wherever that is turned, all landmarks in the picture."""

from __future__ import annotations

import numpy as np

from risorius import render

from ..passes.camera_labels import CameraLabels
from ..scenes import FaceScene
from .sampling import View

MARGIN = 0.03  # of the picture, free on each side of the head at zoom 1: the neck ends outside
CHIN = 8  # the landmark
BELOW_CHIN = 12.0  # [mm] of the neck that go with the head


def camera_of(scene: FaceScene, view: View, size: tuple[int, int]) -> render.OrbitCamera:
    """A camera that has the head of the scene, as it is now, in the middle, but for the shift.

    It is moved on where landmarks would be beside the picture, of `size` pixels.
    """
    rest = scene.rest_positions
    head = rest[:, 1] > rest[scene.landmarks[CHIN], 1] - BELOW_CHIN
    camera = render.OrbitCamera.framing(
        np.vstack([scene.positions, rest]), view="front", field_of_view=view.field_of_view
    )
    camera.orbit(view.yaw, view.pitch)
    camera.fit(scene.positions[head], MARGIN)
    camera.zoom(view.zoom)
    camera.pan(*view.shift)
    for _ in range(3):  # perspective makes one round inexact
        pixels = CameraLabels.of(camera, size).project(scene.positions[scene.landmarks])
        places = pixels / size[1]
        end = np.array([size[0] / size[1], 1.0]) - MARGIN
        right, down = np.maximum(places.max(axis=0) - end, 0.0) - np.maximum(
            MARGIN - places.min(axis=0), 0.0
        )
        camera.pan(float(right), -float(down))
    return camera
