"""Reads the pictures of a mesh file, within safe limits.

A file of unknown origin may name any path, and a picture of a few bytes may decompress to
gigabytes. So only pictures in the mesh's own folder are opened, only up to a useful size, and only
those of drawn triangles.
"""

from __future__ import annotations

import io
import warnings
from collections.abc import Callable, Container, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from ..geometry.arrays import Floats32, Integers32, Integers64
from ..geometry.colour import to_linear, to_screen
from .data_files import Image
from .errors import AssetError
from .user_files import named, path_beside, read_file
from .wavefront import MaterialPicture, ObjSurface, pictures_of

LARGEST_SIDE = 4096  # [pixels] each way: larger ones are shrunk; every graphics card takes them
KTX2_MAGIC = b"\xabKTX 20\xbb\r\n\x1a\n"  # first bytes of a KTX 2 file


@dataclass(frozen=True)
class MeshPictures:
    """Pictures of a mesh, and texture coordinates.

    - uv: texture coordinates, v up, shape (U, 2), float32.
    - face_uv: row of `uv` at each corner of triangles, shape (F, 3), int32.
    - picture: index into `pictures` for each triangle, or -1, shape (F,).
    - pictures: functions each of which reads a picture, (H, W, 3), or raises AssetError.
    """

    uv: Floats32
    face_uv: Integers32
    picture: Integers64
    pictures: tuple[Callable[[], Image], ...]


def texture_of(surface: ObjSurface, folder: Path) -> tuple[MeshPictures | None, tuple[str, ...]]:
    """Return the texture of an OBJ file from its material libraries; None without a picture.

    It also returns a note for each missing library, because many files lack them.
    """
    by_material: dict[str, MaterialPicture] = {}
    missing = []
    for name in libraries_of(surface.libraries, folder):
        library = path_beside(folder, name)
        if library.exists():
            by_material.update(pictures_of(read_file(library, kind="material", most=1)))
        else:
            missing.append(
                f"its material library {named(name)} is missing: painted without its pictures"
            )
    of_materials = [_picture_of(each, by_material) for each in surface.materials]
    used = sorted({each for each in of_materials if each is not None})
    if not used or not len(surface.uv):
        return None, tuple(missing)
    if surface.face_uv.max(initial=-1) >= len(surface.uv):
        raise AssetError(
            f"a face names a vt above the last one, {len(surface.uv)}; save the mesh anew"
        )
    numbers = [-1 if each is None else used.index(each) for each in of_materials]
    picture = np.array([*numbers, -1])[surface.material]
    picture[(surface.face_uv < 0).any(axis=1)] = -1
    placings = sorted({each.placing for each in used})
    uv = np.vstack([placing.placed(surface.uv) for placing in placings])
    # Each placing has its own copy of the texture coordinates.
    copy_of_picture = np.array([placings.index(each.placing) for each in used])
    copies = copy_of_picture[np.maximum(picture, 0)]
    face_uv = np.maximum(surface.face_uv, 0) + len(surface.uv) * copies[:, None]
    texture = MeshPictures(
        uv.astype(np.float32),
        face_uv.astype(np.int32),
        picture,
        tuple(partial(_read_picture, folder, each.name) for each in used),
    )
    return texture, tuple(missing)


def _picture_of(
    material: str, by_material: Mapping[str, MaterialPicture]
) -> MaterialPicture | None:
    """The picture of a material."""
    return by_material.get(material_key(material, by_material))


def material_key(material: str, known: Container[str]) -> str:
    """The name of a known material; in some files a remark follows the name."""
    return material if material in known else material.rpartition(" #")[0].rstrip()


def libraries_of(lines: Sequence[str], folder: Path) -> list[str]:
    """The libraries of `mtllib` lines; a line has one name with blanks, or several names."""
    found = []
    for line in lines:
        names = line.partition(" #")[0].split()
        are_there = not path_beside(folder, line).exists() and any(
            path_beside(folder, name).exists() for name in names
        )
        found += names if are_there else [line]
    return found


def _read_picture(folder: Path, name: str) -> Image:
    path = path_beside(folder, name)
    try:
        most_megabytes = 100
        content = read_file(path, kind="picture", most=most_megabytes)
    except AssetError as error:
        raise AssetError(f"its picture {named(path.name)}: {error}") from None
    return decoded(content, path.name)


def decoded(content: bytes, name: str) -> Image:
    """The picture in a file's content, sRGB, shape (H, W, 3), at most LARGEST_SIDE each way.

    name: for messages. Raises AssetError for a broken or too large picture, or another format.
    """
    import PIL.Image  # imported late, so that loading a head is fast

    if content.startswith(KTX2_MAGIC):
        return _basis_picture(content, name)
    try:
        with warnings.catch_warnings():  # Pillow warns of pictures that decompress to gigabytes
            warnings.simplefilter("error", PIL.Image.DecompressionBombWarning)
            with PIL.Image.open(io.BytesIO(content), formats=("PNG", "JPEG", "WEBP")) as picture:
                return _shrunk_picture(picture)
    except Exception as error:  # the formats of Pillow raise different kinds of errors
        reason = " ".join(str(error).split())[:200]
        raise AssetError(
            f"its picture {named(name)}: is broken, too large, or neither PNG, JPEG nor WebP "
            f"({reason}); save it anew"
        ) from None


def _basis_picture(content: bytes, name: str) -> Image:
    """Return the picture in a KTX 2 file, as `decoded` does.

    The mip level is the largest that is at most LARGEST_SIDE each way.

    Source: Khronos Group, "KHR_texture_basisu" (rows run from the top).
    """
    try:
        decoder = import_module("opengl_basisu")
    except ModuleNotFoundError:
        raise AssetError(
            f"its picture {named(name)}: is compressed (KTX 2), which needs opengl_basisu; install "
            "it in the checkout: pip install '.[compression]', or save it as PNG"
        ) from None
    try:
        texture = decoder.open(content)
        sizes = [max(texture.level_size(level)) for level in range(texture.levels)]
        level = next(number for number, size in enumerate(sizes) if size <= LARGEST_SIDE)
        return np.array(texture.transcode("rgba8", level).data[..., :3])
    except StopIteration:
        raise AssetError(
            f"its picture {named(name)}: is wider or higher than {LARGEST_SIDE} pixels; "
            "save it smaller"
        ) from None
    except (decoder.BasisuError, MemoryError, ValueError) as error:
        reason = " ".join(str(error).split())[:200]
        raise AssetError(
            f"its picture {named(name)}: is broken, or no Basis Universal picture ({reason}); "
            "save it anew"
        ) from None


def tinted(picture: Image, factor: Sequence[float]) -> Image:
    """A picture, multiplied by a factor of linear light for red, green and blue."""
    shades = to_linear(np.arange(256) / 255.0)
    screen = to_screen(shades[:, None] * np.asarray(factor))
    table = np.rint(255.0 * screen).astype(np.uint8)
    channels = [table[picture[..., channel], channel] for channel in range(3)]
    return np.stack(channels, axis=-1)


def _shrunk_picture(picture: Any) -> Image:
    """Return an opened Pillow picture in the form of `decoded`."""
    import PIL.Image

    picture.draft("RGB", (LARGEST_SIDE, LARGEST_SIDE))
    if picture.mode.startswith("I"):  # grey of 16 bits: Pillow would clip it
        levels = np.asarray(picture).astype(np.uint32)
        picture = PIL.Image.fromarray(((levels + 128) // 257).astype(np.uint8))
    colours = picture.convert("RGB")
    colours.thumbnail((LARGEST_SIDE, LARGEST_SIDE))
    return np.asarray(colours)
