"""The paint of primitives in a glTF file: pictures and their layout, tints, vertex colours.

Source: Khronos Group, "glTF 2.0 Specification", sections 3.8 and 3.9; KHR_texture_transform,
KHR_materials_pbrSpecularGlossiness, EXT_texture_webp, KHR_texture_basisu.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np

from ..geometry.arrays import Floats64, Unsigned8
from ..geometry.colour import to_screen
from .data_files import Image
from .errors import AssetError
from .gltf_file import GltfFile, entry, fractions
from .pictures import decoded, tinted

WHITE_TINT = (1.0, 1.0, 1.0)


class GltfPainter:
    """Finds the paint of primitives. `pictures` collects unread pictures by image and tint."""

    UNREAD = ("EXT_texture_avif", "MSFT_texture_dds")  # formats of pictures

    def __init__(self, file: GltfFile) -> None:
        self.pictures: dict[tuple[int, tuple[float, ...]], Callable[[], Image]] = {}
        self._file = file
        self._document = file.document

    def painted(self, primitive: Any, count: int) -> tuple[int, Floats64, tuple[float, ...]]:
        """Number of a primitive's picture, texture coordinates (V, 2), and its material's tint."""
        attributes = vars(primitive.attributes)
        nowhere = np.zeros((count, 2))
        if primitive.material is None:
            return -1, nowhere, WHITE_TINT
        info, factor = _base_colour(self._document.materials[primitive.material])
        if info is None:
            return -1, nowhere, factor
        placing = (entry(info, "extensions") or {}).get("KHR_texture_transform", {})
        channel = placing.get("texCoord", entry(info, "texCoord") or 0)
        coordinates = attributes.get(f"TEXCOORD_{channel}")
        if coordinates is None:
            return -1, nowhere, factor
        texture = self._document.textures[entry(info, "index")]
        uv = _transformed_uv(self._file.values(coordinates).astype(np.float64), placing)
        if texture.sampler is not None:
            sampler = self._document.samplers[texture.sampler]
            for axis, way in enumerate((sampler.wrapS, sampler.wrapT)):
                uv[:, axis] = _within_picture(uv[:, axis], way)
        key = (self._image(texture), factor)
        self.pictures.setdefault(key, partial(self._picture, *key))
        return [*self.pictures].index(key), uv * [1.0, -1.0] + [0.0, 1.0], factor

    def _image(self, texture: Any) -> int:
        """The number of a texture's image, below 0 for a format that is not read."""
        if texture.source is not None:
            return int(texture.source)
        extensions = texture.extensions or {}
        for name in ("EXT_texture_webp", "KHR_texture_basisu"):
            if name in extensions:
                return int(extensions[name]["source"])
        found = [place for place, name in enumerate(self.UNREAD) if name in extensions]
        return -1 - found[0] if found else -1 - len(self.UNREAD)

    def _picture(self, number: int, factor: tuple[float, ...]) -> Image:
        """Read an image when it is drawn; raises AssetError if it is unreadable."""
        if number < 0:
            name = [*self.UNREAD, "no source"][-1 - number]
            raise AssetError(f"its picture is of a kind that is not read ({name}); save it as PNG")
        try:
            content, title = self._file.picture(number)
        except (LookupError, TypeError, ValueError) as error:
            raise AssetError(
                f"its picture {number} is not in it ({error}); export it anew"
            ) from None
        picture = decoded(content, title)
        return picture if factor == WHITE_TINT else tinted(picture, factor)

    def colours(self, attributes: Mapping[str, Any], factor: tuple[float, ...]) -> Unsigned8 | None:
        """The colours of vertices as sRGB, shape (V, 3); the file has linear light."""
        if attributes.get("COLOR_0") is None:
            return None
        light = self._file.values(attributes["COLOR_0"])[:, :3]
        if light.dtype.kind != "f":  # integers are always fractions, even if the file denies it
            light = fractions(light)
        screen = np.rint(255.0 * to_screen(np.nan_to_num(light) * factor))
        return screen.astype(np.uint8)


def _base_colour(material: Any) -> tuple[Any, tuple[float, ...]]:
    """The texture entry of a material, or None, and its tint in linear light."""
    specular = "KHR_materials_pbrSpecularGlossiness"
    older = (material.extensions or {}).get(specular)
    if older is not None:
        info = older.get("diffuseTexture")
        factor = older.get("diffuseFactor")
    else:
        metallic = material.pbrMetallicRoughness
        info = entry(metallic, "baseColorTexture")
        factor = entry(metallic, "baseColorFactor")
    tint = tuple(float(each) for each in (factor or WHITE_TINT)[:3])
    is_there = info is not None and entry(info, "index") is not None
    return (info if is_there else None), tint


def _transformed_uv(uv: Floats64, placing: Mapping[str, Any]) -> Floats64:
    """Texture coordinates, v down, moved by KHR_texture_transform.

    They are scaled, then turned counter-clockwise as seen with v down, then shifted.
    """
    scaled = uv[:, :2] * placing.get("scale", (1.0, 1.0))
    angle = float(placing.get("rotation", 0.0))
    cosine = np.cos(angle)
    sine = np.sin(angle)
    turn = np.array([[cosine, sine], [-sine, cosine]])
    return np.asarray(scaled @ turn.T + placing.get("offset", (0.0, 0.0)))


def _within_picture(values: Floats64, way: int | None) -> Floats64:
    """Wrap coordinates along one axis of a picture; way: glTF's number of a wrapping mode."""
    clamped = 33071  # glTF's numbers of wrapping modes
    if way == clamped:
        return values.clip(0.0, 1.0)
    mirrored = 33648
    if way == mirrored:
        return np.asarray(1.0 - abs(np.mod(values, 2.0) - 1.0))
    return values
