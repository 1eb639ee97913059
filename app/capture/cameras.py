"""Where the camera stands, from what a user or a script writes."""

from __future__ import annotations

import numpy as np

from risorius import render

from ..errors import UserError
from ..scenes import Scene

DEFAULT_VIEW = "front"  # the face looks at whoever looks at it


MARGIN = 0.05  # of the frame, free on each side of a whole scene


def whole_scene(scene: Scene, view: str | None) -> render.OrbitCamera:
    """A camera like that of `camera_for`, or further away, so that it sees the whole scene."""
    camera = camera_for(scene, view)
    wanted = camera.distance
    camera.fit(scene.extent, MARGIN)
    camera.distance = max(camera.distance, wanted)
    return camera


def camera_for(scene: Scene, view: str | None) -> render.OrbitCamera:
    """The camera of a named view of the whole scene, or of "yaw,pitch[,zoom]" around its focus.

    Degrees; at zoom 1 the whole scene fits, at 2 all is twice as large.

    Raises UserError with the views that there are.
    """
    view = view or DEFAULT_VIEW
    if view in render.VIEWS:
        return _framing(scene, view)
    try:
        yaw, pitch, zoom = [*map(float, view.split(",")), 1.0][:3]
        if view.count(",") > 2 or not np.isfinite([yaw, pitch, zoom]).all() or zoom <= 0.0:
            raise ValueError
    except ValueError:
        raise UserError(
            f"camera '{view}': allowed are {', '.join(render.VIEWS)}, "
            "or yaw,pitch[,zoom] in degrees, zoom above 0"
        ) from None
    camera = _framing(scene, "front")
    camera.orbit(yaw, pitch)
    camera.target = scene.focus.copy()
    camera.zoom(zoom)
    return camera


def _framing(scene: Scene, view: str) -> render.OrbitCamera:
    """A camera that sees what the scene wants framed; the rest of it may go beyond the frame."""
    camera = render.OrbitCamera.framing(scene.extent, view=view)
    camera.fit(scene.framed)
    return camera
