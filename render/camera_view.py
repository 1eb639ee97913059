"""A camera looking into a viewport: its matrices, and which pixels geometry can touch."""

from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from .camera import OrbitCamera
from .render_target import Rectangle, intersection

FloatArray = npt.NDArray[np.float64]

_CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], np.float64)


class CameraView:
    """The matrices of one camera in one viewport, for row vectors, computed once.

    clip: the part of the viewport outside which nothing is drawn.
    world_to_view: world -> view space; projection: view -> clip space; shape (4, 4), float64.
    """

    def __init__(
        self, camera: OrbitCamera, viewport: Rectangle, clip: Rectangle | None = None
    ) -> None:
        self.camera = camera
        self.viewport = viewport
        self.clip = viewport if clip is None else intersection(viewport, clip)
        self.world_to_view: FloatArray = np.asarray(camera.view_matrix())
        self.projection: FloatArray = np.asarray(
            camera.projection_matrix(viewport[2] / viewport[3])
        )

    @cached_property
    def world_to_clip(self) -> FloatArray:
        """World -> clip space, shape (4, 4)."""
        return self.world_to_view @ self.projection

    @cached_property
    def fingerprint(self) -> bytes:
        """The same for views of the same, whoever made them."""
        return self.world_to_clip.tobytes()

    def covered_pixels(self, corners: FloatArray, padding: float = 2.0) -> Rectangle:
        """The pixels of the clip that the hull of `corners`, shape (n, 3), can touch.

        The whole clip where a corner is not finite or lies behind the eye; a width or height of 0
        where nothing is seen.
        """
        matrix = self.world_to_clip
        with np.errstate(over="ignore", invalid="ignore"):
            clip = corners @ matrix[:3] + matrix[3]
        if not np.isfinite(clip).all() or clip[:, 3].min() <= 0.0:
            return self.clip
        x, y, width, height = self.viewport
        place = 0.5 * (clip[:, :2] / clip[:, 3:] + 1.0) * (width, height)
        low = np.clip(np.floor(place.min(axis=0) - padding), 0.0, (width, height))
        high = np.clip(np.ceil(place.max(axis=0) + padding), 0.0, (width, height))
        covered = x + int(low[0]), y + int(low[1]), int(high[0] - low[0]), int(high[1] - low[1])
        return intersection(covered, self.clip)


def box_corners(points: npt.NDArray[Any]) -> FloatArray:
    """The corners of the box that holds all points (n, 3), shape (8, 3), float64."""
    low = points.min(axis=0).astype(np.float64)
    high = points.max(axis=0).astype(np.float64)
    with np.errstate(over="ignore", invalid="ignore"):  # a simulation that blew up is drawn, too
        corners: FloatArray = low + _CORNERS * (high - low)
    return corners
