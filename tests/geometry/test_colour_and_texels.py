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
    assert places.shape[1] == len(found.rows) == 32 * 32
    assert places.min() == 16
    assert places.max() == 47
    uv = found.interpolate(corners)
    expected = np.stack([(found.columns + 0.5) / 64, 1.0 - (found.rows + 0.5) / 64], axis=1)
    assert_allclose(uv, expected, atol=1e-9)
    wider = Texels.within(corners, (64, 64), margin=2.0)
    assert wider.rows.min() == wider.columns.min() == 14
    assert wider.weights.min() >= 0.0


def test_a_texel_belongs_to_the_triangle_in_which_it_lies_deepest(generator):
    """Overlapping triangles and their margins equal a plain search of all triangles."""
    size = 24
    margin = 1.5
    corners = generator.uniform(0.2, 0.8, (12, 3, 2))
    found = Texels.within(corners, (size, size), margin)
    down, right = np.mgrid[:size, :size]
    texels = np.stack([right.ravel() + 0.5, size - down.ravel() - 0.5], axis=1) / size
    depths = []
    for triangle in corners:
        a, b, c = triangle
        of_bc = np.linalg.solve(np.stack([b - a, c - a], axis=1), (texels - a).T)
        weights = np.stack([1.0 - of_bc.sum(axis=0), *of_bc])
        opposite = np.linalg.norm(
            np.roll(triangle, 1, axis=0) - np.roll(triangle, 2, axis=0), axis=1
        )
        area = abs(np.linalg.det(np.stack([b - a, c - a])))
        slack = margin / size * opposite / area
        is_near = (weights > -slack[:, None]).all(axis=0)
        reach = margin / size
        is_near &= (texels >= triangle.min(axis=0) - reach).all(axis=1)
        is_near &= (texels <= triangle.max(axis=0) + reach).all(axis=1)
        depths.append(np.where(is_near, weights.min(axis=0), -np.inf))
    owner = np.argmax(depths, axis=0)
    owner[np.max(depths, axis=0) == -np.inf] = -1
    expected = owner.reshape(size, size)
    drawn = np.full((size, size), -1)
    drawn[found.rows, found.columns] = found.faces
    assert np.array_equal(drawn, expected)
    assert len(np.unique(found.faces)) > 6
