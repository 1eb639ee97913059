"""Draw the pictures of passes, strain and data sets: `python docs/figures/passes.py [FOLDER]`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import figures
import numpy as np
import numpy.typing as npt
import PIL.Image
from PIL import ImageDraw

from risorius import render
from risorius.app.capture import Capture, CaptureOptions
from risorius.app.dataset.request import request_of
from risorius.app.dataset.studio import Shot, Studio
from risorius.app.passes.labels import labelled
from risorius.app.passes.passes import PASS_NAMES, Passes
from risorius.app.pictures import Image
from risorius.app.scenes import FaceScene
from risorius.assets import Segment
from risorius.geometry.arrays import Flags


def passes(size: tuple[int, int] = (440, 500)) -> Image:
    """One smile, and all passes of its picture."""
    scene = FaceScene()
    with Capture(scene, CaptureOptions(size=size, camera="front")) as studio:
        turn = (-24.0, 4.0)  # [degrees] of the camera
        studio.camera.orbit(*turn)
        margin = 0.04  # empty border on each side, as a share of the picture
        studio.camera.fit(scene.framing.extent, margin)
        pose = {"AU12": 0.75, "AU6": 0.4, "AU1": 0.5, "jaw_open": 0.3, "head_yaw": -0.15}
        scene.pose(pose)
        settling_time = 1.0  # [s]
        scene.step(settling_time)
        picture = studio.draw_image()
        drawn = Passes(studio.pipeline, studio.viewports[-1].drawn)
        known = labelled(scene, drawn, studio.camera, studio.options.style, PASS_NAMES)
    images = known.images
    on = images["depth"] > 0.0
    colours_of_segments = {
        Segment.SKIN: (221, 176, 152),
        Segment.NOSE: (240, 145, 45),
        Segment.RIGHT_EYE: (40, 85, 225),
        Segment.LEFT_EYE: (40, 195, 225),
        Segment.RIGHT_BROW: (10, 100, 40),
        Segment.LEFT_BROW: (95, 175, 45),
        Segment.RIGHT_EAR: (205, 60, 205),
        Segment.LEFT_EAR: (140, 60, 165),
        Segment.MOUTH_INTERIOR: (110, 10, 20),
        Segment.TOP_LIP: (225, 55, 60),
        Segment.BOTTOM_LIP: (250, 135, 140),
        Segment.NECK: (105, 105, 195),
        Segment.HAIR: (120, 85, 50),
        Segment.CLOTHING: (60, 75, 90),
    }
    cells = {
        "colour": picture,
        "segmentation": _looked_up(images["segmentation"], colours_of_segments),
        "landmarks: hidden ones red": dotted(picture, known.labels, 2.5),
        "depth: near is light": _grey(images["depth"], on),
        "normal: right red, up green, to the eye blue": _directions(images["normal"], on),
        "triangle of the simulated mesh": _looked_up(images["triangle"], _scattered(scene.faces)),
        "splits of its edges": _looked_up(images["splits"], _palette(), on),
    }
    named = [(name, np.asarray(image).astype(np.uint8)) for name, image in cells.items()]
    return figures.sheet(named, 4)


def _looked_up(numbers: npt.NDArray[Any], colours: Any, on: Any = None) -> npt.NDArray[Any]:
    """The colour of each number; black for other numbers and empty pixels."""
    image = np.zeros((*numbers.shape, 3))
    for number, colour in dict(colours).items():
        image[numbers == number] = colour
    return image if on is None else image * on[..., None]


def _scattered(faces: npt.NDArray[Any]) -> dict[int, Any]:
    """A random colour for each triangle."""
    return dict(enumerate(np.random.default_rng(2).integers(50, 235, (len(faces), 3))))


def _palette() -> dict[int, Any]:
    """The colours of splits in the window; none is grey."""
    tints = (np.array(render.CLAY), *map(np.array, render.SPLIT_PALETTE))
    return {count: 255.0 * tint for count, tint in enumerate(tints)}


def _grey(depth: npt.NDArray[Any], on: Flags) -> npt.NDArray[Any]:
    near = depth[on].min()
    far = depth[on].max()
    nearness = (far - depth) / (far - near)
    grey = (60.0 + 195.0 * nearness) * on
    return np.repeat(grey[..., None], 3, axis=2)


def _directions(normal: npt.NDArray[Any], on: Flags) -> npt.NDArray[Any]:
    upright = normal * [1.0, -1.0, -1.0]
    shown: npt.NDArray[Any] = 127.5 * (1.0 + upright) * on[..., None]
    return shown


def dotted(picture: Image, labels: dict[str, Any], radius: float) -> Image:
    """A picture with its landmarks; hidden landmarks are red."""
    page = PIL.Image.fromarray(picture)
    draw = ImageDraw.Draw(page)
    landmarks = labels["landmarks"]
    seen_colour = (40, 230, 60)
    hidden_colour = (235, 60, 40)
    for (x, y), is_visible in zip(landmarks["pixels"], landmarks["visible"], strict=True):
        place = (x - radius, y - radius, x + radius, y + radius)
        draw.ellipse(place, fill=seen_colour if is_visible else hidden_colour)
    return np.asarray(page)


def dataset() -> Image:
    """Samples row by row, and below them some samples with landmarks and classes."""
    # Samples of a seed, as in `risorius dataset`; some also show their labels.
    cell_side = 192
    studio = Studio(
        request_of(Path(), seed=21, size=(cell_side, cell_side), passes=("segmentation",))
    )
    columns = 6
    row_count = 4
    shots = [studio.shoot(index) for index in range(columns * row_count)]
    labelled_samples = (2, 3, 10, 11, 14, 22)  # numbers of samples
    images = [shot.image for shot in shots]
    images += [_labelled(shots[index]) for index in labelled_samples]
    rows = []
    for first in range(0, len(images), columns):
        rows.append(np.hstack(images[first : first + columns]))
    return np.vstack(rows)


def _labelled(shot: Shot) -> Image:
    """A picture with the borders of its classes, and its landmarks; hidden landmarks are red."""
    classes = shot.known.images["segmentation"]
    is_edge = np.zeros(classes.shape, bool)
    is_edge[1:] |= classes[1:] != classes[:-1]
    is_edge[:, 1:] |= classes[:, 1:] != classes[:, :-1]
    edge_colour = np.array((255, 255, 255), np.uint8)
    return dotted(np.where(is_edge[..., None], edge_colour, shot.image), shot.known.labels, 1.5)


if __name__ == "__main__":
    figures.run(__doc__, {"passes": passes, "dataset": dataset})
