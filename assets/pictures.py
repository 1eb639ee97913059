"""The pictures with which a mesh file is painted: where they lie, and how much of them is taken.

A file of somebody else's may name any path, and a picture of a few bytes may unfold to gigabytes.
So only pictures in the mesh's own folder are opened, and only as large as is of use.
"""

from __future__ import annotations

import io
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path, PureWindowsPath
from typing import Any

import numpy as np
import numpy.typing as npt

from .data_files import Image
from .errors import AssetError
from .user_files import named, read_file
from .wavefront import ObjSurface, pictures_of

FORMATS = ("PNG", "JPEG")
MOST_BYTES = 100_000_000
MOST_PIXELS = 100_000_000
LARGEST = 4096  # [pixels] each way: larger ones are shrunk; every graphics card takes them
LONGEST_LIBRARY = 1_000_000  # [bytes]


@dataclass(frozen=True)
class Texture:
    """How the file itself paints its mesh.

    uv: texture coordinates, v up, shape (U, 2), float32. face_uv: their numbers for each corner,
        shape (F, 3), int32.
    picture: which of `pictures` each triangle has, -1 for none, shape (F,).
    pictures: each reads one, (H, W, 3), or raises AssetError.
    """

    uv: npt.NDArray[np.float32]
    face_uv: npt.NDArray[np.int32]
    picture: npt.NDArray[np.int64]
    pictures: tuple[Callable[[], Image], ...]


def texture_of(surface: ObjSurface, folder: Path) -> Texture | None:
    """What the material libraries beside an OBJ file paint it with; None where they paint nothing.

    One that is missing paints nothing; `libraries_missing` names it.
    """
    by_material: dict[str, str] = {}
    for name in surface.libraries:
        library = beside(folder, name)
        if library.exists():
            content = read_file(
                library, kind="material", most_bytes=LONGEST_LIBRARY, cure="keep materials alone"
            )
            by_material.update(pictures_of(content))
    names = sorted({by_material[each] for each in surface.materials if each in by_material})
    if not names or not len(surface.uv):
        return None
    if surface.face_uv.max(initial=-1) >= len(surface.uv):
        raise AssetError(f"a face has a vt beyond the last, {len(surface.uv)}; save it anew")
    numbers = [names.index(by_material[m]) if m in by_material else -1 for m in surface.materials]
    picture = np.array([*numbers, -1])[surface.material]
    picture[(surface.face_uv < 0).any(axis=1)] = -1
    return Texture(
        surface.uv.astype(np.float32),
        np.maximum(surface.face_uv, 0).astype(np.int32),
        picture,
        tuple(_reader(beside(folder, name)) for name in names),
    )


def libraries_missing(surface: ObjSurface, folder: Path) -> tuple[str, ...]:
    """A line for each material library that was never sent along, as with many files."""
    return tuple(
        f"its material library {named(name)} is missing: painted without what it names"
        for name in surface.libraries
        if not beside(folder, name).exists()
    )


def beside(folder: Path, name: str) -> Path:
    """The path of a file in a folder; AssetError for a name that leads out of it."""
    path = folder / PureWindowsPath(name).as_posix()
    is_inside = path.resolve().is_relative_to(folder.resolve())
    if not is_inside or PureWindowsPath(name).is_absolute():
        raise AssetError(f"names the file '{named(name)}'; it must lie in the mesh's folder")
    return path


def _reader(path: Path) -> Callable[[], Image]:
    def read() -> Image:
        """The picture in the file."""
        try:
            return read_picture(
                read_file(path, kind="picture", most_bytes=MOST_BYTES, cure="shrink it")
            )
        except AssetError as error:
            raise AssetError(f"its picture {named(path.name)}: {error}") from None

    return read


def read_picture(content: bytes) -> Image:
    """A PNG or JPEG picture, sRGB, shape (H, W, 3), shrunk to LARGEST."""
    import PIL.Image  # which to load a head takes no time for

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Pillow's own limit is near ours
            with PIL.Image.open(io.BytesIO(content), formats=FORMATS) as picture:
                return shrunk(picture)
    except AssetError:
        raise
    except Exception as error:  # every format of Pillow has its own kinds
        reason = " ".join(str(error).split())[:200]
        raise AssetError(f"is broken, or neither PNG nor JPEG ({reason}); save it anew") from None


def shrunk(picture: Any) -> Image:
    """A picture that Pillow has opened, sRGB, shape (H, W, 3), at most LARGEST each way."""
    if picture.width * picture.height > MOST_PIXELS:
        raise AssetError(
            f"has {picture.width} x {picture.height} pixels; allowed are {MOST_PIXELS}: shrink it"
        )
    picture.draft("RGB", (LARGEST, LARGEST))
    colours = picture.convert("RGB")
    colours.thumbnail((LARGEST, LARGEST))
    return np.asarray(colours)
