"""Lights by name, and the user's light maps: equirectangular Radiance HDR and OpenEXR files.

Source: Ward 1991, "Real pixels", Graphics Gems II, for the bytes of Radiance's files.
"""

from __future__ import annotations

import contextlib
import math
import re
from collections import Counter
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import PIL.Image

from risorius import render
from risorius.geometry.arrays import Floats32, Unsigned8

from .errors import UserError
from .extras import optional_import
from .files import read_bytes

LIGHT_SUFFIXES = (".hdr", ".exr")


class SceneLight(NamedTuple):
    """A light, and its map as a background; behind: None for a lamp."""

    light: render.Light
    behind: render.MapBackground | None


_readings = Counter[str]()  # by name: how often `open_light` has read a map


def scene_light(name: str) -> SceneLight:
    """Return the light of a name: one of `render.LIGHTS`, or the path of a light map.

    A file is read once. It is read again after `open_light`, or after many other maps were used.
    Raises UserError for an unusable file.
    """
    return _light_of(name, _readings[name])


def open_light(path: Path) -> str:
    """Read a light map, and return the name of its light; UserError for an unusable file."""
    name = str(path.absolute())
    reading = _readings[name] + 1
    _light_of(name, reading)
    _readings[name] = reading  # now, because an unusable file must not replace the former map
    return name


def is_light(name: str) -> bool:
    """Whether this can be the name of a light; the file of a map is not looked up."""
    return name in render.LIGHTS or Path(name).suffix.lower() in LIGHT_SUFFIXES


@lru_cache(maxsize=32)  # each map takes 0.8 MB
def _light_of(name: str, reading: int) -> SceneLight:
    """Make a light. `reading` counts how often its file was read, so the cache keeps no old map."""
    if name in render.LAMPS:
        return SceneLight(render.LAMPS[name], None)
    light_map = render.LIGHT_MAPS.get(name) or read_light_map(Path(name))
    light, exposure = light_map.exposed()
    return SceneLight(light, light_map.background(exposure=exposure))


def read_light_map(path: Path) -> render.LightMap:
    """Read a light map, reduced to (128, 256) texels; raise UserError for an unusable file."""
    check_light_map(path)
    with _errors_refused(path):
        pixels = _openexr(path) if _is_openexr(path) else _radiance(_content(path))
    pixels = np.nan_to_num(pixels, nan=0.0, posinf=0.0).clip(0.0, None)
    if not pixels.any():
        raise UserError(f"{path}: is black; nothing would be seen in its light")
    size = (256, 128)
    box = PIL.Image.Resampling.BOX
    small = [PIL.Image.fromarray(pixels[..., k]).resize(size, box) for k in range(3)]
    return render.LightMap(np.stack([np.asarray(each, np.float64) for each in small], axis=-1))


def check_light_map(path: Path) -> None:
    """Raise UserError unless a file is a light map, twice as wide as high.

    Only the header is read, so no memory is reserved for pixels.
    """
    if path.suffix.lower() not in LIGHT_SUFFIXES:
        raise UserError(f"{path}: is not a light map; give a file {' or '.join(LIGHT_SUFFIXES)}")
    header = _content(path, first=2**16)
    with _errors_refused(path):
        if _is_openexr(path):
            height, width = _openexr_size(path)
        else:
            height, width, _ = _radiance_size(header)
    longest = 32767  # [pixels] in a line of a Radiance file
    if not 0 < width <= longest or abs(width - 2 * height) > 0.02 * width:
        raise UserError(
            f"{path}: has {width} x {height} pixels; a light map "
            f"(equirectangular) is twice as wide as high, and at most {longest} pixels wide"
        )


def _is_openexr(path: Path) -> bool:
    return path.suffix.lower() == ".exr"


def _content(path: Path, first: int | None = None) -> bytes:
    """Return a file's bytes, or only its `first` bytes."""
    return read_bytes(path, what="light map", longest=2**28, first=first)


@contextlib.contextmanager
def _errors_refused(path: Path) -> Iterator[None]:
    """Turn the errors of a broken file into a UserError that names it."""
    try:
        yield
    except (ValueError, IndexError) as error:
        raise UserError(f"{path}: cannot be read as a light map: {error}") from None


def _radiance_size(content: bytes) -> tuple[int, int, int]:
    """Return height and width of a Radiance file [pixels], and the offset of its pixels [bytes].

    Raises ValueError if it is not a Radiance file.
    """
    head, _, _ = content.partition(b"\n\n")
    found = re.match(rb"-Y (\d{1,5}) \+X (\d{1,5})\n", content[len(head) + 2 :])
    if not content.startswith(b"#?") or b"xyze" in head or found is None:
        raise ValueError("it must be Radiance RGBE with lines from above, '-Y height +X width'")
    height, width = found.groups()
    return int(height), int(width), len(head) + 2 + found.end()


def _radiance(content: bytes) -> Floats32:
    """Read the pixels of a Radiance file, shape (H, W, 3); raise ValueError for another file."""
    height, width, begin = _radiance_size(content)
    data = np.frombuffer(content, np.uint8, offset=begin)
    if len(data) == 4 * height * width:
        rgbe = data.reshape(height, width, 4)
    else:
        rgbe = _unpacked_lines(data, height, width)
    scale = np.ldexp(np.float32(1.0), rgbe[..., 3:].astype(np.int32) - 136)
    return np.asarray(np.where(rgbe[..., 3:] > 0, rgbe[..., :3] * scale, 0.0), np.float32)


def _unpacked_lines(data: Unsigned8, height: int, width: int) -> Unsigned8:
    """Decode lines of four run-length encoded channels; shape (H, W, 4)."""
    most_alike = 127  # equal bytes in a run, which takes two bytes
    if len(data) < height * (4 + 8 * math.ceil(width / most_alike)):
        raise ValueError("it is shorter than its size requires")
    values = data.tobytes()
    lines = np.zeros((height, 4, width), np.uint8)
    at = 0
    for line in lines:
        if values[at : at + 4] != bytes([2, 2, width >> 8, width & 255]):
            raise ValueError("a line is packed in another way than by runs in each channel")
        at += 4
        for channel in line:
            column = 0
            while column < width:
                count = values[at]
                if count > 128:  # a run of one value
                    count -= 128
                    channel[column : column + count] = values[at + 1]
                    at += 2
                else:
                    channel[column : column + count] = data[at + 1 : at + 1 + count]
                    at += 1 + count
                column += count
                if not count or column > width:
                    raise ValueError("a line is longer than the picture is wide")
    return lines.transpose(0, 2, 1)


@contextlib.contextmanager
def _opened_openexr(path: Path, *, header_only: bool) -> Iterator[Any]:
    """Open an OpenEXR file; raise ValueError if it cannot be read, here or inside the block."""
    module = optional_import("OpenEXR", "a light of .exr", "passes")
    try:
        with module.File(str(path), separate_channels=True, header_only=header_only) as file:
            yield file
    except RuntimeError as error:
        raise ValueError(str(error)) from None


def _openexr_size(path: Path) -> tuple[int, int]:
    """Read height and width of an OpenEXR file [pixels]; raise ValueError without colours."""
    with _opened_openexr(path, header_only=True) as file:
        header = file.header()
        names = {channel.name for channel in header["channels"]}
        first, last = header["dataWindow"]
    if not names.issuperset("RGB"):
        raise ValueError("it has no channels R, G and B")
    width, height = (last - first + 1).tolist()
    return height, width


def _openexr(path: Path) -> Floats32:
    """Read the pixels of an OpenEXR file, shape (H, W, 3); raise ValueError if it is broken."""
    with _opened_openexr(path, header_only=False) as file:
        channels = file.channels()
        pixels = np.stack([channels[name].pixels for name in "RGB"], axis=-1)
    return pixels.astype(np.float32)
