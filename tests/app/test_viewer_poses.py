"""Pictures of poses, driven by real mouse and key events."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from risorius.app.script import load_script
from risorius.app.viewer import Viewer
from risorius.app.viewer.panels.pose_grid import PoseGrid, PoseLibrary

from .driving import (
    NEEDS_A_SCREEN,
    click,
    drag,
    middle,
    replace_state,
    settle,
    until,
    xdotool,
)

pytestmark = [*NEEDS_A_SCREEN, pytest.mark.usefixtures("calm")]


def values_of(viewer: Viewer) -> dict[str, float]:
    """What is not 0."""
    return {name: value for name, value in viewer.session.values.items() if value}


@pytest.mark.slow
def test_a_picture_is_taken_blended_and_mirrored(viewer: Viewer) -> None:
    """By a click, a drag to the right, and with Shift; Ctrl+Z takes each back in one step."""
    viewer.settings.folds["Pose pictures"] = True
    assert until(viewer, lambda: "pose Joy" in viewer.gui.places)
    click(viewer, "pose Joy")
    assert values_of(viewer) == {"joy": 1.0}
    drag(viewer, middle(viewer, "pose Anger"), (10, 0))
    left, _, right, _ = viewer.gui.places["pose Anger"]
    xdotool(viewer, "mousemove_relative", "--", round(0.4 * (right - left)), 0)
    xdotool(viewer, "mouseup", 1)
    blended = values_of(viewer)
    assert 0.3 < blended["anger"] < 0.7 and blended["joy"] == pytest.approx(1.0 - blended["anger"])
    xdotool(viewer, "key", "ctrl+z")
    assert values_of(viewer) == {"joy": 1.0}
    xdotool(viewer, "keydown", "shift")
    click(viewer, "pose Wink")
    xdotool(viewer, "keyup", "shift")
    assert values_of(viewer) == {"wink_right": 1.0}
    xdotool(viewer, "key", "ctrl+z", "ctrl+z")
    assert not values_of(viewer)


def test_a_pose_is_kept_with_a_picture(viewer: Viewer, tmp_path: Path) -> None:
    """In a folder, as a plain script; and it is there the next time."""
    grid = viewer.face_panel.poses
    folder, unusable = tmp_path / "poses", tmp_path / "poses" / "broken.toml"
    folder.mkdir()
    unusable.write_text("[[pose")
    grid.close()
    replace_state(grid, PoseGrid(viewer, folder))
    viewer.settings.folds["Pose pictures"], viewer.settings.folds["Expressions"] = True, False
    viewer.session.set("jaw_open", 0.6)
    viewer.settings.zoom = 0.6
    settle(viewer)  # until all is in its place
    try:
        click(viewer, "Keep this pose")
        assert until(viewer, lambda: "pose Pose 1" in viewer.gui.places)
        viewer.session.neutral()
        click(viewer, "pose Pose 1")
    finally:
        viewer.settings.zoom = 1.0
    assert values_of(viewer) == {"jaw_open": 0.6}
    assert load_script(folder / "Pose 1.toml").at(0.0)["jaw_open"] == 0.6
    assert set(PoseLibrary(viewer.session.scene, folder).own) == {"Pose 1"}


def test_pictures_show_their_poses(viewer: Viewer) -> None:
    """Each another; and the window's own picture is not disturbed."""
    poses = PoseLibrary(viewer.session.scene, None)
    try:
        joy, anger = (poses.picture({name: 1.0}).astype(int) for name in ("joy", "anger"))
        assert np.abs(joy - anger).max() > 60
        assert np.abs(joy - poses.picture({"joy": 1.0})).max() <= 1
    finally:
        poses.close()
        viewer.surface.make_current()
