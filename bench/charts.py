"""Line charts through Pillow: drawn three times too large and scaled down, so that lines are fine.

For the few curves that this project shows a plotting library would be its largest dependency.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import PIL.Image
from PIL import ImageDraw

from risorius.app.capture.captions import font
from risorius.app.files import Image

SCALE = 3
PAPER, INK, GRID, FAINT = (255, 255, 255), (32, 34, 40), (226, 228, 232), (120, 124, 132)
# Okabe and Ito's colours: told apart by colour-blind readers too.
COLOURS = (
    (0, 114, 178),
    (213, 94, 0),
    (0, 158, 115),
    (204, 121, 167),
    (86, 180, 233),
    (230, 159, 0),
    (110, 114, 122),
    INK,
)
MARGINS = (0.11, 0.14, 0.22, 0.17)  # left, top, right, bottom, over the height


@dataclass(frozen=True)
class Series:
    """One curve; without `is_line` only its points are marked."""

    name: str
    points: Sequence[tuple[float, float]]
    is_line: bool = True


@dataclass(frozen=True)
class Axis:
    """Limits and labelled places of an axis."""

    title: str
    low: float
    high: float
    ticks: Sequence[float]
    is_logarithmic: bool = False

    def fraction(self, value: float) -> float:
        """Where a value lies between the limits, 0..1."""
        if self.is_logarithmic:
            return float(np.log(value / self.low) / np.log(self.high / self.low))
        return (value - self.low) / (self.high - self.low)


def chart(
    title: str, across: Axis, up: Axis, series: Sequence[Series], size: tuple[int, int]
) -> Image:
    """Draw curves over two axes, named at their right ends; shape (height, width, 3)."""
    width, height = size[0] * SCALE, size[1] * SCALE
    page = PIL.Image.new("RGB", (width, height), PAPER)
    draw = ImageDraw.Draw(page)
    left, top, right, bottom = (round(margin * height) for margin in MARGINS)
    right += round(0.06 * height)
    text = font(0.036 * height)

    def place(x: float, y: float) -> tuple[float, float]:
        return (
            left + across.fraction(x) * (width - left - right),
            height - bottom - up.fraction(y) * (height - top - bottom),
        )

    for tick in up.ticks:
        x, y = place(across.low, tick)
        draw.line([(x, y), (width - right, y)], fill=GRID, width=SCALE)
        draw.text((x - 4 * SCALE, y), f"{tick:g}", font=text, fill=FAINT, anchor="rm")
    for tick in across.ticks:
        x, y = place(tick, up.low)
        draw.line([(x, y), (x, y + 3 * SCALE)], fill=INK, width=SCALE)
        draw.text((x, y + 5 * SCALE), f"{tick:g}", font=text, fill=FAINT, anchor="mt")
    draw.line([place(across.low, up.low), place(across.high, up.low)], fill=INK, width=SCALE)
    middle = (left + (width - left - right) / 2, height - 5 * SCALE)
    draw.text(middle, across.title, font=text, fill=INK, anchor="mb")
    draw.text((left, 0.35 * top), title, font=font(0.04 * height), fill=INK, anchor="lm")
    draw.text((left, 0.35 * top + 0.05 * height), up.title, font=text, fill=FAINT, anchor="lm")
    names = []
    for number, one in enumerate(series):
        colour = COLOURS[number % len(COLOURS)]
        places = [place(x, y) for x, y in one.points]
        if one.is_line:
            draw.line(places, fill=colour, width=2 * SCALE, joint="curve")
        radius = (2.2 if one.is_line else 3.6) * SCALE
        for x, y in places:
            draw.ellipse([x - radius, y - radius, x + radius, y + radius], fill=colour)
        names.append((places[-1][1], one.name, colour))
    _name_curves(draw, names, width - right + 5 * SCALE, 0.047 * height, text)
    small = page.resize(size, PIL.Image.Resampling.LANCZOS)
    return np.asarray(small)


def _name_curves(
    draw: ImageDraw.ImageDraw,
    names: list[tuple[float, str, tuple[int, int, int]]],
    left: float,
    spacing: float,
    text: object,
) -> None:
    """Write names beside the right ends of their curves, pushed apart where they would touch."""
    names = sorted(names)
    heights = [height for height, _, _ in names]
    for _ in range(100):
        for k in range(len(heights) - 1):
            lack = spacing - (heights[k + 1] - heights[k])
            if lack > 0.0:
                heights[k] -= lack / 2.0
                heights[k + 1] += lack / 2.0
    for y, (_, name, colour) in zip(heights, names, strict=True):
        draw.text((left, y), name, font=text, fill=colour, anchor="lm")  # type: ignore[arg-type]
