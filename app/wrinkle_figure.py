"""The picture of wrinkles in docs/viewer.md, drawn by `python -m risorius.app.wrinkle_figure`.

Some poses of the built-in head from near, without and with the wrinkles that the simulation makes.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from risorius import render

from .capture import Capture, CaptureOptions
from .errors import run_alone
from .labels import contact_sheet
from .outputs import Frame, save_png
from .scenes import FaceScene

FILE = Path("docs/pictures/wrinkles.png")
CELL = (270, 250)  # [pixels] of one picture
SETTLED = 1.5  # [s]
# Pose, camera, what it looks at [mm].
VIEWS = (
    ("surprise", "-22,2,2.1", (0.0, 20.0, 80.0)),
    ("anger", "-12,2,3.0", (0.0, 12.0, 90.0)),
    ("joy", "-40,2,2.8", (-32.0, -14.0, 75.0)),
    ("disgust", "-20,2,2.8", (-4.0, -6.0, 90.0)),
    ("AU17", "-20,2,2.8", (0.0, -78.0, 90.0)),
    ("kiss", "-12,2,4.5", (0.0, -64.0, 95.0)),
)


def wrinkles(size: tuple[int, int] = CELL) -> Frame:
    """Draw all poses, side by side without and with wrinkles."""
    scene = FaceScene()
    cells = []
    for pose, camera, target in VIEWS:
        scene.reset()
        scene.pose({pose: 1.0})
        scene.step(SETTLED)
        for strength in (0.0, 1.0):
            style = render.Style(wrinkles=strength)
            options = CaptureOptions(size=size, camera=camera, style=style)
            with Capture(scene, options) as capture:
                capture.camera.target = np.array(target)
                words = "with wrinkles" if strength else "without"
                cells.append((f"{pose}, {words}", capture.picture()))
    return contact_sheet(cells, columns=4, cell_width=size[0])


def main(arguments: Sequence[str]) -> None:
    """Draw the picture into the file given."""
    parser = argparse.ArgumentParser(
        prog="python -m risorius.app.wrinkle_figure", description=(__doc__ or "").splitlines()[0]
    )
    parser.add_argument("file", nargs="?", type=Path, default=FILE)
    save_png(parser.parse_args(arguments).file, wrinkles())


if __name__ == "__main__":
    run_alone(main)
