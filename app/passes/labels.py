"""Labels and passes of one picture, and the files that hold them beside it.

frame_00000.exr         depth, normal, triangle, splits: 32 bits a channel, lossless
frame_00000_seg.png     segmentation: 8 bits, one class number a pixel
frame_00000_ldmks.txt   landmarks: x and y of each in a row [pixels]
frame_00000.json        camera, head, gaze, landmarks, controls: plain numbers

`docs/passes.md` describes the keys, visible landmarks, axes and angles. The camera's axes are
OpenCV's, the head's are its own. A head's controls turn it about axes that landmarks give, some 2
degrees off these.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import PIL.Image

from risorius import render
from risorius.geometry.arrays import Flags, Floats32, Floats64

from ..errors import UserError
from ..extras import needed
from ..files import named_in_text, written_atomically
from ..pictures import Image
from ..scenes import Face, Scene
from .passes import NAMES, OF_FACES, Passes

SIDES = ("right", "left")  # the subject's, in the order of landmarks
DIGITS = 8  # behind the point: points projected anew are off by less than 1e-4 pixels


def labels_of(
    scene: Scene,
    camera: render.OrbitCamera,
    size: tuple[int, int],
    depth: Floats32 | None = None,
) -> dict[str, Any]:
    """The labels of the picture that `camera` takes of `scene` now, `size` pixels large.

    depth: its depth map, for the landmarks; None leaves them out. `docs/passes.md` describes
    the keys. A scene without a face has its camera and controls alone.
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
    face = scene.face
    if face is None:
        return labels
    cranium = face.bone_transforms()["cranium"]
    rotation = placed.rotation @ cranium[:3, :3]
    to_head = cranium[:3, :3].T
    # Against a head that faces the camera: its y and z are opposite to the camera's.
    turned = np.diag([1.0, -1.0, -1.0]) @ rotation
    turns = {
        "yaw": math.atan2(turned[0, 2], turned[2, 2]),
        "pitch": math.asin(min(max(turned[1, 2], -1.0), 1.0)),
        "roll": math.atan2(-turned[1, 0], turned[1, 1]),
    }
    ways = {side: gaze(face, side) for side in SIDES}
    sums = face.simulation.controls.sums
    labels["activations"] = {name: round(value, DIGITS) for name, value in sums.items() if value}
    labels["head"] = {
        "R": _plain(rotation),
        "t": _plain(placed.to_camera(cranium[None, :3, 3])[0]),
        **{name: round(math.degrees(angle), DIGITS) for name, angle in turns.items()},
    }
    labels["gaze"] = {
        side: {"camera": _plain(placed.rotation @ way), "head": _plain(to_head @ way)}
        for side, way in ways.items()
    }
    if depth is not None:
        found = landmarks_in(face, placed, depth)
        labels["landmarks"] = {
            "points": _plain(found.points),
            "pixels": _plain(found.pixels),
            "visible": found.visible.tolist(),
        }
    return labels


def _plain(numbers: Floats64) -> Any:
    """Lists of rounded numbers; no negative zeros."""
    return (np.round(numbers, DIGITS) + 0.0).tolist()


@dataclass(frozen=True)
class Landmarks:
    """The points of one picture: 68 landmarks, the right pupil, the left pupil.

    points: in the scene [mm], (70, 3). pixels: x to the right and y down; the middle of the first
    pixel is (0.5, 0.5), (70, 2). visible: neither hidden nor beside the picture, (70,).
    """

    points: Floats64
    pixels: Floats64
    visible: Flags


def points_of(face: Face) -> Floats64:
    """Where the landmarks and the pupils of a face are now [mm], shape (70, 3)."""
    bones = face.bone_transforms()
    pupils = []
    for side in SIDES:
        bone = f"eye_{side}"
        ball = next(part for part in face.head.parts if part.bone == bone)
        front = ball.vertices[ball.vertices[:, 2].argmax()]
        pupils.append(bones[bone][:3, :3] @ front + bones[bone][:3, 3])
    return np.vstack([face.marked, pupils])


def landmarks_in(face: Face, camera: CameraLabels, depth: Floats32) -> Landmarks:
    """The landmarks of a face in the picture of which `depth`, (H, W), is the depth map."""
    points = points_of(face)
    pixels = camera.project(points)
    depths = camera.to_camera(points)[:, 2]
    height, width = depth.shape
    columns, rows = np.floor(pixels).astype(int).T
    is_inside = (columns >= 0) & (columns < width) & (rows >= 0) & (rows < height)
    seen = depth[np.clip(rows, 0, height - 1), np.clip(columns, 0, width - 1)]
    landmark_count = 70
    # [mm] along the camera's axis: the refined skin may pass a landmark by and be steep within a
    # pixel, and over a pupil a lid of a millimetre may close.
    most_behind = 2.0
    pupil_tolerance = 0.6
    tolerance = np.where(
        np.arange(landmark_count) < landmark_count - len(SIDES), most_behind, pupil_tolerance
    )
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
    intrinsics: Floats64
    rotation: Floats64
    translation: Floats64

    @classmethod
    def of(cls, camera: render.OrbitCamera, size: tuple[float, float]) -> CameraLabels:
        """The labels of `camera` for a picture of `size`."""
        width, height = size
        focal = camera.focal(width / height, height)
        right, up, back = camera.axes()
        rotation = np.stack([right, -up, -back])
        intrinsics = np.array([[focal, 0, width / 2], [0, focal, height / 2], [0, 0, 1.0]])
        return cls(size, intrinsics, rotation, -rotation @ camera.eye)

    def to_camera(self, points: Floats64) -> Floats64:
        """Points of the scene, (n, 3), in the camera's coordinates [mm]."""
        seen: Floats64 = points @ self.rotation.T + self.translation
        return seen

    def project(self, points: Floats64) -> Floats64:
        """Where points of the scene, (n, 3), are in the picture [pixels], (n, 2)."""
        seen = self.to_camera(points) @ self.intrinsics.T
        pixels: Floats64 = seen[:, :2] / seen[:, 2:]
        return pixels


def gaze(face: Face, side: str) -> Floats64:
    """Where the eye of that side looks: a unit vector in the scene, shape (3,)."""
    forward = np.array([0.0, 0.0, 1.0])  # of a head and of an eye at rest
    way: Floats64 = face.bone_transforms()[f"eye_{side}"][:3, :3] @ forward
    return way


CHANNELS = {
    "depth": ("depth.Z",),
    "normal": ("normal.X", "normal.Y", "normal.Z"),
    "triangle": ("triangle.ID",),
    "splits": ("splits",),
}
NOTHING = 0xFFFFFFFF  # of triangles, where integers have no sign: -1 when read as signed
ENDS = (".exr", "_seg.png", "_ldmks.txt", ".json")


def beside(picture: Path) -> list[Path]:
    """The files that may come to lie beside a picture, in the order of ENDS."""
    return [picture.with_name(picture.stem + end) for end in ENDS]


@dataclass(frozen=True)
class Labelled:
    """All that is known of one picture.

    images: passes by their names (passes.py). labels: the content of its JSON file (`labels_of`).
    """

    images: dict[str, npt.NDArray[Any]]
    labels: dict[str, Any]

    def save(self, picture: Path) -> None:
        """Write the files that belong beside `picture`; OSError where one cannot be written."""
        exr, classes, landmarks, labels = beside(picture)
        floats = {name: image for name, image in self.images.items() if name in CHANNELS}
        if floats:
            write_exr(exr, floats)
        if "segmentation" in self.images:
            PIL.Image.fromarray(self.images["segmentation"]).save(classes)
        if "landmarks" in self.labels:
            rows = self.labels["landmarks"]["pixels"]
            np.savetxt(landmarks, rows, fmt="%.3f", newline="\n")
        text = json.dumps(self.labels, separators=(",", ":"), allow_nan=False)
        labels.write_text(text + "\n", encoding="utf-8")


def save_labelled(picture: Path, image: Image, known: Labelled | None) -> None:
    """Write a picture, its labels and passes, all or nothing; UserError where that fails."""
    with written_atomically(picture) as part:
        PIL.Image.fromarray(image).save(part, format="PNG")
        if known is not None:
            known.save(part)


def check_wanted(wanted: Sequence[str], scene: str) -> None:
    """UserError for passes that are none, that this scene has not, or that cannot be written."""
    for name in wanted:
        if name not in NAMES:
            raise UserError(f"--passes: '{name}' is no pass; allowed are {', '.join(NAMES)}")
        if name in OF_FACES and scene != "face":
            raise UserError(
                f"--passes {name}: the scene {scene} has no face; allowed are "
                f"{', '.join(each for each in NAMES if each not in OF_FACES)}"
            )
    if any(name in CHANNELS for name in wanted):
        openexr()


def labelled(
    scene: Scene,
    passes: Passes,
    camera: render.OrbitCamera,
    style: render.Style,
    wanted: Sequence[str],
) -> Labelled:
    """Labels and passes of the picture of a scene that the pipeline of `passes` drew last."""
    has_landmarks = "landmarks" in wanted
    images = passes.draw(camera, style, {*wanted, "depth"} if has_landmarks else wanted)
    depth = images["depth"] if has_landmarks else None
    labels = labels_of(scene, camera, passes.size, depth)
    return Labelled({name: images[name] for name in images if name in wanted}, labels)


def openexr() -> Any:
    """OpenEXR's module; UserError where it is missing."""
    return needed("OpenEXR", "--passes", "passes")


def write_exr(path: Path, passes: Mapping[str, npt.NDArray[Any]]) -> None:
    """Write passes by their names, those of CHANNELS; OSError where that fails."""
    module = openexr()
    channels = {}
    for name, images in passes.items():
        kind = np.float32 if images.dtype.kind == "f" else np.uint32
        layers = images.reshape(*images.shape[:2], -1).astype(kind)
        for k, channel in enumerate(CHANNELS[name]):
            channels[channel] = np.ascontiguousarray(layers[..., k])
    header = {"compression": module.ZIP_COMPRESSION, "type": module.scanlineimage}
    try:
        with named_in_text(path) as named, module.File(header, channels) as file:
            file.write(str(named))
    except RuntimeError as error:  # ... image file "...". No space left on device.
        raise OSError(str(error).rpartition('". ')[2].rstrip(".")) from None
