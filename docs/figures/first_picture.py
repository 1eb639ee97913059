"""Draw what the window shows while it loads: `python docs/figures/first_picture.py`.

The head as the window has it at first, on nothing; it comes along as assets/data/first_picture.png.
"""

from __future__ import annotations

from pathlib import Path

from risorius import render
from risorius.app.capture import Capture, CaptureOptions
from risorius.app.capture.cameras import whole_scene
from risorius.app.files import save_png
from risorius.app.scenes import FaceScene

SIZE = (540, 540)  # [pixels]; a window enlarges it, for a second
TARGET = Path(__file__).parents[2] / "assets" / "data" / "first_picture.png"


def draw() -> None:
    """Write it."""
    scene = FaceScene()
    style = render.Style(background=None)
    options = CaptureOptions(SIZE, camera=whole_scene(scene, None), style=style)
    with Capture(scene, options) as capture:
        save_png(TARGET, capture.draw_image(), is_small=True)


if __name__ == "__main__":
    draw()
