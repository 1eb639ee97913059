"""Text on pictures lies where it belongs, and nowhere else."""

from __future__ import annotations

import numpy as np

from risorius import render
from risorius.app.capture.captions import (
    LEAST_CAPTION,
    PLATE,
    SPLITS_BAR,
    captioned,
    colour_bar,
    contact_sheet,
    labels,
)

STYLE = render.Style()
GREY = np.full((200, 400, 3), 128, np.uint8)


def test_a_caption_for_each_half_and_a_line_between() -> None:
    """Text in both outer corners, the line from top to bottom, the image left as it was."""
    halves = [(0, 0, 200, 200), (200, 0, 200, 200)]
    made = labels(["static", "kahler"], halves, None, STYLE)
    with_captions = captioned(GREY, made, [0, 200])
    is_drawn = (with_captions != 128).any(axis=2)
    assert is_drawn[:, 200].all()
    text = is_drawn.copy()
    text[:, 200] = False
    assert not text[:150].any()
    assert text[150:, :100].any() and text[150:, 300:].any()
    assert not text[:, 100:300].any()
    assert (GREY == 128).all()


def test_a_caption_without_room_is_left_out() -> None:
    """It would lie over the other side, and over the face."""
    made = labels(["static", "kahler"], [(0, 0, 30, 200), (30, 0, 370, 200)], None, STYLE)
    assert [x > 300 for x, _, _ in made] == [True]


def test_labels_lie_on_transparent_pictures() -> None:
    """Where nothing is, a plate is as opaque as it is; colours stay multiplied by alpha."""
    whole = [(0, 0, 400, 200)]
    empty = np.zeros((200, 400, 4), np.uint8)
    page = captioned(empty, labels(["static\n2030 triangles"], whole, None, STYLE), [0])
    assert page[0, 0, 3] == 0 and page[-15, 12, 3] == PLATE and page[..., 3].max() > PLATE
    assert (page[..., :3] <= page[..., 3:]).all()


def test_a_colour_bar_has_all_colours_of_the_skin() -> None:
    """From the least below to the most above, as the renderer has them; there is a plate round."""
    bar = colour_bar(SPLITS_BAR, render.SKIN, 14.0)
    rows = [tuple(map(int, np.rint(255.0 * np.array(each)))) for each in render.SPLIT_PALETTE]
    column = np.argmax((bar[..., :3] == rows[0]).all(axis=2).any(axis=0))
    assert column > 0
    found = list(dict.fromkeys(tuple(map(int, pixel[:3])) for pixel in bar[:, column]))
    assert [each for each in found if each in rows] == rows[::-1]


def test_a_sheet_has_a_cell_for_each_pose() -> None:
    """Row by row, pictures in their proportions, each with its name below."""
    shades = [np.full((60, 80, 3), shade, np.uint8) for shade in (90, 140, 190)]
    sheet = contact_sheet(list(zip("abc", shades, strict=True)), columns=2, cell_width=160)
    row = 120 + LEAST_CAPTION
    assert sheet.shape == (2 * row, 320, 3)
    middles = [sheet[60, 80], sheet[60, 240], sheet[row + 60, 80]]
    assert [middle.tolist() for middle in middles] == [[90] * 3, [140] * 3, [190] * 3]
    names = [sheet[120:row, :160], sheet[120:row, 160:], sheet[row + 120 :, :160]]
    assert all((name > 60).any() for name in names)
    assert not (sheet[row:, 160:] > 60).any()
