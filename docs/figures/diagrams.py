"""Line drawings of triangles through Pillow: drawn three times too large and scaled down.

A `Diagram` has points in its own units, y upward; all else is pixels of the finished picture.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import PIL.Image
from PIL import ImageDraw

from risorius.app.capture.captions import font
from risorius.app.files import Image

SCALE = 3
PAPER, INK, FAINT = (255, 255, 255), (32, 34, 40), (150, 154, 162)
FILL, NEW = (236, 240, 245), (0, 114, 178)
SECOND, MOVED = (213, 94, 0), (0, 158, 115)
Colour = tuple[int, int, int]
Place = npt.ArrayLike


class Diagram:
    """A white picture to draw on."""

    def __init__(self, width: int, height: int) -> None:
        self.size = (width, height)
        self._image = PIL.Image.new("RGB", (width * SCALE, height * SCALE), PAPER)
        self._draw = ImageDraw.Draw(self._image)

    def image(self) -> Image:
        """The finished picture, shape (height, width, 3)."""
        return np.asarray(self._image.resize(self.size, PIL.Image.Resampling.LANCZOS))

    def line(
        self,
        points: Sequence[Place],
        colour: Colour = INK,
        width: float = 1.2,
        *,
        dashed: bool = False,
    ) -> None:
        """A polyline, or its first piece dashed."""
        places = [self._place(point) for point in points]
        if not dashed:
            self._draw.line(places, fill=colour, width=round(width * SCALE), joint="curve")
            return
        start, end = np.array(places[0]), np.array(places[1])
        count = max(1, round(float(np.linalg.norm(end - start)) / (4.0 * SCALE)))
        for k in range(0, count, 2):
            piece = [tuple(start + (end - start) * min(1.0, j / count)) for j in (k, k + 1)]
            self._draw.line(piece, fill=colour, width=round(width * SCALE))

    def polygon(self, points: Sequence[Place], fill: Colour) -> None:
        """A filled area."""
        self._draw.polygon([self._place(point) for point in points], fill=fill)

    def disc(
        self, point: Place, colour: Colour, radius: float = 3.0, *, hollow: bool = False
    ) -> None:
        """A round mark."""
        self._mark("ellipse", point, colour, radius, hollow)

    def square(
        self, point: Place, colour: Colour, radius: float = 3.2, *, hollow: bool = False
    ) -> None:
        """A square mark."""
        self._mark("rectangle", point, colour, radius, hollow)

    def text(
        self,
        point: Place,
        text: str,
        colour: Colour = INK,
        size: float = 12.0,
        anchor: str = "mm",
        offset: tuple[float, float] = (0.0, 0.0),
    ) -> None:
        """Text at a point, or beside it (Pillow's anchors)."""
        place = self._place(np.asarray(point, dtype=np.float64) + offset)
        self._draw.text(place, text, font=font(size * SCALE), fill=colour, anchor=anchor)

    def _mark(self, kind: str, point: Place, colour: Colour, radius: float, hollow: bool) -> None:
        x, y = self._place(point)
        reach = radius * SCALE
        fill = PAPER if hollow else colour
        getattr(self._draw, kind)(
            [x - reach, y - reach, x + reach, y + reach],
            fill=fill,
            outline=colour,
            width=round(1.2 * SCALE),
        )

    def _place(self, point: Place) -> tuple[float, float]:
        x, y = np.asarray(point, dtype=np.float64)
        return float(x * SCALE), float((self.size[1] - y) * SCALE)


def equilateral(centre: Place, side: float) -> npt.NDArray[np.float64]:
    """Corners 0, 1, 2 of an upright triangle, counter-clockwise from the lower left, (3, 2)."""
    height = side * np.sqrt(3.0) / 2.0
    offsets = np.array([[-side / 2, -height / 2], [side / 2, -height / 2], [0.0, height / 2]])
    return np.asarray(np.asarray(centre, dtype=np.float64) + offsets)
