"""Draw the animated picture of the README: `python docs/figures/wipe.py [FILE]`.

A face smiles, wonders and comes to rest again. A line goes over it: left of the line stands the
mesh that is simulated, right of it the refined mesh as skin. The file is an animated WebP.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import PIL.Image

from risorius import render
from risorius.app.capture import Capture, CaptureOptions
from risorius.app.errors import report_user_errors
from risorius.app.files import written_atomically
from risorius.app.pictures import Image
from risorius.app.refining.presets import STATIC, Refinement
from risorius.app.scenes import FaceScene
from risorius.app.script.script_file import parse_script
from risorius.app.stopping import handle_signals

FILE = Path("docs/pictures/wipe.webp")


def frames(size: tuple[int, int], frames_per_second: float) -> Iterator[Image]:
    """The pictures of the film, each of shape (height, width, 3)."""
    script_text = """
title = "Wipe"
duration = 5.0
[[pose]]
time = 0.2
[[pose]]
time = 1.0
joy = 0.9
head_yaw = 0.12
[[pose]]
time = 1.9
joy = 0.9
head_yaw = 0.12
[[pose]]
time = 2.7
surprise = 0.9
head_yaw = -0.1
[[pose]]
time = 3.5
surprise = 0.8
head_yaw = -0.1
[[pose]]
time = 4.3
"""
    script = parse_script(script_text, source="the script")
    scene = FaceScene()
    clay = render.Style(textured=False, albedo=render.CLAY)
    wire = replace(clay, wireframe=True, shading=render.Shading.FLAT)
    skin = CaptureOptions(size, frames_per_second, camera="-24,2,1.32")
    mesh = replace(skin, refinement=Refinement(refiner=STATIC), style=wire)
    with Capture(scene, skin) as right, Capture(scene, mesh) as left:
        for capture in (right, left):
            capture.camera.target = scene.framing.focus + np.array([0.0, -4.0, 0.0])
        line_colour = (255, 255, 255)
        for time in right.play(script, progress=False):
            turn = math.cos(2.0 * math.pi * time / script.duration)
            column = round((0.5 - 0.36 * turn) * size[0])
            image = right.draw_image()
            image[:, :column] = left.draw_image()[:, :column]
            image[:, column - 1 : column + 1] = line_colour
            yield image


def save(path: Path, size: tuple[int, int] = (480, 560), frames_per_second: float = 20.0) -> None:
    """Draw the film, and write it whole or not at all."""
    pages = [PIL.Image.fromarray(image) for image in frames(size, frames_per_second)]
    with written_atomically(path) as part:
        pages[0].save(
            part,
            "WEBP",
            save_all=True,
            append_images=pages[1:],
            duration=round(1000.0 / frames_per_second),
            loop=0,
            quality=55,
            method=6,
        )


if __name__ == "__main__":
    handle_signals()
    with report_user_errors():
        save(Path(sys.argv[1]) if len(sys.argv) > 1 else FILE)
