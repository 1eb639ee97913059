"""What is behind the face of a sample: soft colours, one colour, or a part of a picture."""

from __future__ import annotations

import colorsys
import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image
import PIL.ImageColor
import PIL.ImageOps

from risorius.render import Background

from ..errors import UserError
from ..files import Image

SUFFIXES = (".png", ".jpg", ".jpeg", ".webp")
SMALLEST = 0.6  # share of a picture's shorter side that is seen, at least


@dataclass(frozen=True)
class Backgrounds:
    """Colours (sRGB 0..1) of all samples, or pictures to choose from, or neither: soft colours."""

    colour: tuple[float, float, float] | None = None
    pictures: tuple[Path, ...] = ()

    @property
    def options(self) -> Any:
        """What decides them, for JSON."""
        if not self.pictures:
            return self.colour if self.colour is None else list(self.colour)
        return {"pictures": len(self.pictures), "content": digest(self.pictures)}

    def colours(self, random: np.random.Generator) -> Background:
        """The colours of one sample: not far from grey, the edge a little darker or lighter."""
        if self.colour is not None:
            return Background(self.colour, self.colour)
        hue, saturation, value = random.uniform([0.0, 0.0, 0.15], [1.0, 0.35, 0.95])
        change = random.uniform(0.7, 1.15)
        centre = colorsys.hsv_to_rgb(hue, saturation, value)
        return Background(centre, colorsys.hsv_to_rgb(hue, saturation, min(change * value, 1.0)))

    def picture(self, random: np.random.Generator, size: tuple[int, int]) -> tuple[str, Image]:
        """The name of one picture, and a part of it of `size`, sRGB, shape (H, W, 3).

        Raises UserError for a file that is no picture.
        """
        path = self.pictures[int(random.integers(len(self.pictures)))]
        share, across, along = random.uniform([SMALLEST, 0.0, 0.0], 1.0)
        try:
            with PIL.Image.open(path) as opened:
                whole = PIL.ImageOps.exif_transpose(opened).convert("RGB")
        except (OSError, ValueError, PIL.Image.DecompressionBombError) as error:
            raise UserError(f"{path}: cannot be read as a picture: {error}") from None
        scale = share * min(whole.width / size[0], whole.height / size[1])
        width, height = scale * size[0], scale * size[1]
        left, top = across * (whole.width - width), along * (whole.height - height)
        part = whole.resize(
            size, PIL.Image.Resampling.LANCZOS, (left, top, left + width, top + height)
        )
        return path.name, np.asarray(part)


def backgrounds_of(text: str | None) -> Backgrounds:
    """What `--background` says: a colour, a folder of pictures, or nothing; UserError else."""
    if text is None:
        return Backgrounds()
    folder = Path(text)
    if folder.is_dir():
        pictures = files_in(folder, SUFFIXES)
        if not pictures:
            raise UserError(f"--background {text}: no picture in it, {', '.join(SUFFIXES)}")
        return Backgrounds(pictures=pictures)
    try:
        red, green, blue = PIL.ImageColor.getrgb(text)[:3]
    except ValueError:
        raise UserError(
            f"--background {text}: neither a folder nor a colour, as in '#8090a0' or grey"
        ) from None
    return Backgrounds((red / 255.0, green / 255.0, blue / 255.0))


def files_in(folder: Path, suffixes: Sequence[str]) -> tuple[Path, ...]:
    """The files of a folder that end so, by name."""
    return tuple(sorted(path for path in folder.iterdir() if path.suffix.lower() in suffixes))


def digest(paths: Sequence[Path]) -> str:
    """Tells files from others, by their names and sizes."""
    told = "".join(f"{path.name} {path.stat().st_size}\n" for path in paths)
    return hashlib.sha256(told.encode()).hexdigest()[:16]
