"""What somebody met who used the window for the first time, with real mouse and keys."""

from __future__ import annotations

import pytest
from imgui_bundle import imgui

from risorius.app.viewer import Viewer

from .driving import NEEDS_A_SCREEN, click, middle, settle, show_controls, until, xdotool

pytestmark = [*NEEDS_A_SCREEN, pytest.mark.usefixtures("calm")]


def test_escape_closes_a_menu_whose_submenu_is_pointed_at(viewer: Viewer) -> None:
    """The mouse on History, which opens what Escape just closed, keeps nothing open."""
    xdotool(viewer, "key", "n")
    click(viewer, "menu Edit")
    xdotool(viewer, "mousemove", *middle(viewer, "menu Edit: History"))
    assert until(viewer, lambda: imgui.get_current_context().open_popup_stack.size() == 2)
    xdotool(viewer, "key", "Escape")
    settle(viewer)
    assert not viewer.gui.has_popup


def test_history_tells_what_of_the_view_was_changed(viewer: Viewer) -> None:
    """Wireframe and colours are told apart."""
    for key, told in (("w", "View: wireframe"), ("c", "View: colours")):
        xdotool(viewer, "key", key)
        assert until(viewer, lambda told=told: viewer.session.history.labels[-1] == told)


def test_the_bar_of_one_side_shows_the_muscles_of_that_side(viewer: Viewer) -> None:
    """Where an expression has a bar for each side, each draws its own muscles into the face."""
    show_controls(viewer, "joy")
    xdotool(viewer, "key", "Return")
    click(viewer, "sides joy")
    xdotool(viewer, "mousemove", *middle(viewer, "joy_left"))
    assert until(viewer, lambda: "zygomaticus_major_left" in viewer.view.pointed)
    assert "zygomaticus_major_right" not in viewer.view.pointed
    xdotool(viewer, "mousemove", *middle(viewer, "show joy"))
    assert until(viewer, lambda: "zygomaticus_major_right" in viewer.view.pointed)


def test_a_click_on_the_timelines_edge_leaves_its_height_free(viewer: Viewer) -> None:
    """It goes on to be as high as its rows need."""
    viewer.settings.timeline_height = 0.0
    click(viewer, "timeline's edge")
    assert viewer.settings.timeline_height == 0.0


def test_first_steps_leave_the_bar_of_colours_free(viewer: Viewer) -> None:
    """They stand in the other half of the picture."""
    viewer.first_steps.begin()
    xdotool(viewer, "key", "h")  # so that there is room beside the face
    settle(viewer)
    left, _, width, _ = viewer.view.area
    assert viewer.gui.places["first steps: Skip"][2] < left + 0.5 * width
    click(viewer, "first steps: Skip")
    xdotool(viewer, "key", "h")
