"""The window with another scene than the face: the cloth falls when its slider is moved."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from risorius.app.performances import script_for
from risorius.app.viewer import Viewer

from .driving import NEEDS_A_SCREEN, settle, until

pytestmark = NEEDS_A_SCREEN


def test_the_cloth_falls_in_the_window(tmp_path: Path) -> None:
    """Let go, it hangs after some seconds; the ball turns where nothing else moves, too."""
    with Viewer(script_for(None, "cloth"), (480, 360), settings_path=tmp_path / "s.json") as viewer:
        settle(viewer)
        assert {"drop", "turn"} <= viewer.gui.places.keys()  # sliders are there at once
        assert next(iter(viewer.layout._tabs)) == "Cloth###Face"  # it has none
        scene = viewer.session.scene
        viewer.session.set("turn", 0.25)
        assert until(viewer, lambda: bool(np.isclose(scene.bone_transforms()["ball"][0, 2], 1.0)))
        viewer.session.set("drop", 1.0)
        assert until(viewer, lambda: float(scene.positions[:, 1].min()) < -100.0)
        assert viewer.session.controls.limits["turn"] == (-2.0, 2.0)
        frame = viewer.surface.read()
        assert frame.std() > 10.0
