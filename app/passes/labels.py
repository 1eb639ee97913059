"""All that is told of one picture beside its pixels, as plain numbers for JSON.

The 68 iBug landmarks are vertices of the simulated mesh, through which the refined surface goes,
too. The pupils, 68 the right one and 69 the left, are the points of the eyeballs that look straight
ahead.

A point is visible where it is seen: what the depth map has at its own pixel is as far away as the
point, within a tolerance. That is 2 mm for landmarks, since the drawn skin has wrinkles of up to
1 mm and may be steep within a pixel, and 0.6 mm for pupils, over which a lid of a millimetre may
close; and the width of a pixel where that is more.

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
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius import render

from ..scenes import FaceScene, Scene

Floats = npt.NDArray[np.float64]
SIDES = ("right", "left")  # the subject's, in the order of landmarks
FORWARD = np.array([0.0, 0.0, 1.0])  # of a head and of an eye at rest
_FACING = np.diag([1.0, -1.0, -1.0])  # the axes of a head that faces the camera, in the camera's
DIGITS = 8  # behind the point: whoever projects points anew is off by less than 1e-4 pixels
COUNT = 70
TOLERANCE, PUPIL_TOLERANCE = 2.0, 0.6  # [mm] along the camera's axis


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
