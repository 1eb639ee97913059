"""Panels that are kept while the face moves: nobody may notice."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterator

import numpy as np
import pytest

from risorius.app.performances import script_for
from risorius.app.viewer import Viewer
from risorius.app.viewer.window.window import REFRESH

from .driving import clear_search, drag, middle, settle, show_controls, until, xdotool

pytestmark = [
    pytest.mark.window,
    pytest.mark.skipif(
        not os.environ.get("DISPLAY") or shutil.which("xdotool") is None,
        reason="needs a display and xdotool; `make test` brings both",
    ),
]


@pytest.fixture(scope="module")
def viewer() -> Iterator[Viewer]:
    """One window for all tests of this file."""
    with Viewer(script_for(None, "face"), (900, 600)) as opened:
        opened.settings.is_alive = False  # what is compared stands still
        settle(opened)
        yield opened


def test_cached_panels_look_like_new_ones(viewer: Viewer) -> None:
    """While the camera moves, panels are kept; the window looks as if they had been drawn."""
    viewer.session.toggle_alone("disgust")
    settle(viewer)
    assert until(viewer, lambda: viewer.is_idle)
    drawn = []
    note = viewer.panel_cache.note_drawn
    viewer.panel_cache.note_drawn = lambda *size, **over: (drawn.append(True), note(*size, **over))
    viewer.panel_cache.refresh = 60.0
    try:
        for _ in range(5):
            viewer.view.camera.orbit(3.0, 0.0)
            viewer.frame()
        assert not drawn
        kept = viewer.surface.read()
        viewer.panel_cache.refresh = 0.0
        viewer.painter.forget()  # the same picture, drawn again with new panels
        viewer.frame()
        assert drawn
    finally:
        viewer.panel_cache.note_drawn, viewer.panel_cache.refresh = note, REFRESH
    changed = np.abs(viewer.surface.read().astype(int) - kept)
    assert changed.max() == 0


def test_a_slider_answers_at_once_while_the_face_moves(viewer: Viewer) -> None:
    """A slider that is dragged shows it in the same frame, however long panels may be kept."""
    show_controls(viewer, "jaw open")
    place = middle(viewer, "jaw_open")
    left, top, right, bottom = map(round, viewer.gui.places["jaw_open"])
    viewer.panel_cache.refresh = 60.0
    try:
        viewer.view.camera.orbit(3.0, 0.0)
        drag(viewer, place, (1, 0))
        for _ in range(3):
            before = viewer.surface.read()[top:bottom, left:right].astype(int)
            value = viewer.session.values["jaw_open"]
            subprocess.run(["xdotool", "mousemove_relative", "--", "12", "0"], check=True)
            viewer.view.camera.orbit(3.0, 0.0)
            assert until(viewer, lambda old=value: viewer.session.values["jaw_open"] != old)
            after = viewer.surface.read()[top:bottom, left:right].astype(int)
            assert (np.abs(after - before).max(axis=2) > 40).sum() > 20
    finally:
        viewer.panel_cache.refresh = REFRESH
        xdotool(viewer, "mouseup", 1)
        clear_search(viewer)
