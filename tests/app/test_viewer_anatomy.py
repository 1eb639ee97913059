"""Anatomy in the window: a key shows it, and it is the picture that `capture` draws."""

from __future__ import annotations

import numpy as np
import pytest

from risorius.app.viewer import Viewer  # before render, see app/viewer/gui.py
from risorius.app.viewer.setting_rules import SKINS

from risorius import render  # isort: skip
from risorius.app.anatomy import AnatomyView
from risorius.app.capture import Capture, CaptureOptions

from .driving import settle, xdotool

pytestmark = pytest.mark.window


@pytest.mark.usefixtures("calm")
def test_a_key_shows_the_muscles_as_capture_draws_them(viewer: Viewer) -> None:
    """U switches them on and off; nothing stays behind."""
    settle(viewer)
    usual = viewer.stage.draw_image(viewer.view).astype(int)
    xdotool(viewer, "key", "u")
    settle(viewer)
    assert viewer.settings.display.overlays == ["muscles"]
    shown = viewer.stage.draw_image(viewer.view).astype(int)
    assert (np.abs(shown - usual).max(axis=2) > 16).mean() > 0.05
    size = shown.shape[1], shown.shape[0]
    style = render.Style(albedo=SKINS["textured"][1], background=viewer.view.background)
    options = CaptureOptions(size=size, style=style, anatomy=AnatomyView(("muscles",)))
    with Capture(viewer.session.scene, options) as capture:
        capture.camera = viewer.view.camera
        off = np.abs(capture.draw_image().astype(int) - shown)
    assert np.percentile(off, 99) <= 2.0
    viewer.surface.make_current()
    xdotool(viewer, "key", "u")
    settle(viewer)
    assert np.array_equal(viewer.stage.draw_image(viewer.view), usual)


@pytest.mark.usefixtures("calm")
def test_a_colour_bar_goes_with_the_colours(viewer: Viewer) -> None:
    """B shows one side of a comparison: the mesh that nothing splits has no bar, the other has."""
    display = viewer.settings.display
    display.colours, display.compare = "splits", "side by side"
    settle(viewer)
    assert len(viewer.surface.labels) == 3  # two captions
    counts = {}
    for _ in range(2):
        xdotool(viewer, "key", "b")
        settle(viewer)
        counts[display.compare] = len(viewer.surface.labels)
    assert counts == {"A alone": 1, "B alone": 2}
