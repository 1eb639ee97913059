"""What does not show in one picture: folded headings, small windows, dense screens, stalls."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from risorius.app.viewer import Viewer
from risorius.app.viewer.window.window import REFRESH

from .driving import (
    NEEDS_A_SCREEN,
    SIZE,
    clear_search,
    click,
    drag,
    drag_and_release,
    middle,
    moved,
    on_screen,
    settle,
    show_controls,
    until,
    xdotool,
)

pytestmark = [*NEEDS_A_SCREEN, pytest.mark.usefixtures("calm")]


def test_headings_stay_folded(viewer: Viewer) -> None:
    """A heading that was folded is folded the next time; one that is searched only meanwhile."""
    click(viewer, "Expressions")
    assert "joy" not in viewer.gui.places
    click(viewer, "Jaw")
    assert viewer.settings.folds == {"Expressions": False, "Jaw": True}
    show_controls(viewer, "joy")
    assert "joy" in viewer.gui.places
    clear_search(viewer)
    settle(viewer)
    assert "joy" not in viewer.gui.places and "jaw_open" in viewer.gui.places


def test_the_panel_can_be_made_wider(viewer: Viewer) -> None:
    """Its edge follows the mouse, as far as the picture keeps more than half of the window."""
    left, top, _, height = viewer.view.area
    drag_and_release(viewer, on_screen(viewer, left - 1, top + 0.5 * height), (-90, 0))
    assert viewer.view.area[0] == pytest.approx(left - 90, abs=3)
    viewer.settings.panel_width = 22.5
    drag_and_release(viewer, on_screen(viewer, viewer.view.area[0] - 1, top + 0.5 * height), (5, 0))


@pytest.mark.parametrize("zoom", [1.0, 3.0])
def test_everything_stays_inside_its_panel(viewer: Viewer, zoom: float) -> None:
    """However large the words are, no button is cut off and nothing hides the picture."""
    try:
        viewer.settings.zoom = zoom
        xdotool(viewer, "key", "F1")
        left, _, width, height = viewer.view.area
        assert width > 0.5 * SIZE[0] and height > 0.4 * SIZE[1]
        for name in ("Mirror", "Link sides", "search", "show joy", "show blink"):
            assert viewer.gui.places[name][2] <= left, name
        for name in ("play", "record", "loop", "speed", "time"):
            assert viewer.gui.places[name][0] >= left, name
            assert viewer.gui.places[name][2] <= SIZE[0], name
        x, y, right, bottom = viewer.gui.places["help"]
        assert min(x, y) >= 0.0 and right <= SIZE[0] and bottom <= SIZE[1]
    finally:
        viewer.settings.zoom, viewer.panel_state.is_help_open = 1.0, False
        settle(viewer)


def test_any_size_can_be_drawn(viewer: Viewer) -> None:
    """Made tiny, flat, and large again while the face moves: it goes on, and nothing explodes."""
    import glfw

    before = viewer.view.area
    xdotool(viewer, "key", "1")
    try:
        for size in ((1, 1), (40, 30), (700, 20), (20, 500), SIZE):
            glfw.set_window_size(viewer.surface.handle, *size)
            settle(viewer)
            assert moved(viewer) < 60.0
    finally:
        glfw.set_window_size(viewer.surface.handle, *SIZE)
        settle(viewer)
    assert until(viewer, lambda: viewer.is_idle)
    assert viewer.surface.read().shape == (SIZE[1], SIZE[0], 3)
    assert viewer.view.area == before  # the panel is as wide as it was


@pytest.mark.slow
def test_a_dense_screen_has_everything_twice_as_large(viewer: Viewer) -> None:
    """At a content scale of 2 words, sliders and lines are doubled, and the mouse still hits."""
    left, top, right, bottom = viewer.gui.places["Neutral"]
    result = subprocess.run(
        [sys.executable, "-m", "tests.app.dense_window"],
        capture_output=True, text=True, timeout=120, check=False, cwd=Path(__file__).parents[2],
    )  # fmt: skip
    assert result.returncode == 0, result.stderr
    found = json.loads(result.stdout)
    # Letters are as wide as whole pixels allow, which at twice the size is not quite twice as much.
    assert found["button"] == pytest.approx([2.0 * (right - left), 2.0 * (bottom - top)], abs=6.0)
    assert found["line"] == 2.0
    assert found["is_settled"]  # the first picture is where all others are
    assert found["frame"] == found["window"] == [1200, 800]
    assert found["slid"] > 0.3
    assert found["dragged"] > 4.0


def test_a_slider_answers_at_once_while_the_face_moves(viewer: Viewer) -> None:
    """A slider that is dragged shows it in the same frame, however long panels may be kept."""
    show_controls(viewer, "jaw open")
    place = middle(viewer, "jaw_open")
    left, top, right, bottom = map(round, viewer.gui.places["jaw_open"])
    viewer.refresh = 60.0
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
        viewer.refresh = REFRESH
        xdotool(viewer, "mouseup", 1)
        clear_search(viewer)
