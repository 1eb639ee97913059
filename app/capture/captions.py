"""Text on pictures, through Pillow: the captions of a comparison, and contact sheets."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence

import numpy as np
import PIL.Image
from PIL import ImageDraw, ImageFont

from ..files import Image
from ..pipeline import Viewport

INK = (245, 245, 245)
SHADE = (24, 26, 30)
LEAST_CAPTION = 28  # [pixels] below a cell of a contact sheet: text of 15 pixels stays readable
LANCZOS = PIL.Image.Resampling.LANCZOS


@functools.cache
def font(size: float) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    """Pillow's own typeface at a size [pixels]; read once, for that takes longer than writing."""
    return ImageFont.load_default(size=size)


def captioned(image: Image, texts: Sequence[str], viewports: Sequence[Viewport]) -> Image:
    """Write one line at the lower left of each viewport and draw a line between viewports.

    image: with 3 channels, or 4 and premultiplied.
    """
    page = PIL.Image.fromarray(image)
    draw = ImageDraw.Draw(page)
    height = image.shape[0]
    size = max(11.0, height / 36.0)
    for text, (left, bottom, _, _) in zip(texts, viewports, strict=True):
        place = (left + size, height - bottom - 2.1 * size)
        draw.text((place[0] + 1, place[1] + 1), text, font=font(size), fill=SHADE)
        draw.text(place, text, font=font(size), fill=INK)
        if left:
            draw.line([(left, 0), (left, height)], fill=INK, width=1)
    return np.asarray(page)


def contact_sheet(
    poses: Sequence[tuple[str, Image]], *, columns: int, cell_width: int = 640
) -> Image:
    """Lay named pictures out in a grid, each with its name below it."""
    rows = math.ceil(len(poses) / columns)
    first = poses[0][1]
    cell_height = round(cell_width * first.shape[0] / first.shape[1])
    caption_height = max(LEAST_CAPTION, cell_width // 16)
    sheet = PIL.Image.new(
        "RGB", (columns * cell_width, rows * (cell_height + caption_height)), SHADE
    )
    draw = ImageDraw.Draw(sheet)
    for index, (name, image) in enumerate(poses):
        left = index % columns * cell_width
        top = index // columns * (cell_height + caption_height)
        small = PIL.Image.fromarray(image).resize((cell_width, cell_height), LANCZOS)
        sheet.paste(small, (left, top), small if small.mode == "RGBA" else None)
        middle = (left + cell_width / 2, top + cell_height + caption_height / 2)
        draw.text(middle, name, font=font(caption_height * 0.55), fill=INK, anchor="mm")
    return np.asarray(sheet)
