"""The files that lie beside a picture: what is known of it, pass by pass.

frame_00000.exr         depth, normal, triangle, splits, tension: 32 bits a channel, lossless
frame_00000_seg.png     segmentation: 8 bits, one class number a pixel
frame_00000_ldmks.txt   landmarks: x and y of each in a row [pixels]
frame_00000.json        camera, head, gaze, landmarks, controls          labels.py
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

from ..errors import UserError, needed
from ..files import Image, written_atomically
from .labels import labels_of
from .passes import NAMES, OF_FACES, Passes

CHANNELS = {
    "depth": ("depth.Z",),
    "normal": ("normal.X", "normal.Y", "normal.Z"),
    "triangle": ("triangle.ID",),
    "splits": ("splits",),
    "tension": ("tension.stretch", "tension.compression"),
}
NOTHING = 0xFFFFFFFF  # of triangles, where integers have no sign: -1 when read as signed
ENDS = (".exr", "_seg.png", "_ldmks.txt", ".json")


def beside(picture: Path) -> list[Path]:
    """The files that may come to lie beside a picture, in the order of ENDS."""
    return [picture.with_name(picture.stem + end) for end in ENDS]


@dataclass(frozen=True)
class Labelled:
    """All that is known of one picture.

    images: passes by their names (passes.py). labels: what its JSON file holds (labels.py).
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
    """Write a picture and what is known of it, all or nothing; UserError where that cannot be."""
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


def labelled(passes: Passes, camera: render.OrbitCamera, wanted: Sequence[str]) -> Labelled:
    """What is known of the picture that the pipeline of `passes` drew last, by `camera`."""
    has_landmarks = "landmarks" in wanted
    images = passes.draw(camera, {*wanted, "depth"} if has_landmarks else wanted)
    depth = images["depth"] if has_landmarks else None
    labels = labels_of(passes.scene, camera, passes.size, depth)
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
        with module.File(header, channels) as file:
            file.write(str(path))
    except RuntimeError as error:  # ... image file "...". No space left on device.
        raise OSError(str(error).rpartition('". ')[2].rstrip(".")) from None
