"""Which way up a head is, by its shape."""

from __future__ import annotations

import numpy as np
import pytest

from risorius import assets
from risorius.assets.fitting.guess import axes_turned, upright
from risorius.assets.model import FloatArray


def built_in(part: str) -> FloatArray:
    """The built-in head, its face alone, or the head above a shirt."""
    head = assets.load("head")
    if part == "face":
        return head.vertices[head.vertices[:, 2] > 0.0]
    shirts = [each.vertices for each in head.parts if "shirt" in each.name]
    return np.vstack([head.vertices, *shirts]) if part == "bust" else head.vertices


@pytest.mark.parametrize("part", ["head", "face", "bust"])
def test_a_head_is_put_upright_from_any_side(part: str) -> None:
    """Whatever axis points up or ahead in its file, and in any unit."""
    vertices = built_in(part)
    for turn in axes_turned()[::5]:
        found = upright(0.001 * vertices @ turn.T + 7.0, 140.0)
        assert found.rotation @ turn == pytest.approx(np.eye(3))
        seen = found.points(0.001 * vertices @ turn.T + 7.0)
        assert np.linalg.norm(seen, axis=1).max() == pytest.approx(140.0)


def test_there_are_twenty_four_ways() -> None:
    """All are rotations, and the first leaves a mesh as it is."""
    turns = axes_turned()
    assert len({turn.tobytes() for turn in turns}) == 24 and np.array_equal(turns[0], np.eye(3))
