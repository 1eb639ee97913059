"""Colour conversion in both directions, and texels of triangles compared with areas."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from risorius.geometry.colour import to_linear, to_screen
from risorius.geometry.texels import Texels


def test_colours_come_back():
    """Screen colours are unchanged by conversion to linear light and back; middle grey is 0.2."""
    screen = np.linspace(0.0, 1.0, 256)
    assert_allclose(to_screen(to_linear(screen)), screen, atol=1e-7)
    assert to_linear(0.5) == pytest.approx(0.214, abs=1e-3)


def test_texels_of_a_square():
    """Two triangles cover each texel of their square once; margins add a ring of texels."""
    square = np.array([[0.25, 0.25], [0.75, 0.25], [0.75, 0.75], [0.25, 0.75]])
    corners = square[[[0, 1, 2], [0, 2, 3]]]
    found = Texels.within(corners, (64, 64))
    places = np.unique(np.stack([found.rows, found.columns]), axis=1)
    assert places.shape[1] == 32 * 32
    assert places.min() == 16
    assert places.max() == 47
    uv = found.interpolate(corners)
    expected = np.stack([(found.columns + 0.5) / 64, 1.0 - (found.rows + 0.5) / 64], axis=1)
    assert_allclose(uv, expected, atol=1e-9)
    wider = Texels.within(corners, (64, 64), margin=2.0)
    assert wider.rows.min() == wider.columns.min() == 14
    assert wider.weights.min() >= 0.0
