"""Labels and passes of one picture, and the files that hold them beside it.

frame_00000.exr         depth, normal, triangle, splits: 32 bits a channel, lossless
frame_00000_seg.png     segmentation: 8 bits, one class number a pixel
frame_00000_ldmks.txt   landmarks: x and y of each in a row [pixels]
frame_00000.json        camera, head, gaze, landmarks, controls: plain numbers

`docs/passes.md` describes the keys, visible landmarks, axes and angles. The camera has OpenCV's
axes, and the head has its own axes. Controls turn the head about axes from landmarks, which differ
from the head's axes by some 2 degrees.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import PIL.Image

from risorius import render
from risorius.geometry.arrays import Flags, Floats32, Floats64
from risorius.geometry.transforms import angles_of

from ..errors import UserError
from ..extras import optional_import
from ..files import named_in_text, written_atomically
from ..pictures import Image
from ..scenes import Face, Scene
from .camera import CameraLabels
from .landmarks import EYE_SIDES, Landmarks, jaw_on_bone, landmarks_in
from .passes import OF_FACES, PASS_NAMES, Passes

LABEL_DECIMALS = 8  # decimals, with which projected points are exact to 1e-4 pixels


def labels_of(
    scene: Scene,
    camera: render.OrbitCamera,
    size: tuple[int, int],
    depth: Floats32 | None = None,
    covered: Flags | None = None,
) -> dict[str, Any]:
    """Return the labels of a picture of the current scene, `size` pixels large.

    depth: depth map of the picture, (H, W), for landmarks; None leaves landmarks out. covered:
    flags of pixels where a mask hides landmarks, (H, W); None: no mask. `docs/passes.md` describes
    the keys. A scene without a face has labels only for camera and controls.
    """
    placed = CameraLabels.from_camera(camera, size)
    labels: dict[str, Any] = {
        "camera": {
            "width": size[0],
            "height": size[1],
            "K": _as_lists(placed.intrinsics),
            "R": _as_lists(placed.rotation),
            "t": _as_lists(placed.translation),
        },
        "controls": {name: value for name, value in scene.values.items() if value},
    }
    face = scene.face
    if face is None:
        return labels
    cranium = face.bone_transforms()["cranium"]
    rotation = placed.rotation @ cranium[:3, :3]
    to_head = cranium[:3, :3].T
    # Relative to a head that faces the camera: its y and z are opposite to the camera's.
    turned = np.diag([1.0, -1.0, -1.0]) @ rotation
    angles = zip(("yaw", "pitch", "roll"), angles_of(turned), strict=True)
    directions = {side: gaze(face, side) for side in EYE_SIDES}
    sums = face.simulation.controls.sums
    labels["activations"] = {
        name: round(value, LABEL_DECIMALS) for name, value in sums.items() if value
    }
    labels["head"] = {
        "R": _as_lists(rotation),
        "t": _as_lists(placed.to_camera(cranium[None, :3, 3])[0]),
        **{name: round(angle, LABEL_DECIMALS) for name, angle in angles},
    }
    labels["gaze"] = {
        side: {
            "camera": _as_lists(placed.rotation @ direction),
            "head": _as_lists(to_head @ direction),
        }
        for side, direction in directions.items()
    }
    if depth is not None:
        on_bone = jaw_on_bone(face, placed, depth, covered)
        labels["landmarks"] = {
            **_plain_landmarks(landmarks_in(face, placed, depth, covered)),
            "jaw_on_bone": _plain_landmarks(on_bone),
        }
    return labels


def _plain_landmarks(found: Landmarks) -> dict[str, Any]:
    return {
        "points": _as_lists(found.points),
        "pixels": _as_lists(found.pixels),
        "visible": found.visible.tolist(),
    }


def _as_lists(numbers: Floats64) -> Any:
    """Convert an array to lists of rounded numbers without negative zeros."""
    return (np.round(numbers, LABEL_DECIMALS) + 0.0).tolist()


def gaze(face: Face, side: str) -> Floats64:
    """Return the direction of gaze of an eye, a unit vector in the scene, shape (3,)."""
    forward = np.array([0.0, 0.0, 1.0])  # direction of a head and of an eye at rest
    direction: Floats64 = face.bone_transforms()[f"eye_{side}"][:3, :3] @ forward
    return direction


PASS_CHANNELS = {
    "depth": ("depth.Z",),
    "normal": ("normal.X", "normal.Y", "normal.Z"),
    "triangle": ("triangle.ID",),
    "splits": ("splits",),
}
FILE_ENDS = (".exr", "_seg.png", "_ldmks.txt", ".json")


def files_beside(picture: Path) -> list[Path]:
    """Return the paths of files that may be written beside a picture, in the order of FILE_ENDS."""
    return [picture.with_name(picture.stem + end) for end in FILE_ENDS]


@dataclass(frozen=True)
class Labelled:
    """Passes and labels of one picture.

    images: passes by their names (passes.py). labels: the content of its JSON file (`labels_of`).
    """

    images: dict[str, npt.NDArray[Any]]
    labels: dict[str, Any]

    def save(self, picture: Path) -> None:
        """Write the files that belong beside `picture`; raises OSError if one cannot be written."""
        exr, classes, landmarks, labels = files_beside(picture)
        floats = {name: image for name, image in self.images.items() if name in PASS_CHANNELS}
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
    """Write a picture, its labels and passes, all or nothing; raises UserError if that fails."""
    with written_atomically(picture) as part:
        PIL.Image.fromarray(image).save(part, format="PNG")
        if known is not None:
            known.save(part)


def check_wanted(wanted: Sequence[str], scene: str) -> None:
    """Raise UserError for unknown passes, and for passes that the scene or a library lacks."""
    for name in wanted:
        if name not in PASS_NAMES:
            raise UserError(
                f"--passes: '{name}' is not a pass; allowed are {', '.join(PASS_NAMES)}"
            )
        if name in OF_FACES and scene != "face":
            raise UserError(
                f"--passes {name}: the scene {scene} has no face; allowed are "
                f"{', '.join(each for each in PASS_NAMES if each not in OF_FACES)}"
            )
    if any(name in PASS_CHANNELS for name in wanted):
        openexr()


def labelled(
    scene: Scene,
    passes: Passes,
    camera: render.OrbitCamera,
    style: render.Style,
    wanted: Sequence[str],
) -> Labelled:
    """Return labels and passes of the last picture that the pipeline of `passes` drew."""
    has_landmarks = "landmarks" in wanted
    images = passes.draw(camera, style, {*wanted, "depth"} if has_landmarks else wanted)
    depth = images["depth"] if has_landmarks else None
    labels = labels_of(scene, camera, passes.size, depth)
    return Labelled({name: images[name] for name in images if name in wanted}, labels)


def openexr() -> Any:
    """Import OpenEXR's module; raise UserError if it is missing."""
    return optional_import("OpenEXR", "--passes", "passes")


def write_exr(path: Path, passes: Mapping[str, npt.NDArray[Any]]) -> None:
    """Write passes, by names in PASS_CHANNELS, into an OpenEXR file; OSError if that fails."""
    module = openexr()
    channels = {}
    for name, images in passes.items():
        kind = np.float32 if images.dtype.kind == "f" else np.uint32
        layers = images.reshape(*images.shape[:2], -1).astype(kind)
        for k, channel in enumerate(PASS_CHANNELS[name]):
            channels[channel] = np.ascontiguousarray(layers[..., k])
    header = {"compression": module.ZIP_COMPRESSION, "type": module.scanlineimage}
    try:
        with named_in_text(path) as named, module.File(header, channels) as file:
            file.write(str(named))
    except RuntimeError as error:  # 'image file "...". No space left on device.'
        raise OSError(str(error).rpartition('". ')[2].rstrip(".")) from None
