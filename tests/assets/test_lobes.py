"""Lobes of persons' ears are round."""

import numpy as np
import pytest

from risorius.assets import load
from risorius.assets.identities import person_called
from risorius.assets.identities.lobes import LAST


@pytest.mark.parametrize("number", [91000014, 8])
@pytest.mark.parametrize("side", ["left", "right"])
def test_the_rim_of_an_ear_ends_without_a_corner(number, side):
    """The rim of a lobe turns by less than 70 degrees at its last vertex; it turned by 80 to 96."""
    rim = person_called(number).vertices[load("head").rings[f"ear_1_{side}"]]
    steps = np.diff(rim[LAST - 1 : LAST + 2], axis=0)
    before, after = steps / np.linalg.norm(steps, axis=1, keepdims=True)
    assert np.degrees(np.arccos(before @ after)) < 70.0
