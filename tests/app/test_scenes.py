"""Scenes: expressions become controls, the plane waves, the face obeys."""

from __future__ import annotations

import numpy as np
import pytest

from app.errors import UserError
from app.scenes import FaceScene, PlaneScene, mix

LIMITS = {"a": (0.0, 1.0), "b": (-1.0, 1.0)}


def test_mix_adds_and_keeps_the_limits() -> None:
    """Expressions scale their table, single controls are added, limits hold."""
    expressions = {"joy": {"a": 0.8, "b": -0.5}}
    assert mix({"joy": 0.5}, expressions, LIMITS) == pytest.approx({"a": 0.4, "b": -0.25})
    assert mix({"joy": 1.0, "a": 1.0, "b": -3.0}, expressions, LIMITS) == {"a": 1.0, "b": -1.0}
    with pytest.raises(UserError, match="unknown expression or control 'c'"):
        mix({"c": 1.0}, expressions, LIMITS)


def test_the_plane_waves() -> None:
    """154 triangles; the wave lifts vertices along the normal only, and rest is rest again."""
    plane = PlaneScene()
    assert len(plane.faces) == 154
    plane.pose({"amplitude": 1.0, "phase": 0.25})
    plane.step(0.1)
    moved = plane.positions - plane.rest_positions
    assert np.ptp(moved, axis=0).max() > 0.3 * np.ptp(plane.rest_positions, axis=0).max()
    assert np.count_nonzero(np.abs(moved).max(axis=0) > 1e-9) == 1
    plane.reset()
    assert np.array_equal(plane.positions, plane.rest_positions)


def test_every_expression_names_controls() -> None:
    """The table of expressions speaks of controls that the built-in head has, within limits."""
    face = FaceScene()
    assert len(face.expressions) >= 9
    for name, table in face.expressions.items():
        for control, value in table.items():
            low, high = face.limits[control]
            assert low <= value <= high, f"{name}: {control} = {value}"


def test_a_long_step_is_divided() -> None:
    """A film at one frame a second moves the face as steps of a sixtieth do."""
    coarse, fine = FaceScene(), FaceScene()
    for scene in (coarse, fine):
        scene.pose({"joy": 1.0})
    coarse.step(1.0)
    for _ in range(60):
        fine.step(1.0 / 60.0)
    assert np.abs(coarse.positions - fine.positions).max() < 1e-9
