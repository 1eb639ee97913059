"""Text on pictures: it is drawn at its place, and nothing else changes."""

import numpy as np

from risorius import render
from risorius.app.capture.captions import LEAST_CAPTION, captioned, contact_sheet, labels

GREY_PICTURE = np.full((200, 400, 3), 128, np.uint8)


def test_a_caption_for_each_half_and_a_line_between():
    """Each half has text in its outer corner, with a line between; the image is unchanged."""
    halves = [(0, 0, 200, 200), (200, 0, 200, 200)]
    made = labels(["static", "kahler"], halves, has_bar=False)
    with_captions = captioned(GREY_PICTURE, made, [0, 200])
    is_drawn = (with_captions != 128).any(axis=2)
    assert is_drawn[:, 200].all()
    text = is_drawn.copy()
    text[:, 200] = False
    assert not text[:150].any()
    assert text[150:, :100].any()
    assert text[150:, 300:].any()
    assert not text[:, 100:300].any()
    assert (GREY_PICTURE == 128).all()


def test_a_caption_without_room_is_left_out():
    """A caption that would cover the other side and the face is left out."""
    made = labels(["static", "kahler"], [(0, 0, 30, 200), (30, 0, 370, 200)], has_bar=False)
    assert [x > 300 for x, _, _ in made] == [True]


def test_the_bar_shows_the_colours_of_splits_from_one_to_six():
    """At the upper right, the bar has the palette's colours, from one split below to six above."""
    ((x, y, image),) = labels([], [(0, 0, 400, 200)], has_bar=True)
    assert x > 300
    assert y > 50
    column = image[:, round(0.45 * image.shape[1]), :3].astype(float) / 255.0
    nearest = [np.abs(column - shade).max(axis=1).argmin() for shade in render.SPLIT_PALETTE]
    assert np.abs(column[nearest] - render.SPLIT_PALETTE).max() < 0.01
    assert (np.diff(nearest) < 0).all()


def test_a_sheet_has_a_cell_for_each_pose():
    """A sheet has rows of pictures in their proportions, each with its pose's name below."""
    shades = [np.full((60, 80, 3), shade, np.uint8) for shade in (90, 140, 190)]
    sheet = contact_sheet(list(zip("abc", shades, strict=True)), columns=2, cell_width=160)
    row = 120 + LEAST_CAPTION
    assert sheet.shape == (2 * row, 320, 3)
    middles = [sheet[60, 80], sheet[60, 240], sheet[row + 60, 80]]
    assert [middle.tolist() for middle in middles] == [[90] * 3, [140] * 3, [190] * 3]
    names = [sheet[120:row, :160], sheet[120:row, 160:], sheet[row + 120 :, :160]]
    assert all((name > 60).any() for name in names)
    assert not (sheet[row:, 160:] > 60).any()
