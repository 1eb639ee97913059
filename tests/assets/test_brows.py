"""Brows of persons on the texture of the built-in head."""

import numpy as np
import pytest

from risorius.assets.identities.brows import _on_texture
from risorius.geometry.closest import closest_points


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_tails_of_brows_are_straight_on_the_skin(head, side):
    """A line over the temple, straight from the front, is painted straight, to 0.1 mm.

    A smooth map to the texture overshot there: tails were S-shaped, up to 2.8 mm off.
    """
    line = np.column_stack([np.linspace(44.0, 58.0, 29), np.linspace(22.0, 12.0, 29)])
    across, down = _on_texture(line, side).T
    texture = np.column_stack([head.uv, np.zeros(len(head.uv))]).astype(np.float64)
    painted = np.column_stack([across, 1.0 - down, 0.0 * across])
    on_skin = closest_points(painted, texture, head.face_uv).interpolate(head.vertices)
    assert on_skin[:, :2] * [side, 1.0] == pytest.approx(line, abs=0.1)
