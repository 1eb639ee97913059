"""Options and drawing functions for the programs that draw the documentation's figures.

`python docs/figures/figures.py FILE.png ...` copies pictures of `risorius capture`, `risorius
reproduce` and programs on pages into docs/pictures.
"""

from __future__ import annotations

import argparse
import io
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np
import numpy.typing as npt
import PIL.Image

from risorius.app.capture import Capture, CaptureOptions
from risorius.app.capture.captions import contact_sheet
from risorius.app.errors import UserError, report_user_errors
from risorius.app.files import check_file, written_atomically
from risorius.app.pictures import Image
from risorius.app.scenes import Scene
from risorius.app.stopping import handle_signals

Figure = Callable[[], Image]
PICTURE_FOLDER = Path("docs/pictures")


def shoot(
    scene: Scene,
    pose: Mapping[str, float],
    options: CaptureOptions,
    target: npt.ArrayLike | None = None,
) -> Image:
    """Hold a pose until it is at rest, and draw it. target: the camera's target [mm]."""
    scene.reset()
    scene.pose(pose)
    settling_time = 1.5  # [s] after which a pose stands still
    scene.step(settling_time)
    with Capture(scene, options) as capture:
        if target is not None:
            capture.camera.target = np.asarray(target, dtype=np.float64)
        return capture.draw_image()


def sheet(cells: Sequence[tuple[str, Image]], columns: int) -> Image:
    """Named pictures of one size, each with its name below it."""
    sheet = contact_sheet(cells, columns=columns, cell_width=cells[0][1].shape[1])
    return sheet // 2 * 2  # The last bit is noise; without it, files have a quarter of the size.


def webp(image: Image) -> bytes:
    """A picture as WebP: without loss if that is not much larger."""
    exact = io.BytesIO()
    near = io.BytesIO()
    page = PIL.Image.fromarray(image)
    page.save(exact, "WEBP", lossless=True, quality=80)
    # Of 100: no difference is visible at full size.
    page.save(near, "WEBP", quality=96)
    # Largest size of a lossless picture, relative to a lossy one: line art is smaller.
    most_growth = 1.5
    is_small = len(exact.getvalue()) <= most_growth * len(near.getvalue())
    return (exact if is_small else near).getvalue()


def draw(folder: Path, figures: Mapping[str, Figure]) -> None:
    """Check the folder, then draw each figure into its file NAME.webp."""
    for name in figures:
        check_file(folder / f"{name}.webp")
    for name, figure in figures.items():
        packed = webp(figure())
        with written_atomically(folder / f"{name}.webp") as part:
            part.write_bytes(packed)


def run(about: str | None, figures: Mapping[str, Figure]) -> None:
    """Draw the figures of the command line; mistakes give one line, and signals end the program."""
    parser = argparse.ArgumentParser(description=(about or "").partition("\n")[0])
    parser.add_argument("folder", nargs="?", type=Path, default=PICTURE_FOLDER)
    parser.add_argument("--only", nargs="+", metavar="NAME", default=[], help="only these figures")
    given = parser.parse_args()
    handle_signals()
    with report_user_errors():
        for name in given.only:
            if name not in figures:
                raise UserError(f"unknown figure '{name}'; there are {', '.join(figures)}")
        draw(given.folder, {name: figures[name] for name in given.only or figures})


if __name__ == "__main__":
    handle_signals()
    with report_user_errors():
        opened = {Path(file).stem: PIL.Image.open(file).convert("RGB") for file in sys.argv[1:]}
        draw(PICTURE_FOLDER, {name: partial(np.asarray, image) for name, image in opened.items()})
