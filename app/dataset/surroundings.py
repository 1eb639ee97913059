"""The surroundings of a sample's face: light, and behind it colours or a part of a picture."""

from __future__ import annotations

import colorsys
import contextlib
import hashlib
import os
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image
import PIL.ImageColor
import PIL.ImageOps

from risorius.render import LIGHTS, Background, Light

from ..errors import UserError
from ..pictures import Image
from ..text import as_text


@dataclass(frozen=True)
class Backgrounds:
    """Colours (sRGB 0..1) of all samples, or pictures to choose from, or neither: soft colours."""

    colour: tuple[float, float, float] | None = None
    pictures: tuple[Path, ...] = ()

    @property
    def options(self) -> Any:
        """All that decides them, for JSON."""
        if not self.pictures:
            return self.colour if self.colour is None else list(self.colour)
        listed = "".join(f"{path.name} {path.stat().st_size}\n" for path in self.pictures)
        content = hashlib.sha256(os.fsencode(listed)).hexdigest()[:16]  # other files, other digest
        return {"pictures": len(self.pictures), "content": content}

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
        # At least this share of a picture's shorter side is seen.
        share, across, along = random.uniform([0.6, 0.0, 0.0], 1.0)
        with _readable(path) as opened:
            whole = PIL.ImageOps.exif_transpose(opened).convert("RGB")
        scale = share * min(whole.width / size[0], whole.height / size[1])
        width = scale * size[0]
        height = scale * size[1]
        left = across * (whole.width - width)
        top = along * (whole.height - height)
        part = whole.resize(
            size, PIL.Image.Resampling.LANCZOS, (left, top, left + width, top + height)
        )
        return as_text(path.name), np.asarray(part)


def light_of(name: str, random: np.random.Generator) -> Light:
    """One of the renderer's lights: its key moved, all brighter or darker, warmer or cooler."""
    light = LIGHTS[name]
    # The key light is moved, with this standard deviation [degrees].
    to_key = np.array(light.to_key) + np.radians(18.0) * random.standard_normal(3)
    to_key[2] = max(to_key[2], 0.1)  # not behind the head
    # Of red over blue light, with this standard deviation.
    warmth = 0.08 * np.clip(random.standard_normal(), -2.0, 2.0)
    tint = random.uniform(0.75, 1.15) * np.array([1.0 + warmth, 1.0, 1.0 - warmth])
    changed: dict[str, Any] = {
        each: tuple((tint * getattr(light, each)).tolist())
        for each in ("key", "fill", "rim", "sky", "ground")
    }
    return replace(light, to_key=tuple((to_key / np.linalg.norm(to_key)).tolist()), **changed)


def laid_over(picture: Image, premultiplied: Image) -> Image:
    """A picture (H, W, 3) behind another with alpha (H, W, 4), as OpenGL would blend them."""
    through = 1.0 - premultiplied[..., 3:] / 255.0
    blended: Image = (
        np.rint(premultiplied[..., :3] + through * picture).clip(0, 255).astype(np.uint8)
    )
    return blended


def backgrounds_of(text: str | None) -> Backgrounds:
    """The value of `--background`: a colour, a folder of pictures, or None; UserError else."""
    if text is None:
        return Backgrounds()
    folder = Path(text)
    if folder.is_dir():
        suffixes = (".png", ".jpg", ".jpeg", ".webp")
        pictures = tuple(sorted(p for p in folder.iterdir() if p.suffix.lower() in suffixes))
        if not pictures:
            raise UserError(f"--background {text}: no picture in it, {', '.join(suffixes)}")
        for path in pictures:
            with _readable(path):  # its header: of thousands the whole would take minutes
                pass
        return Backgrounds(pictures=pictures)
    try:
        red, green, blue = PIL.ImageColor.getrgb(text)[:3]
    except ValueError:
        raise UserError(
            f"--background {text}: neither a folder nor a colour, as in '#8090a0' or grey"
        ) from None
    return Backgrounds((red / 255.0, green / 255.0, blue / 255.0))


@contextlib.contextmanager
def _readable(path: Path) -> Iterator[PIL.Image.Image]:
    """An opened picture; UserError where it is none, or proves broken in the block."""
    try:
        with PIL.Image.open(path) as opened:
            yield opened
    except (OSError, ValueError, PIL.Image.DecompressionBombError) as error:
        raise UserError(f"{path}: cannot be read as a picture: {error}") from None
