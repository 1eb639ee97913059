"""Pictures as arrays, and the PNG files that they are written into."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
import PIL.Image

from .errors import UserError
from .files import check_file, written_atomically

Image = npt.NDArray[np.uint8]  # (H, W, 3), top row first
QUICK_LEVEL = 3  # zlib's level: 2/5 of the time of Pillow's default, files a tenth larger


def check_png(target: Path) -> None:
    """Raise UserError, before any work is done, if `target` cannot be written as a picture."""
    if target.suffix.lower() != ".png":
        raise UserError(f"{target}: pictures are written as .png; choose a name that ends so")
    check_file(target)


def save_png(target: Path, image: Image) -> None:
    """Write one picture; raise UserError for another suffix, and if it cannot be written."""
    check_png(target)
    with written_atomically(target) as part:
        PIL.Image.fromarray(image).save(part, format="PNG", compress_level=QUICK_LEVEL)
