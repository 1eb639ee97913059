"""Furrows carved into a map of heights."""

import numpy as np
import pytest

from risorius.geometry.carving import carve


def test_a_line_is_a_furrow_in_a_trough_where_it_is_deep():
    """A furrow is deepest on its curve, also between samples, and lies within a wider trough.

    Texels outside the trough, or without cover, are unchanged.
    """
    across = np.arange(-4.0, 4.01, 0.5)
    texels = np.zeros((3, len(across), 4), np.float32)
    texels[..., 0] = across
    texels[..., 1] = np.array([0.0, 0.5, 1.0])[:, None]
    texels[..., 2:] = 1.0
    texels[2, :, 3] = 0.0
    courses = np.array([[0.0, 1.0, 1.0]], np.float32)
    depths = np.array([[0.4, 0.2, 0.2]], np.float32)
    forms = np.array([[1.0, 2.0, 0.5]], np.float32)
    heights, furrows = (np.zeros(texels.shape[:2], np.float32) for _ in range(2))
    carve(texels, courses, depths, forms, heights, furrows)
    for row, course, depth in ((0, 0.0, 0.4), (1, 0.5, 0.3)):
        assert across[furrows[row].argmax()] == course
        assert furrows[row].max() == pytest.approx(depth, rel=1e-5)
        assert heights[row].min() == pytest.approx(-1.5 * depth, rel=1e-5)
        far = np.abs(across - course)
        assert (heights[row][far >= 2.0] == 0.0).all()
        assert (furrows[row][far >= 1.0] == 0.0).all()
        assert (heights[row][far < 2.0] < 0.0).all()
    assert not furrows[2].any()
