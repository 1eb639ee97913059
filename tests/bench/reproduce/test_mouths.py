"""Which pixels of an opened mouth are wrong."""

from __future__ import annotations

import numpy as np

from risorius.bench.reproduce.mouths import BACKGROUND, MOUTH, SKIN, wrong_pixels


def test_wrong_pixels_by_hand() -> None:
    """Only the opening of the mouth counts: one pixel too many and one too few are two."""
    truth = np.array([[SKIN, MOUTH, MOUTH], [SKIN, SKIN, BACKGROUND]], np.uint8)
    drawn = np.array([[MOUTH, MOUTH, SKIN], [SKIN, BACKGROUND, SKIN]], np.uint8)
    assert wrong_pixels(drawn, truth) == 2
    assert wrong_pixels(truth, truth) == 0
