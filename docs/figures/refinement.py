"""Draw the figures of docs/refinement.md: `python docs/figures/refinement.py [FOLDER]`.

refine_cases      the 27 split configurations and their triangulations
refine_lookup     numbering of points, and one triangle looked up

Pillow draws the lines at three times the size; then the picture is reduced.
"""

from __future__ import annotations

from collections.abc import Sequence

import figures
import numpy as np
import numpy.typing as npt
import PIL.Image
from PIL import ImageDraw

from risorius.app.capture.captions import font
from risorius.app.pictures import Image
from risorius.geometry.arrays import Floats64
from risorius.geometry.sides import edges_of
from risorius.refine.kahler.table import POINT_COORDINATES, points_on, splits_of, subdivide

PAPER_COLOUR = (255, 255, 255)
INK_COLOUR = (32, 34, 40)
FILL_COLOUR = (236, 240, 245)
NEW_COLOUR = (0, 114, 178)
SECOND_COLOUR = (213, 94, 0)
Colour = tuple[int, int, int]
FigurePoint = npt.ArrayLike


class Diagram:
    """A white picture to draw on.

    Points are pixels of the finished picture, y upward.
    """

    SCALE = 3

    def __init__(self, width: int, height: int) -> None:
        self.size = (width, height)
        self._image = PIL.Image.new("RGB", (width * self.SCALE, height * self.SCALE), PAPER_COLOUR)
        self._draw = ImageDraw.Draw(self._image)

    def image(self) -> Image:
        """The finished picture, shape (height, width, 3)."""
        return np.asarray(self._image.resize(self.size, PIL.Image.Resampling.LANCZOS))

    def line(
        self, points: Sequence[FigurePoint], colour: Colour = INK_COLOUR, width: float = 1.2
    ) -> None:
        """A polyline; its width in pixels."""
        places = [self._place(point) for point in points]
        self._draw.line(places, fill=colour, width=round(width * self.SCALE), joint="curve")

    def polygon(self, points: Sequence[FigurePoint], fill: Colour) -> None:
        """A filled area."""
        self._draw.polygon([self._place(point) for point in points], fill=fill)

    def disc(self, point: FigurePoint, colour: Colour, radius: float = 3.0) -> None:
        """A round mark."""
        x, y = self._place(point)
        reach = radius * self.SCALE
        self._draw.ellipse((x - reach, y - reach, x + reach, y + reach), fill=colour)

    def text(
        self, point: FigurePoint, text: str, colour: Colour = INK_COLOUR, size: float = 12.0
    ) -> None:
        """Text around a point."""
        self._draw.text(self._place(point), text, colour, font(size * self.SCALE), "mm")

    def _place(self, point: FigurePoint) -> tuple[float, float]:
        x, y = np.asarray(point, dtype=np.float64)
        return float(x * self.SCALE), float((self.size[1] - y) * self.SCALE)


def equilateral(centre: FigurePoint, side: float) -> Floats64:
    """Corners 0, 1, 2 of an upright triangle, counter-clockwise from the lower left, (3, 2)."""
    height = side * np.sqrt(3.0) / 2.0
    lower_left = (-side / 2, -height / 2)
    lower_right = (side / 2, -height / 2)
    top = (0.0, height / 2)
    offsets = np.array([lower_left, lower_right, top])
    return np.asarray(np.asarray(centre, dtype=np.float64) + offsets)


def points_in(corners: Floats64) -> Floats64:
    """The 12 numbered points of a triangle with these corners, shape (12, 2)."""
    return np.asarray(POINT_COORDINATES @ corners / 4.0)


def apart(point: Floats64, centre: Floats64, distance: float) -> Floats64:
    """Move a point (2,) by a distance [pixels] away from a centre; below 0 toward it."""
    outward = point - centre
    return np.asarray(point + distance * outward / np.linalg.norm(outward))


def new_points(splits: tuple[int, int, int]) -> list[int]:
    """Numbers of the points on split edges."""
    middles = []
    quarters = []
    for edge, count in enumerate(splits):
        near_start, middle, near_end = points_on(edge)
        if count > 0:
            middles.append(middle)
        if count == 2:
            quarters += [near_start, near_end]
    return middles + quarters


def triangulation(diagram: Diagram, corners: Floats64, splits: tuple[int, int, int]) -> None:
    """Draw one subdivided triangle, with its new points marked by level."""
    points = points_in(corners)
    diagram.polygon(list(corners), FILL_COLOUR)
    for a, b in edges_of(np.array(subdivide(splits))):
        diagram.line([points[a], points[b]])
    for number in new_points(splits):
        is_middle = number % 3 == 0
        diagram.disc(points[number], NEW_COLOUR if is_middle else SECOND_COLOUR, 2.6)


def cases() -> Image:
    """All 27 configurations in the order of the table, three to a column."""
    cell = 96
    columns = 9
    diagram = Diagram(columns * cell, 3 * (cell + 14) + 8)
    for number in range(27):
        column = number % columns
        row = number // columns
        top = diagram.size[1] - 8 - row * (cell + 14)
        centre = ((column + 0.5) * cell, top - cell / 2)
        splits = splits_of(number)
        triangulation(diagram, equilateral(centre, 0.78 * cell), splits)
        title = f"{number}: {''.join(map(str, splits))}, {len(subdivide(splits))}"
        diagram.text((centre[0], centre[1] - 0.48 * cell), title, size=10.5)
    return diagram.image()


def lookup() -> Image:
    """The numbers of the 12 points, and the table look-up from splits to subtriangles."""
    diagram = Diagram(760, 250)
    corners = equilateral((140, 125), 200)
    points = points_in(corners)
    diagram.polygon(list(corners), FILL_COLOUR)
    diagram.line([*corners, corners[0]])
    centre = corners.mean(axis=0)
    for number, point in enumerate(points):
        if number < 3:
            colour = INK_COLOUR
        else:
            colour = NEW_COLOUR if number % 3 == 0 else SECOND_COLOUR
        diagram.disc(point, colour)
        diagram.text(apart(point, centre, 13), str(number), colour, 12)
    faint_grey = (150, 154, 162)
    for edge in range(3):
        middle = points[3 + 3 * edge]
        diagram.text(apart(middle, centre, -22), f"edge {edge}", faint_grey, 11)
    splits = (2, 0, 1)
    lines = [
        "splits of edges 0, 1, 2:  2, 0, 1",
        "2 + 3 · 0 + 9 · 1  =  entry 11",
        *(f"{a:3d} {b:3d} {c:3d}" for a, b, c in subdivide(splits)),
    ]
    for row, text in enumerate(lines):
        diagram.text((390, 215 - 26 * row - 14 * (row > 1)), text, size=13)
    right = equilateral((640, 125), 180)
    triangulation(diagram, right, splits)
    points = points_in(right)
    centre = right.mean(axis=0)
    for number in [0, 1, 2, *new_points(splits)]:
        diagram.text(apart(points[number], centre, 13), str(number), size=11)
    return diagram.image()


if __name__ == "__main__":
    figures.run(__doc__, {"refine_cases": cases, "refine_lookup": lookup})
