"""Choose light and background of a sample; a background is a gradient, a picture or a light map."""

from __future__ import annotations

import colorsys
import contextlib
import hashlib
import os
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image
import PIL.ImageColor
import PIL.ImageOps

from risorius.geometry.arrays import Floats64
from risorius.render import LAMPS, LIGHT_MAPS, Background, Light, LightMap

from ..errors import UserError
from ..light_maps import LIGHT_SUFFIXES, check_light_map, read_light_map
from ..pictures import Image
from ..text import as_text


def _digest(paths: tuple[Path, ...]) -> str:
    """Return a digest of 16 hexadecimal digits of the names and sizes of files."""
    listed = "".join(f"{path.name} {path.stat().st_size}\n" for path in paths)
    return hashlib.sha256(os.fsencode(listed)).hexdigest()[:16]


@dataclass(frozen=True)
class Backgrounds:
    """The backgrounds of all samples; without colour and pictures they are random soft colours.

    colour: colour of all backgrounds, sRGB, 0 to 1. pictures: files from which pictures are chosen.
    """

    colour: tuple[float, float, float] | None = None
    pictures: tuple[Path, ...] = ()

    @property
    def options(self) -> Any:
        """The options that determine backgrounds, as JSON values."""
        if not self.pictures:
            return self.colour if self.colour is None else list(self.colour)
        return {"pictures": len(self.pictures), "content": _digest(self.pictures)}

    def colours(self, random: np.random.Generator) -> Background:
        """Return a gradient from a random colour near grey to a similar colour at the edge."""
        if self.colour is not None:
            return Background(self.colour, self.colour)
        hue, saturation, value = random.uniform([0.0, 0.0, 0.15], [1.0, 0.35, 0.95])
        change = random.uniform(0.7, 1.15)
        centre = colorsys.hsv_to_rgb(hue, saturation, value)
        edge = colorsys.hsv_to_rgb(hue, saturation, min(change * value, 1.0))
        return Background(centre, edge)

    def picture(self, random: np.random.Generator, size: tuple[int, int]) -> tuple[str, Image]:
        """Return the name of a random picture, and a random part of it, sRGB, (H, W, 3), uint8.

        size: width and height of this part [pixels]. A file that is not a picture raises UserError.
        """
        path = self.pictures[int(random.integers(len(self.pictures)))]
        # `fraction` is the visible part of the picture's limiting side, at least 0.6.
        fraction, across, along = random.uniform([0.6, 0.0, 0.0], 1.0)
        with _readable(path) as opened:
            whole = PIL.ImageOps.exif_transpose(opened).convert("RGB")
        scale = fraction * min(whole.width / size[0], whole.height / size[1])
        width = scale * size[0]
        height = scale * size[1]
        left = across * (whole.width - width)
        top = along * (whole.height - height)
        box = (left, top, left + width, top + height)
        part = whole.resize(size, PIL.Image.Resampling.LANCZOS, box)
        return as_text(path.name), np.asarray(part)


@dataclass(frozen=True)
class SampleLight:
    """The light of a sample, from a lamp or a light map.

    map: the light map; None for a lamp.
    turn: angle by which the map is turned [deg].
    exposure: factor on the map's radiance.
    """

    name: str
    light: Light
    map: LightMap | None = None
    turn: float = 0.0
    exposure: float = 1.0

    @property
    def labels(self) -> dict[str, Any]:
        """The labels of the light, as JSON values."""
        turned = {} if self.map is None else {"turn": self.turn}
        return {"name": self.name, **turned, **asdict(self.light)}


@dataclass(frozen=True)
class LightFiles:
    """The user's light maps, which replace the lights of the table, if there are any."""

    paths: tuple[Path, ...] = ()

    @property
    def options(self) -> Any:
        """The options that determine lights, as JSON values."""
        return _digest(self.paths) if self.paths else None


@lru_cache(256)  # maps of 0.8 MB
def _light_map(path: Path) -> LightMap:
    return read_light_map(path)


def light_of(name: str, files: LightFiles, random: np.random.Generator) -> SampleLight:
    """Choose a light, and vary its brightness, colour and direction at random.

    name: a light of the renderer; ignored if `files` has light maps.
    """
    if not files.paths and name in LAMPS:
        return SampleLight(name, _varied_lamp(name, random))
    light_map = None if files.paths else LIGHT_MAPS[name]
    if light_map is None:
        path = files.paths[int(random.integers(len(files.paths)))]
        name = as_text(path.name)
        light_map = _light_map(path)
        turn = round(float(random.uniform(-180.0, 180.0)), 2)
    else:  # smaller angles, because windows and lamps of built-in maps lie in front of the face
        turn = round(float(np.clip(25.0 * random.standard_normal(), -60.0, 60.0)), 2)
    light, exposure = light_map.exposed(turn)
    tint = _random_tint(random)
    changed: dict[str, Any] = {"key": _tinted(tint, light.key)}
    changed["around"] = tuple(_tinted(tint, row) for row in light.around)
    return SampleLight(name, replace(light, **changed), light_map, turn, exposure)


def _random_tint(random: np.random.Generator) -> Floats64:
    """Draw random factors on red, green and blue light."""
    # Red and blue light change in opposite directions, by a standard deviation of 0.08.
    warmth = 0.08 * np.clip(random.standard_normal(), -2.0, 2.0)
    return np.asarray(random.uniform(0.75, 1.15) * np.array([1.0 + warmth, 1.0, 1.0 - warmth]))


def _tinted(tint: Floats64, light: tuple[float, float, float]) -> tuple[float, ...]:
    return tuple((tint * light).tolist())


def _varied_lamp(name: str, random: np.random.Generator) -> Light:
    """Vary a lamp of the renderer: the direction of the key light, brightness and colour."""
    light = LAMPS[name]
    # The standard deviation along each axis is 18 degrees.
    to_key = np.array(light.to_key) + np.radians(18.0) * random.standard_normal(3)
    to_key[2] = max(to_key[2], 0.1)  # not behind the head
    tint = _random_tint(random)
    changed: dict[str, Any] = {
        each: _tinted(tint, getattr(light, each))
        for each in ("key", "fill", "rim", "sky", "ground")
    }
    return replace(light, to_key=tuple((to_key / np.linalg.norm(to_key)).tolist()), **changed)


def laid_over(picture: Image, premultiplied: Image) -> Image:
    """Blend a premultiplied picture (H, W, 4) over a picture (H, W, 3), as OpenGL does; uint8."""
    through = 1.0 - premultiplied[..., 3:] / 255.0
    blended: Image = (
        np.rint(premultiplied[..., :3] + through * picture).clip(0, 255).astype(np.uint8)
    )
    return blended


def light_files_of(path: Path | None) -> LightFiles:
    """Read the value of `--light`: a light map, a folder of them, or None.

    Raises UserError for any other value.
    """
    if path is None:
        return LightFiles()
    if not os.path.exists(path):
        raise UserError(f"--light {path}: no such file or folder")
    whole = path.absolute()
    paths: tuple[Path, ...] = (whole,)
    if whole.is_dir():
        files = (each for each in whole.iterdir() if each.is_file())
        paths = tuple(sorted(each for each in files if each.suffix.lower() in LIGHT_SUFFIXES))
        if not paths:
            raise UserError(
                f"--light {path}: the folder has no light map ({', '.join(LIGHT_SUFFIXES)})"
            )
        for each in paths:
            check_light_map(each)
    _light_map(paths[0])  # other maps are read later, because many would take minutes
    return LightFiles(paths)


def backgrounds_of(text: str | None) -> Backgrounds:
    """Read the value of `--background`: a colour, a folder of pictures, or None.

    Raises UserError for any other value.
    """
    if text is None:
        return Backgrounds()
    folder = Path(text)
    if folder.is_dir():
        suffixes = (".png", ".jpg", ".jpeg", ".webp")
        pictures = tuple(
            sorted(path for path in folder.iterdir() if path.suffix.lower() in suffixes)
        )
        if not pictures:
            raise UserError(
                f"--background {text}: the folder has no picture ({', '.join(suffixes)})"
            )
        for path in pictures:
            with _readable(path):  # reads only headers; whole pictures would take minutes
                pass
        return Backgrounds(pictures=pictures)
    try:
        red, green, blue = PIL.ImageColor.getrgb(text)[:3]
    except ValueError:
        raise UserError(
            f"--background {text}: neither a folder nor a colour, such as '#8090a0' or grey"
        ) from None
    return Backgrounds((red / 255.0, green / 255.0, blue / 255.0))


@contextlib.contextmanager
def _readable(path: Path) -> Iterator[PIL.Image.Image]:
    """Open a picture; an error while it is opened or used in this context raises UserError."""
    try:
        with PIL.Image.open(path) as opened:
            yield opened
    except (OSError, ValueError, PIL.Image.DecompressionBombError) as error:
        raise UserError(f"{path}: cannot be read as a picture: {error}") from None
