"""The timeline's ruler, buttons and curves in the real window, and undo while the mouse drags."""

from __future__ import annotations

import pytest
from imgui_bundle import imgui

from risorius.app.script.keyframes import POSES
from risorius.app.script.places import KeyPlace
from risorius.app.viewer import Viewer

from .driving import (
    NEEDS_A_SCREEN,
    clear_search,
    click,
    drag,
    key_at,
    middle,
    nose,
    on_screen,
    pose_times,
    press,
    settle,
    show_controls,
    until,
    xdotool,
)

pytestmark = [*NEEDS_A_SCREEN, pytest.mark.usefixtures("calm", "own")]

JOY = KeyPlace(POSES, 1.0)
BUTTONS = ("play", "record", "loop", "set key", "auto-key", "curves")


# Undo while the mouse drags


@pytest.mark.slow
def test_undo_takes_back_a_slider_that_is_held(viewer: Viewer) -> None:
    """Ctrl+Z ends the drag, all of which goes, and can be done again."""
    show_controls(viewer, "jaw open")
    drag(viewer, middle(viewer, "jaw_open"), (30, 0))
    held = viewer.session.values["jaw_open"]
    assert held > 0.5
    xdotool(viewer, "key", "ctrl+z")
    assert viewer.session.values["jaw_open"] == 0.0
    xdotool(viewer, "mousemove_relative", "--", 5, 0)
    xdotool(viewer, "mouseup", 1)
    assert viewer.session.values["jaw_open"] == 0.0
    xdotool(viewer, "key", "ctrl+y")
    assert viewer.session.values["jaw_open"] == held
    clear_search(viewer)


def test_undo_takes_back_a_key_that_is_held(viewer: Viewer) -> None:
    """The key is where it was, whatever the mouse does then; redo brings it where it was let go."""
    drag(viewer, key_at(viewer, JOY), (40, 0))
    moved = pose_times(viewer)
    assert moved[1] > 1.0
    xdotool(viewer, "key", "ctrl+z")
    assert pose_times(viewer) == [0.0, 1.0, 3.0, 4.0]
    xdotool(viewer, "mousemove_relative", "--", 40, 0)
    xdotool(viewer, "mouseup", 1)
    assert pose_times(viewer) == [0.0, 1.0, 3.0, 4.0]
    xdotool(viewer, "key", "ctrl+y")
    assert pose_times(viewer)[1] == pytest.approx(moved[1], abs=0.02)  # Ctrl leaves frames


def test_undo_takes_back_a_pull_that_is_held(viewer: Viewer) -> None:
    """The skin is let go first, then its muscles go; redo brings them."""
    x, y = nose(viewer)
    drag(viewer, (x + 40, y + 30), (15, -10))  # beside the mouth
    xdotool(viewer, "mousemove_relative", "--", 10, -10)
    assert until(viewer, lambda: any(viewer.session.values.values()))
    xdotool(viewer, "key", "ctrl+z")
    assert not viewer.mouse.is_dragging and not any(viewer.session.values.values())
    xdotool(viewer, "mouseup", 1)
    assert viewer.session.history.labels[-1].startswith("Pull (")
    xdotool(viewer, "key", "ctrl+y")
    assert any(viewer.session.values.values())


def test_undo_takes_back_how_it_is_drawn_before_the_face(viewer: Viewer) -> None:
    """A slider of the panel Mechanism that is held is the last thing that was done."""
    viewer.session.toggle_alone("joy")
    click(viewer, "tab Mechanism")
    drag(viewer, middle(viewer, "wrinkles"), (-30, 0))
    assert viewer.settings.display.wrinkles < 1.0
    xdotool(viewer, "key", "ctrl+z")
    xdotool(viewer, "mouseup", 1)
    assert viewer.settings.display.wrinkles == 1.0 and viewer.session.is_alone("joy")
    click(viewer, "tab Face")


# The ruler and the buttons


def number_in_ruler(viewer: Viewer, when: float, beside: float) -> tuple[int, int]:
    """A place on a number of the ruler, so many letters' heights beside its middle."""
    _, top, _, bottom = viewer.gui.places["time"]
    em = imgui.get_font_size()
    return on_screen(viewer, viewer.time_axis.x(when) + beside * em, 0.7 * top + 0.3 * bottom)


def test_a_click_on_a_number_goes_there(viewer: Viewer) -> None:
    """Wherever in the number; a drag from there goes to other frames."""
    labelled = [tick.time for tick in viewer.time_axis.ticks(4.2 * imgui.get_font_size())]
    assert 2.0 in labelled
    press(viewer, number_in_ruler(viewer, 2.0, 0.2))
    assert viewer.session.time == 2.0
    drag(viewer, number_in_ruler(viewer, 2.0, 0.0), (12, 0))
    xdotool(viewer, "mouseup", 1)
    assert 2.0 < viewer.session.time < 2.5


def test_buttons_stay_where_they_are(viewer: Viewer) -> None:
    """However many rows there are, and as curves."""

    def places() -> list[tuple[float, ...]]:
        """Of the buttons, when the panels have found theirs."""
        settle(viewer)
        return [viewer.gui.places[name] for name in BUTTONS]

    before, height = places(), viewer.timeline.height()
    viewer.settings.folds |= {"Tracks": True, "Whole poses": True}
    assert places() == before and viewer.timeline.height() > height
    click(viewer, "curves")
    assert places() == before and viewer.settings.shows_curves
    viewer.settings.shows_curves = False
    viewer.session.begin_script()
    assert places() == before and viewer.timeline.height() < height


# Keys that were changed


# Values of curves


def test_values_are_zoomed_and_panned(viewer: Viewer) -> None:
    """Ctrl and the wheel about the mouse, the middle button both ways; Shift+F shows all."""
    viewer.settings.shows_curves = True
    settle(viewer)
    axis, graph = viewer.time_axis, viewer.timeline.dope_sheet.graph
    whole, span = graph.slope, axis.span

    def place() -> tuple[float, float]:
        return axis.x(2.0), float(graph.y(0.8))

    before = place()
    xdotool(viewer, "mousemove", *on_screen(viewer, *before))
    xdotool(viewer, "keydown", "ctrl", "click", "--repeat", 4, 4, "keyup", "ctrl")
    assert graph.slope < 2.0 * whole < 0.0 and axis.span == span
    assert place() == pytest.approx(before, abs=1.5)
    xdotool(viewer, "click", 4)
    assert axis.span < span
    before = place()
    drag(viewer, on_screen(viewer, *before), (-30, 20), button=2)
    xdotool(viewer, "mouseup", 2)
    assert place() == pytest.approx((before[0] - 30, before[1] + 20), abs=1.5)
    joy = viewer.session.script.poses[1].values["joy"]
    assert joy == 1.0  # keys stay
    xdotool(viewer, "key", "shift+f")
    settle(viewer)
    assert graph.slope == pytest.approx(whole) and axis.is_whole
