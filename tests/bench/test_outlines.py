"""`bench outlines` sees which outlines are truer."""

from __future__ import annotations

import numpy as np
import pytest

from risorius.bench import outlines
from risorius.bench.outlines import BACKGROUND, MOUTH, SKIN, Outline, Variant, wrong_pixels


def test_wrong_pixels_by_hand() -> None:
    """Only the opening of the mouth counts: one pixel too many and one too few are two."""
    truth = np.array([[SKIN, MOUTH, MOUTH], [SKIN, SKIN, BACKGROUND]], np.uint8)
    drawn = np.array([[MOUTH, MOUTH, SKIN], [SKIN, BACKGROUND, SKIN]], np.uint8)
    assert wrong_pixels(drawn, truth) == 2
    assert wrong_pixels(truth, truth) == 0


@pytest.mark.slow
def test_measure_and_report() -> None:
    """By `border` fewer pixels are wrong than without refinement, and by the paper's rule more."""
    variants = [
        Variant("static", "none"),
        Variant("paper", "kahler"),
        Variant("border", "kahler", {"scheme": "cubic", "criterion": "border"}),
    ]
    found = outlines.measure(["disgust", "AU20+AU27"], ["18,6"], size=(400, 350), variants=variants)
    static, paper, border = (sum(one.wrong) for one in found)
    assert border < 0.8 * static < 0.8 * paper
    assert [len(one.wrong) for one in found] == [2, 2, 2]
    assert found[0].triangles == 2030 < found[2].triangles < 3500


def test_report() -> None:
    """Means, shares of the first row, and how often there is less."""
    text = outlines.report(
        "title", [Outline("as it is", 10.0, (100, 50)), Outline("round", 20.0, (30, 60))]
    )
    assert text.splitlines()[0] == "title: 2 pictures"
    assert text.splitlines()[-1].split() == ["round", "20", "45", "40", "1"]
