"""Readers for the files of an asset: arrays, tables and images; errors are one line each.

Images are PNG files that hold sRGB, row 0 on top.
"""

import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from .errors import AssetError

Image = npt.NDArray[np.uint8]
Arrays = dict[str, npt.NDArray[Any]]


@contextmanager
def _errors_named(path: Path) -> Iterator[None]:
    """Raise every error of a reader as an AssetError that names the file."""
    try:
        yield
    except Exception as error:  # zip, its compression, numpy and PNG each raise their own kinds
        raise AssetError(f"{path} cannot be read ({error}); install risorius again") from error


def read_arrays(path: Path, *names: str) -> Arrays:
    """Read an npz file: name -> read-only array; raises AssetError if it is missing or broken.

    names: the arrays to read; without names all of them, which takes longer.
    """
    with _errors_named(path), np.load(path, allow_pickle=False) as file:
        arrays = {name: file[name] for name in names or file.files}
    for array in arrays.values():
        array.flags.writeable = False
    return arrays


def read_toml(path: Path) -> dict[str, Any]:
    """Read a TOML file; raises AssetError if it is missing or broken."""
    with _errors_named(path):
        return tomllib.loads(path.read_text("utf-8"))


def read_image(path: Path, *, mode: str = "RGB") -> Image:
    """Read an image, (H, W, 3) or in mode "L" (H, W), uint8, read-only; raises AssetError."""
    import PIL.Image  # imported late, so that loading a head is fast

    with _errors_named(path), PIL.Image.open(path) as file:
        image: Image = np.array(file.convert(mode), dtype=np.uint8)
    image.flags.writeable = False
    return image
