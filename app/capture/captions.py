"""Text on pictures, through Pillow: the captions of a comparison, and contact sheets."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence

import numpy as np
import PIL.Image
from PIL import ImageDraw, ImageFont

from risorius import render

from ..pictures import Image

INK_COLOUR = (245, 245, 245)
FAINT_INK_COLOUR = (200, 203, 208)
SHADE_COLOUR = (24, 26, 30)
LEAST_CAPTION = 28  # [pixels] below a cell of a contact sheet, for readable text of 15 pixels
LANCZOS = PIL.Image.Resampling.LANCZOS


@functools.cache
def font(size: float) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    """Return Pillow's built-in typeface at a size [pixels]; the cache avoids slow loading."""
    return ImageFont.load_default(size=size)


# A small picture to draw on a frame: x, y of its lower left corner [pixels]; premultiplied RGBA.
Label = tuple[int, int, Image]


@functools.lru_cache(maxsize=64)
def plate(text: str, size: float) -> Image:
    """Draw a line of text, and a smaller second line, on a dark plate; premultiplied RGBA."""
    lines = [
        *zip(
            text.split("\n"),
            (font(size), font(0.82 * size)),
            (INK_COLOUR, FAINT_INK_COLOUR),
            strict=False,
        )
    ]
    width = max(face.getlength(line) for line, face, _ in lines)
    page, draw = _dark_plate(width + 1.3 * size, (1.25 * len(lines) + 0.55) * size, size)
    for index, (line, face, ink) in enumerate(lines):
        y = (0.95 + 1.22 * index) * size
        draw.text((0.65 * size, y), line, font=face, fill=ink, anchor="lm")
    return np.asarray(page.convert("RGBa"))


@functools.lru_cache(maxsize=8)
def colour_bar(size: float) -> Image:
    """Draw the legend of split colours: an upright bar with numbers and a title, on a plate."""
    small = font(0.82 * size)
    count = len(render.SPLIT_PALETTE)
    pad = round(0.65 * size)
    tall = round(13.0 * size)
    wide = round(0.8 * size)
    numbers = round(3.1 * size)
    page, draw = _dark_plate(numbers + small.getlength(f"{count}") + pad, tall + 2 * pad, size)
    step = tall / count
    left = round(1.85 * size)
    for index, shade in enumerate(render.SPLIT_PALETTE):
        low = pad + tall - step * index
        ink = tuple(round(255.0 * part) for part in shade)
        draw.rectangle((left, round(low - step), left + wide - 1, round(low) - 1), fill=ink)
        draw.text(
            (numbers, low - 0.5 * step), f"{index + 1}", font=small, fill=INK_COLOUR, anchor="lm"
        )
    title = PIL.Image.new("RGBA", (tall, wide + pad))
    middle = (0.5 * tall, 0.65 * size)
    ImageDraw.Draw(title).text(
        middle, "Splits of a triangle's edges", font=small, fill=FAINT_INK_COLOUR, anchor="mm"
    )
    page.alpha_composite(title.rotate(90, expand=True), (round(0.45 * size), pad))
    return np.asarray(page.convert("RGBa"))


def _dark_plate(
    width: float, height: float, size: float
) -> tuple[PIL.Image.Image, ImageDraw.ImageDraw]:
    """Return a dark plate with round corners, and an object that draws on it."""
    page = PIL.Image.new("RGBA", (math.ceil(width), math.ceil(height)), (*SHADE_COLOUR, 0))
    draw = ImageDraw.Draw(page)
    corners = (0, 0, page.width - 1, page.height - 1)
    # An opacity of 185 in 255 hides most of the picture behind a text.
    draw.rounded_rectangle(corners, 0.35 * size, fill=(*SHADE_COLOUR, 185))
    return page, draw


def labels(
    texts: Sequence[str],
    viewports: Sequence[render.Rectangle],
    *,
    has_bar: bool,
    least: float = 11.0,
) -> list[Label]:
    """Return captions at the foot of viewports, and the colour bar at the upper right.

    A caption stands at the left of its viewport. The second of two captions stands at the right,
    away from the dividing line and the face. A caption without enough room is left out.

    least: smallest size of letters [pixels]; the size grows with the height of the picture.
    """
    size = max(least, viewports[0][3] / 36.0)
    pad = round(0.7 * size)
    made = list[Label]()
    for index, (text, (left, bottom, width, _)) in enumerate(zip(texts, viewports, strict=False)):
        image = plate(text, size)
        room = width - image.shape[1] - 2 * pad
        aside = room if (index, len(texts)) == (1, 2) else 0
        made += [(left + pad + aside, bottom + pad, image)] if room >= 0 else []
    if has_bar and viewports[-1][3] >= 64:  # its numbers need this height
        left, bottom, width, height = viewports[-1]
        image = colour_bar(min(0.78 * size, height / 26.0))
        x = width - image.shape[1] - pad
        y = height - image.shape[0] - pad
        made += [(left + x, bottom + y, image)] if min(x, y) >= 0 else []
    return made


def captioned(image: Image, shown: Sequence[Label], lefts: Sequence[int]) -> Image:
    """Draw labels on a copy of a picture, and a line between viewports.

    image: with 3 channels, or 4 and premultiplied. lefts: left ends of viewports [pixels].
    """
    page = image.copy()
    for left in filter(None, lefts):
        page[:, left] = (*INK_COLOUR, 255)[: page.shape[2]]
    for x, y, label in shown:
        under = page[len(page) - y - len(label) : len(page) - y, x : x + label.shape[1]]
        kept = under * (255 - label[..., 3:].astype(np.uint16))
        under[:] = label[..., : page.shape[2]] + (kept + 127) // 255
    return page


def contact_sheet(
    poses: Sequence[tuple[str, Image]], *, columns: int, cell_width: int = 640
) -> Image:
    """Arrange named pictures in a grid, each with its name below it."""
    rows = math.ceil(len(poses) / columns)
    first = poses[0][1]
    cell_height = round(cell_width * first.shape[0] / first.shape[1])
    caption_height = max(LEAST_CAPTION, cell_width // 16)
    sheet = PIL.Image.new(
        "RGB", (columns * cell_width, rows * (cell_height + caption_height)), SHADE_COLOUR
    )
    draw = ImageDraw.Draw(sheet)
    for index, (name, image) in enumerate(poses):
        left = index % columns * cell_width
        top = index // columns * (cell_height + caption_height)
        small = PIL.Image.fromarray(image).resize((cell_width, cell_height), LANCZOS)
        sheet.paste(small, (left, top), small if small.mode == "RGBA" else None)
        middle = (left + cell_width / 2, top + cell_height + caption_height / 2)
        draw.text(middle, name, font=font(caption_height * 0.55), fill=INK_COLOUR, anchor="mm")
    return np.asarray(sheet)
