"""The pictures with which a mesh file is painted: where they lie, and how much of them is taken.

A file of somebody else's may name any path, and a picture of a few bytes may unfold to gigabytes.
So only pictures in the mesh's own folder are opened, and only as large as is of use.
"""

from __future__ import annotations

import io
import warnings
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
MOST_MEGABYTES = 100
LARGEST = 4096  # [pixels] each way: larger ones are shrunk; every graphics card takes them


@dataclass(frozen=True)
class Texture:
    """How the file itself paints its mesh.

    uv: texture coordinates, v up, shape (U, 2), float32. face_uv: their numbers for each corner,
        shape (F, 3), int32.
    picture: which of `pictures` each triangle has, -1 for none, shape (F,).
    pictures: shape (H, W, 3) each.
    """

    uv: npt.NDArray[np.float32]
    face_uv: npt.NDArray[np.int32]
    picture: npt.NDArray[np.int64]
    pictures: tuple[Image, ...]


def texture_of(surface: ObjSurface, folder: Path) -> tuple[Texture | None, tuple[str, ...]]:
    """What the material libraries beside an OBJ file paint it with; None where they paint nothing.

    Beside it a line for each library that was never sent along, as with many files.
    """
    by_material: dict[str, str] = {}
    missing = []
    for name in surface.libraries:
        library = beside(folder, name)
        if library.exists():
            by_material.update(pictures_of(read_file(library, kind="material", most=1)))
        else:
            missing.append(
                f"its material library {named(name)} is missing: painted without what it names"
            )
    names = sorted({by_material[each] for each in surface.materials if each in by_material})
    if not names or not len(surface.uv):
        return None, tuple(missing)
    if surface.face_uv.max(initial=-1) >= len(surface.uv):
        raise AssetError(f"a face has a vt beyond the last, {len(surface.uv)}; save it anew")
    numbers = [names.index(by_material[m]) if m in by_material else -1 for m in surface.materials]
    picture = np.array([*numbers, -1])[surface.material]
    picture[(surface.face_uv < 0).any(axis=1)] = -1
    texture = Texture(
        surface.uv.astype(np.float32),
        np.maximum(surface.face_uv, 0).astype(np.int32),
        picture,
        tuple(_read_picture(beside(folder, name)) for name in names),
    )
    return texture, tuple(missing)


def beside(folder: Path, name: str) -> Path:
    """The path of a file in a folder; AssetError for a name that leads out of it."""
    path = folder / PureWindowsPath(name).as_posix()
    is_inside = path.resolve().is_relative_to(folder.resolve())
    if not is_inside or PureWindowsPath(name).is_absolute():
        raise AssetError(f"names the file '{named(name)}'; it must lie in the mesh's folder")
    return path


def _read_picture(path: Path) -> Image:
    import PIL.Image  # which to load a head takes no time for

    try:
        content = read_file(path, kind="picture", most=MOST_MEGABYTES)
        with warnings.catch_warnings():  # of what unfolds to gigabytes
            warnings.simplefilter("error", PIL.Image.DecompressionBombWarning)
            with PIL.Image.open(io.BytesIO(content), formats=FORMATS) as picture:
                return shrunk(picture)
    except AssetError as error:
        raise AssetError(f"its picture {named(path.name)}: {error}") from None
    except Exception as error:  # every format of Pillow has its own kinds
        reason = " ".join(str(error).split())[:200]
        raise AssetError(
            f"its picture {named(path.name)}: is broken, too large, or neither PNG nor JPEG "
            f"({reason}); save it anew"
        ) from None


def shrunk(picture: Any) -> Image:
    """A picture that Pillow has opened, sRGB, shape (H, W, 3), at most LARGEST each way."""
    picture.draft("RGB", (LARGEST, LARGEST))
    colours = picture.convert("RGB")
    colours.thumbnail((LARGEST, LARGEST))
    return np.asarray(colours)
