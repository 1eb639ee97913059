"""The camera of a sample: round the head wherever that is turned, never past it."""

from __future__ import annotations

import numpy as np

from risorius import render

from ..scenes import FaceScene
from .sampling import View

MARGIN = 0.12  # of the picture, free on each side of the head at zoom 1
CHIN = 8  # the landmark
BELOW_CHIN = 12.0  # [mm] of the neck that go with the head


def camera_of(scene: FaceScene, view: View) -> render.OrbitCamera:
    """A camera that has the head of the scene, as it is now, in the middle, but for the shift."""
    rest = scene.rest_positions
    chin = rest[scene.landmarks[CHIN], 1]
    head = rest[:, 1] > chin - BELOW_CHIN
    points = scene.positions[head]
    camera = render.OrbitCamera.framing(
        np.vstack([scene.positions, rest]), view="front", field_of_view=view.field_of_view
    )
    camera.orbit(view.yaw, view.pitch)
    camera.fit(points, MARGIN)
    camera.zoom(view.zoom)
    camera.pan(*view.shift)
    return camera
