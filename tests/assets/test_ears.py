"""Form of the ears of the built-in head and of persons."""

import numpy as np
import pytest

from risorius.assets import load
from risorius.assets.identities import person_called
from risorius.geometry.directions import unit_vectors

LAST = 12  # number of a rim's vertex at the lowest point of the lobe


def _vertices_of(number):
    """The vertices of a person, or of the built-in head for None [mm], (V, 3)."""
    return load("head").vertices if number is None else person_called(number).vertices


@pytest.mark.parametrize("number", [None, 91000014, 8])
@pytest.mark.parametrize("side", ["left", "right"])
def test_the_rim_of_an_ear_ends_without_a_corner(number, side):
    """The rim of a lobe turns by less than 70 degrees at its last vertex; it turned by 80 to 96."""
    rim = _vertices_of(number)[load("head").rings[f"ear_1_{side}"]]
    steps = np.diff(rim[LAST - 1 : LAST + 2], axis=0)
    before, after = unit_vectors(steps)
    assert np.degrees(np.arccos(before @ after)) < 70.0


@pytest.mark.parametrize("number", [None, 8])
@pytest.mark.parametrize("side", ["left", "right"])
def test_an_ear_has_a_tragus_and_an_antihelix(number, side):
    """The tragus covers the front of the concha, and the antihelix stands out of the scapha.

    The front of the concha was a straight edge, and the ridge behind the concha a step.
    """
    rings = load("head").rings
    vertices = _vertices_of(number) * [{"left": 1.0, "right": -1.0}[side], 1.0, 1.0]
    above, tragus, below = vertices[rings[f"ear_1_{side}"][[15, 14, 13]]]
    between = np.interp(-tragus[1], [-above[1], -below[1]], [above[2], below[2]])
    assert between - tragus[2] > 2.5
    scapha, antihelix = vertices[[rings[f"ear_{row}_{side}"][7] for row in (3, 4)], 0]
    assert antihelix - scapha > 0.5
