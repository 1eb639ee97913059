"""The paper's Fig. 10: the region of the mouth, static and refined, beside a dense mesh.

Kähler, Haber, Seidel 2003, section 5: "The rendered mesh is visibly smoothed, reducing shading
artifacts and improving the silhouette of the opened mouth." What is smooth need not be true; so the
built-in head with 16 times the triangles is moved by the same muscles, drawn alike and taken for
the truth. For every expression a block of four rows:

    smooth       Gouraud shaded, as in the paper
    flat         one colour for each triangle
    difference   of the smooth picture from that of the dense mesh, many times as strong
    outline      of the opening between the lips, from nearer, with that of the dense mesh on it
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import PIL.Image
from PIL import ImageDraw

from risorius import refine, render
from risorius.app.capture.captions import LANCZOS, font
from risorius.app.files import Image

from ..canvas import Canvas, without_noise
from .mouths import MOUTH, Mouths, Variant, wrong_pixels

VARIANTS = (
    Variant("static", "none"),
    Variant("refined: paper", "kahler"),
    Variant("refined: cubic", "kahler", {"scheme": "cubic", "criterion": "displacement+border"}),
    Variant(
        "refined: detail",
        "kahler",
        {"scheme": "detail", "criterion": "displacement+border"},
        wants_detail=True,
    ),
)
"""One column each, and the dense mesh after them."""


@dataclass(frozen=True)
class Shot:
    """A block of rows: an expression, and where it is looked at from."""

    expression: str
    view: str  # yaw, pitch [degrees], zoom, around the lips
    aside: tuple[float, float]  # the camera is moved right and up, in heights of the frame
    near: str  # as `view`, for the outline
    landmark: int  # in the middle of the outline: 62 and 66 are the middles of the inner lips


SHOTS = (
    Shot("yawn", "-24,-4,5.2", (-0.1, 0.0), "-24,-4,36", 66),
    Shot("joy", "-30,0,5.2", (-0.1, 0.05), "0,-10,36", 62),
)

SMOOTH = render.Style(
    shading=render.Shading.GOURAUD, textured=False, albedo=render.SKIN, shadows=False,
    background=render.WHITE,
)  # fmt: skip
FLAT = replace(SMOOTH, shading=render.Shading.FLAT)

FINER = 2  # pixels are drawn so many times as fine
ROWS = ("smooth", "flat", "difference", "outline")
SHADES = 24  # of differences; more would only make the file larger
FULL_DIFFERENCE = 48.0  # levels of 255 that are black in pictures of differences
RAMP = np.array([[255, 255, 255], [250, 190, 90], [205, 50, 40], [50, 0, 30]], float)
PAPER, INK, GREY = (255, 255, 255), (25, 28, 33), (110, 114, 120)
LIPS, OPENING, WRONG = (233, 222, 214), (52, 40, 42), (225, 30, 30)


@dataclass(frozen=True)
class Cell:
    """What one variant makes of one expression: four pictures, and how far they are from truth."""

    title: str
    triangles: int
    smooth: Image
    flat: Image
    kinds: Image  # SKIN, MOUTH, BACKGROUND in the frame of the smooth picture, (H, W)
    opening: Image  # the same from nearer


def page(blocks: Sequence[tuple[Shot, Sequence[Cell]]]) -> Image:
    """Lay out what was `drawn`: static and refined mouths and the dense one, in columns."""
    return np.vstack([_block(shot, cells) for shot, cells in blocks])


def drawn(
    size: tuple[int, int], variants: Sequence[Variant], shots: Sequence[Shot]
) -> list[tuple[Shot, list[Cell]]]:
    """Draw every shot in every variant; the cell of the dense mesh is the last of each."""
    mouths = Mouths(variants)
    columns = [(variant.title, one) for variant, one in zip(variants, mouths.refiners, strict=True)]
    columns.append(("dense mesh", mouths.dense))
    found = []
    with Canvas((FINER * size[0], FINER * size[1])) as canvas:
        for shot in shots:
            mouths.pose({shot.expression: 1.0})
            cells = [_cell(title, refiner, mouths, shot, canvas) for title, refiner in columns]
            found.append((shot, cells))
    return found


def _cell(title: str, refiner: refine.Refiner, mouths: Mouths, shot: Shot, canvas: Canvas) -> Cell:
    """Draw one variant of a shot."""
    camera = mouths.camera(shot.view)
    camera.pan(*shot.aside)
    return Cell(
        title,
        smooth=_smaller(mouths.image(canvas, refiner, camera, SMOOTH)),
        flat=_smaller(mouths.image(canvas, refiner, camera, FLAT)),
        kinds=mouths.kinds(canvas, refiner, camera),
        opening=mouths.kinds(canvas, refiner, mouths.camera(shot.near, shot.landmark)),
        triangles=canvas.stream_for(refiner).triangle_count,
    )


def difference(cell: Cell, truth: Cell) -> npt.NDArray[np.float64]:
    """How far each pixel of the smooth picture is from the truth [levels of 255], (H, W)."""
    apart = cell.smooth.astype(np.float64) - truth.smooth
    return np.asarray(np.sqrt((apart**2).mean(axis=2)))


def _smaller(image: Image) -> Image:
    """A picture at its final size."""
    height, width = image.shape[0] // FINER, image.shape[1] // FINER
    return np.asarray(PIL.Image.fromarray(image).resize((width, height), LANCZOS))


def _block(shot: Shot, cells: Sequence[Cell]) -> Image:
    """The rows of one expression."""
    truth = cells[-1]
    height, width = truth.smooth.shape[:2]
    text = max(9.0, width * len(cells) / 76.0)
    gap, margin = max(2, round(width / 100)), round(1.9 * text)
    heights = (height, height, height, height // 2)
    tops = [round(3.4 * text) + sum(heights[:row]) + row * gap for row in range(len(ROWS))]
    size = margin + len(cells) * (width + gap), tops[-1] + heights[-1] + round(0.8 * text)
    page = PIL.Image.new("RGB", size, PAPER)
    draw = ImageDraw.Draw(page)
    draw.text((0.3 * text, text), shot.expression, font=font(1.15 * text), fill=GREY, anchor="lm")
    for column, cell in enumerate(cells):
        left = margin + column * (width + gap)
        middle, count = left + width / 2, f"{cell.triangles} triangles"
        draw.text((middle, text), cell.title, font=font(1.15 * text), fill=INK, anchor="mm")
        draw.text((middle, 2.4 * text), count, font=font(text), fill=INK, anchor="mm")
        shaded = without_noise(cell.smooth), without_noise(cell.flat)
        pictures = (*shaded, *_compared(cell, truth, text))
        for top, picture in zip(tops, pictures, strict=True):
            page.paste(PIL.Image.fromarray(picture), (left, top))
    for name, top, row_height in zip(ROWS, tops, heights, strict=True):
        label = PIL.Image.new("RGB", (row_height, margin), PAPER)
        ImageDraw.Draw(label).text(
            (row_height / 2, 0.45 * margin), name, font=font(text), fill=GREY, anchor="mm"
        )
        page.paste(label.rotate(90, expand=True), (0, top))
    return np.asarray(page)


def _compared(cell: Cell, truth: Cell, text: float) -> tuple[Image, Image]:
    """The pictures of difference and outline; those of the truth say what the others mean."""
    height, width = truth.smooth.shape[:2]
    outline = _smaller(_outlined(cell, truth))
    if cell is truth:
        return _scale((width, height), text), _noted(outline, "red: not as here", text)
    apart = difference(cell, truth)
    rms = float(np.sqrt((apart**2).mean()))
    return (
        _noted(_coloured(apart), f"RMS {rms:.1f}", text),
        _noted(outline, f"{wrong_pixels(cell.kinds, truth.kinds)} pixels wrong", text),
    )


def _coloured(apart: npt.NDArray[np.float64]) -> Image:
    """The colours of differences."""
    shares = np.round(np.clip(apart / FULL_DIFFERENCE, 0.0, 1.0) * SHADES) / SHADES
    shares *= len(RAMP) - 1
    channels = [np.interp(shares, range(len(RAMP)), RAMP[:, k]) for k in range(3)]
    return np.stack(channels, axis=-1).astype(np.uint8)


def _outlined(cell: Cell, truth: Cell) -> Image:
    """The opening of the mouth, dark against light, and where it is not as in the truth."""
    page = np.array([LIPS, OPENING, PAPER], np.uint8)[cell.opening]
    page[(cell.opening == MOUTH) != (truth.opening == MOUTH)] = WRONG
    quarter = len(page) // 4
    return page[quarter:-quarter]


def _scale(size: tuple[int, int], text: float) -> Image:
    """What the colours of differences mean."""
    width, height = size
    page = PIL.Image.new("RGB", size, PAPER)
    draw = ImageDraw.Draw(page)
    bar = np.linspace(0.0, FULL_DIFFERENCE, round(0.72 * width))
    left, top = round(0.14 * width), round(0.5 * height - text)
    page.paste(PIL.Image.fromarray(_coloured(np.tile(bar, (round(2.0 * text), 1)))), (left, top))
    for level in (0.0, 0.5 * FULL_DIFFERENCE, FULL_DIFFERENCE):
        place = (left + level / FULL_DIFFERENCE * len(bar), top + 3.0 * text)
        draw.text(place, f"{level:.0f}", font=font(text), fill=INK, anchor="mm")
    told = "levels of 255 from the dense"
    draw.text((width / 2, top - 1.1 * text), told, font=font(text), fill=INK, anchor="mm")
    return np.asarray(page)


def _noted(image: Image, note: str, text: float) -> Image:
    """A picture with a line of text in its lower left corner."""
    page = PIL.Image.fromarray(image)
    draw = ImageDraw.Draw(page)
    place = (0.6 * text, page.height - 0.6 * text)
    box = draw.textbbox(place, note, font=font(text), anchor="ls")
    draw.rectangle([box[0] - 6, box[1] - 4, box[2] + 6, box[3] + 4], fill=PAPER)
    draw.text(place, note, font=font(text), fill=INK, anchor="ls")
    return np.asarray(page)
