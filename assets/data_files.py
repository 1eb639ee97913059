"""The files that belong to an asset: arrays, tables and images, read whole or refused in one line.

Images are PNG files that hold sRGB, row 0 on top.
"""

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from .errors import AssetError

Image = npt.NDArray[np.uint8]
Arrays = dict[str, npt.NDArray[Any]]

AGAIN = "install risorius again"  # what mends a file that is part of the package


def read_arrays(path: Path) -> Arrays:
    """Read an npz file, array name -> array, read-only; AssetError if it is missing or broken."""
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
    except FileNotFoundError as error:
        raise AssetError(f"the data file {path} is missing; {AGAIN}") from error
    except Exception as error:  # zip, its compression and numpy have their own kinds each
        raise AssetError(
            f"the data file {path} is not a readable npz file ({error}); {AGAIN}"
        ) from error
    for array in arrays.values():
        array.flags.writeable = False
    return arrays


def read_arrays_of(fingerprint: int, path: Path, names: tuple[str, ...]) -> Arrays:
    """Read a file that was made from the mesh with this fingerprint and has arrays of these names.

    Raises AssetError if it is missing or broken, or belongs to another mesh.
    """
    arrays = read_arrays(path)
    if int(arrays.get("made_from", -1)) != fingerprint:
        raise AssetError(f"{path} was made for another head; {AGAIN}")
    for name in names:
        if name not in arrays:
            raise AssetError(f"{path} has no array '{name}'; {AGAIN}")
    return arrays


def read_toml(path: Path) -> dict[str, Any]:
    """Read a TOML file; {} where there is none: a head without a rig is still a head.

    Raises AssetError when it is not TOML.
    """
    try:
        with path.open("rb") as file:
            return tomllib.load(file)
    except FileNotFoundError:
        return {}
    except (OSError, tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise AssetError(f"{path} is not readable as TOML: {error}") from error


def read_image(path: Path, *, mode: str = "RGB") -> Image:
    """Read an image, shape (H, W, 3), in mode "L" (H, W), uint8, read-only.

    Raises AssetError if it cannot be read.
    """
    import PIL.Image  # which to load a head takes no time for

    try:
        with PIL.Image.open(path) as file:
            image: Image = np.array(file.convert(mode), dtype=np.uint8)
    except FileNotFoundError as error:
        raise AssetError(f"the picture {path} is missing; {AGAIN}") from error
    except (OSError, ValueError, SyntaxError) as error:
        raise AssetError(f"{path} is not a readable picture ({error}); {AGAIN}") from error
    image.flags.writeable = False
    return image
