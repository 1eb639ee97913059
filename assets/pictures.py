"""Pictures as arrays: PNG files that hold sRGB, row 0 on top."""

from pathlib import Path

import numpy as np
from PIL import Image, UnidentifiedImageError

from .model import AssetError, Picture


def read_picture(path: Path) -> Picture:
    """Read a picture, shape (H, W, 3), uint8, read-only; AssetError if it cannot be read."""
    try:
        with Image.open(path) as image:
            picture: Picture = np.array(image.convert("RGB"), dtype=np.uint8)
    except FileNotFoundError as error:
        raise AssetError(
            f"the picture {path} is missing; paint it with 'python -m risorius.assets.build'"
        ) from error
    except (OSError, ValueError, SyntaxError, UnidentifiedImageError) as error:
        raise AssetError(
            f"{path} is not a readable picture ({error}); "
            "paint it with 'python -m risorius.assets.build'"
        ) from error
    picture.flags.writeable = False
    return picture


def write_picture(path: Path, picture: Picture) -> None:
    """Write a picture, as small as PNG can be."""
    Image.fromarray(picture).save(path, format="PNG", optimize=True)
