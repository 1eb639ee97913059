"""The orbit camera, which turns around a point of the scene.

A `CameraView` is a camera with a viewport. A `PlacedView` adds the pixels and the matrices on one
target.

World axes: x to the subject's left (the viewer's right), y up, z toward the viewer of the front
view. Matrices follow pyrr: float64, (4, 4), for row vectors on the left. So their bytes have the
order of OpenGL.
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt
from pyrr import Matrix44

from ..geometry.arrays import Floats64
from .render_target import Rectangle, intersection, scaled

FIELD_OF_VIEW = 25.0  # [degrees]; a portrait lens (about 80 mm on 35 mm film) keeps noses small
FRAME_MARGIN = 0.06  # free fraction of the frame on each side, because mouths open and brows rise
_UNIT_CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], np.float64)
_STEEPEST_PITCH = 89.0  # [degrees]; greatest pitch, because beyond 90 "up" would tip over

# Name -> yaw and pitch [degrees]: yaw moves toward the subject's left, pitch moves up.
VIEWS: dict[str, tuple[float, float]] = {
    "front": (0.0, 0.0),
    "three-quarter": (35.0, 4.0),
    "three-quarter-right": (-35.0, 4.0),
    "profile": (90.0, 0.0),
    "profile-right": (-90.0, 0.0),
    "top": (0.0, 90.0),
    "below": (0.0, -38.0),
}


@dataclass
class OrbitCamera:
    """A camera on a sphere around `target`; all fields may be set.

    - target: point that the camera looks at and turns around, (3,), float64.
    - distance: distance of the camera from the target [unit of the scene].
    - yaw, pitch: angles of the camera on the sphere [degrees]; 0 and 0 are in front.
    - field_of_view: vertical field of view [degrees].
    - narrowest_aspect: frames of a smaller aspect (width / height) show the same width of the
      scene, and more of its height; `framing` sets this field.
    - scene_centre, scene_radius: a sphere around the framed scene, which sets the clipping planes.
    """

    target: Floats64
    distance: float
    yaw: float
    pitch: float
    scene_centre: Floats64
    scene_radius: float
    field_of_view: float = FIELD_OF_VIEW
    narrowest_aspect: float = 0.0

    @classmethod
    def framing(
        cls,
        vertices: npt.NDArray[Any],
        *,
        view: str = "front",
        field_of_view: float = FIELD_OF_VIEW,
    ) -> "OrbitCamera":
        """Return a camera that sees all `vertices`, shape (n, 3), from a named view.

        Raises ValueError for an unknown view, and for missing or infinite vertices.
        """
        if view not in VIEWS:
            raise ValueError(f"view is '{view}'; it must be one of {', '.join(VIEWS)}")
        points = np.asarray(vertices, np.float64)
        if points.ndim != 2 or points.shape[1] != 3 or not len(points):
            raise ValueError(f"vertices has shape {points.shape}; it must be (n, 3) with n >= 1")
        if not np.isfinite(points).all():
            raise ValueError("vertices holds numbers that are not finite; cannot frame them")
        centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
        radius = max(float(np.linalg.norm(points - centre, axis=1).max()), 1e-6)
        yaw, pitch = VIEWS[view]
        camera = cls(
            target=centre,
            distance=radius / math.sin(math.radians(0.5 * field_of_view)),
            yaw=yaw,
            pitch=pitch,
            scene_centre=centre.copy(),
            scene_radius=radius,
            field_of_view=field_of_view,
        )
        camera.fit(points)
        return camera

    def copy(self) -> "OrbitCamera":
        """Return an independent copy of this camera."""
        return replace(self, target=self.target.copy(), scene_centre=self.scene_centre.copy())

    def orbit(self, yaw: float, pitch: float = 0.0) -> None:
        """Turn around the target by `yaw`, and up by `pitch` [degrees], but not over the poles."""
        self.yaw = math.remainder(self.yaw + yaw, 360.0)
        self.pitch = min(max(self.pitch + pitch, -_STEEPEST_PITCH), _STEEPEST_PITCH)

    def pan(self, right: float, up: float) -> None:
        """Move the camera sideways by fractions of the frame's height, at the target's distance."""
        height = 2.0 * self.distance * math.tan(math.radians(0.5 * self.field_of_view))
        right_axis, up_axis, _ = self.axes()
        self.target = self.target + height * (right * right_axis + up * up_axis)

    def zoom(self, factor: float) -> None:
        """Make the target `factor` times as large in the frame by moving closer or back."""
        if not factor > 0.0:
            raise ValueError(f"zoom factor is {factor}; it must be positive (2 = twice as large)")
        closest = 0.02 * self.scene_radius
        farthest = 100.0 * self.scene_radius
        self.distance = min(max(self.distance / factor, closest), farthest)

    def change_lens(self, field_of_view: float) -> None:
        """Change the vertical field of view [degrees]; move so that the target keeps its size."""
        if not 0.0 < field_of_view < 180.0:
            raise ValueError(f"field_of_view is {field_of_view}; it must be above 0, below 180")
        now = math.tan(math.radians(0.5 * self.field_of_view))
        self.distance *= now / math.tan(math.radians(0.5 * field_of_view))
        self.field_of_view = field_of_view

    def axes(self) -> tuple[Floats64, Floats64, Floats64]:
        """Return unit vectors in the world, each (3,): right, up, and from target to camera."""
        yaw = math.radians(self.yaw)
        pitch = math.radians(self.pitch)
        sine = math.sin(yaw)
        cosine = math.cos(yaw)
        rise = math.sin(pitch)
        level = math.cos(pitch)
        right = np.array([cosine, 0.0, -sine])
        up = np.array([-sine * rise, level, -cosine * rise])
        return right, up, np.array([sine * level, rise, cosine * level])

    @property
    def eye(self) -> Floats64:
        """Position of the camera in the world, (3,), float64."""
        return self.target + self.distance * self.axes()[2]

    def view_matrix(self) -> Matrix44:
        """Return the matrix from the world to view space (x right, y up, z to the viewer)."""
        axes = np.stack(self.axes())
        matrix = np.eye(4)
        matrix[:3, :3] = axes.T
        matrix[3, :3] = -axes @ self.eye
        return Matrix44(matrix)

    def projection_matrix(self, aspect: float) -> Matrix44:
        """Return the matrix from view space to clip space; aspect: width / height of the frame."""
        near, far = self._depth_range()
        degrees = 2.0 * math.degrees(math.atan(self._half_height(aspect)))
        return Matrix44.perspective_projection(degrees, aspect, near, far, dtype=np.float64)

    def focal(self, aspect: float, height: float) -> float:
        """Return the focal length [pixels] for a frame of some aspect and height [pixels]."""
        return 0.5 * height / self._half_height(aspect)

    def _half_height(self, aspect: float) -> float:
        """Return half the height of the frame at distance 1 from the camera."""
        if not aspect > 0.0:
            raise ValueError(f"aspect is {aspect}; it must be positive (width / height)")
        half_height = math.tan(math.radians(0.5 * self.field_of_view))
        return half_height * max(1.0, self.narrowest_aspect / aspect)

    def _depth_range(self) -> tuple[float, float]:
        """Return distances of the clipping planes, close to the scene for precise depths."""
        depth = float(np.dot(self.eye - self.scene_centre, self.axes()[2]))
        reach = 3.2 * self.scene_radius  # shoulders lie outside the framed scene
        near = max(depth - reach, 0.01 * self.scene_radius)
        return near, max(depth + reach, 2.0 * near)

    def fit(self, points: npt.NDArray[Any], margin: float = FRAME_MARGIN) -> None:
        """Centre `points`, (n, 3), in the frame, and move as close as the margin allows."""
        usable = (1.0 - 2.0 * margin) * math.tan(math.radians(0.5 * self.field_of_view))
        axes = np.stack(self.axes())
        for _ in range(8):  # repeated, because perspective makes one round inexact
            x, y, z = self._step_back(points, axes, usable)
            depth = self.distance - z
            across = x / depth
            along = y / depth
            centre = 0.5 * np.array([across.min() + across.max(), along.min() + along.max()])
            self.target = self.target + self.distance * (centre @ axes[:2])
        x, y, z = self._step_back(points, axes, usable)
        self.distance = max(self.distance, float(z.max()) + 0.05 * self.scene_radius)
        widest = float((np.abs(x) / (self.distance - z)).max())
        self.narrowest_aspect = widest / usable

    def _step_back(self, points: npt.NDArray[Any], axes: Floats64, usable: float) -> Floats64:
        """Move until the frame is high enough for points, (n, 3).

        usable: tangent of half the height of the frame without margins. Returns the points relative
        to the target, in the camera's axes, (3, n).
        """
        relative: Floats64 = axes @ (points - self.target).T
        _, y, z = relative
        self.distance = float((z + np.abs(y) / usable).max()) or self.scene_radius
        return relative


@dataclass(frozen=True, eq=False)
class CameraView:
    """A copy of a camera, and the viewport into which it draws.

    - viewport: x, y, width, height from the lower left corner [pixels of the surface]; None: the
      whole surface.
    - clip: the part of the surface that is drawn; None: the whole viewport. Two views with
      different clips show two meshes in one picture.
    """

    camera: OrbitCamera
    viewport: Rectangle | None = None
    clip: Rectangle | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "camera", self.camera.copy())


class PlacedView:
    """The pixels and the matrices of a view on one target.

    viewport, clip: rectangles of the target [pixels].
    world_to_view: matrix from the world to view space, for row vectors, (4, 4), float64.
    projection: matrix from view space to clip space, for row vectors, (4, 4), float64.
    """

    def __init__(self, view: CameraView, size: tuple[int, int], scale: float = 1.0) -> None:
        """size: size of the target [pixels]. scale: pixels of the target per pixel of the surface.

        Raises ValueError for a viewport without pixels.
        """
        camera = view.camera
        whole = (0, 0, *size)
        self.camera = camera
        self.viewport = whole if view.viewport is None else scaled(view.viewport, scale)
        self.clip = self.viewport
        if view.clip is not None:
            self.clip = intersection(self.viewport, scaled(view.clip, scale))
        aspect = self.viewport[2] / self.viewport[3]
        self.world_to_view: Floats64 = np.asarray(camera.view_matrix())
        self.projection: Floats64 = np.asarray(camera.projection_matrix(aspect))

    @cached_property
    def world_to_clip(self) -> Floats64:
        """The matrix from the world to clip space, for row vectors, (4, 4), float64."""
        return self.world_to_view @ self.projection

    def covered_pixels(self, corners: Floats64, padding: float = 2.0) -> Rectangle:
        """Return a rectangle around the hull of `corners`, (n, 3), within the clip.

        padding: added on each side [pixels]. The rectangle is the whole clip if a corner is not
        finite or lies behind the camera. Its width or height is 0 if the hull is not visible.
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

    @cached_property
    def depth_range(self) -> tuple[float, float]:
        """Smallest depth of the scene on the target, 0 to 1, and the reciprocal of its range."""
        camera = self.camera
        centre_distance = float(np.dot(camera.eye - camera.scene_centre, camera.axes()[2]))
        reach = 1.3 * camera.scene_radius  # a face moves beyond its rest pose
        least_distance = 1e-3 * camera.scene_radius
        distances = np.maximum([centre_distance - reach, centre_distance + reach], least_distance)
        at_infinity = 1.0 - self.projection[2, 2]
        depths = np.clip(0.5 * (at_infinity + self.projection[3, 2] / distances), 0.0, 1.0)
        least_reach = 1e-6  # for a scene behind the camera
        return float(depths[0]), 1.0 / max(float(depths[1] - depths[0]), least_reach)

    @cached_property
    def depth_tolerance(self) -> tuple[float, float]:
        """Return the greatest depth difference within one surface, as a linear function of depth.

        Returns its value at depth 0, and its slope. Depths are fractions of `depth_range`. The
        difference corresponds to 0.7 of a pixel's width at this depth.
        """
        fraction = 0.7 / self.camera.focal(self.viewport[2] / self.viewport[3], self.viewport[3])
        least, scale = self.depth_range
        depth_ahead = 0.5 * (1.0 - float(self.projection[2, 2])) - least
        return fraction * scale * depth_ahead, -fraction


def box_corners(points: npt.NDArray[Any]) -> Floats64:
    """Return the corners of the bounding box of points (n, 3), shape (8, 3), float64."""
    low = points.min(axis=0).astype(np.float64)
    high = points.max(axis=0).astype(np.float64)
    with np.errstate(over="ignore", invalid="ignore"):  # an unstable simulation is also drawn
        corners: Floats64 = low + _UNIT_CUBE * (high - low)
    return corners
