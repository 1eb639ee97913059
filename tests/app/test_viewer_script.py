"""Poses, keys and recordings in the real window: nothing is lost without a word."""

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
    on_screen,
    pose_times,
    press,
    settle,
    show_controls,
    until,
    write,
    xdotool,
)

pytestmark = [*NEEDS_A_SCREEN, pytest.mark.usefixtures("calm", "own")]

JOY = KeyPlace(POSES, 1.0)


def open_jaw(viewer: Viewer) -> float:
    """Drag the jaw's slider with the mouse, and let it go; what it is then."""
    show_controls(viewer, "jaw open")
    drag(viewer, middle(viewer, "jaw_open"), (40, 0))
    xdotool(viewer, "mouseup", 1)
    clear_search(viewer)
    value = viewer.session.values["jaw_open"]
    assert value > 0.2
    return value


def scrub(viewer: Viewer, time: float) -> None:
    """Click in the ruler."""
    x = on_screen(viewer, viewer.time_axis.x(time), 0.0)[0]
    press(viewer, (x, middle(viewer, "time")[1]))


@pytest.mark.slow
def test_what_is_not_keyed_is_keyed_or_let_go_by_a_button(viewer: Viewer) -> None:
    """Both stand by the timeline, and say nothing where nothing differs."""
    scrub(viewer, 2.0)
    place = viewer.session.history.place
    click(viewer, "let go")
    assert viewer.session.history.place == place and not viewer.messages.text
    value = open_jaw(viewer)
    click(viewer, "let go")
    assert viewer.session.values["jaw_open"] < value and "let go" in viewer.messages.text
    open_jaw(viewer)
    click(viewer, "set key")
    assert pose_times(viewer) == [0.0, 1.0, 2.0, 3.0, 4.0] and not viewer.session.differing


def test_auto_key(viewer: Viewer) -> None:
    """Switched on by its button, a slider that is let go is a key; switched off, it is none."""
    scrub(viewer, 2.0)
    click(viewer, "auto-key")
    value = open_jaw(viewer)
    assert pose_times(viewer) == [0.0, 1.0, 2.0, 3.0, 4.0]
    assert viewer.session.script.at(2.0)["jaw_open"] == pytest.approx(value)
    scrub(viewer, 3.5)
    assert not viewer.messages.text
    xdotool(viewer, "key", "ctrl+z")
    assert pose_times(viewer) == [0.0, 1.0, 3.0, 4.0]
    click(viewer, "auto-key")
    open_jaw(viewer)
    assert pose_times(viewer) == [0.0, 1.0, 3.0, 4.0]


def test_keys_are_deleted_only_when_somebody_means_it(viewer: Viewer) -> None:
    """Never by Backspace; by Delete when the timeline was touched last, not after other work."""
    settle(viewer)
    press(viewer, key_at(viewer, JOY))
    assert viewer.selection.places == {JOY}
    xdotool(viewer, "key", "BackSpace")
    assert viewer.selection.places == {JOY}
    assert pose_times(viewer) == [0.0, 1.0, 3.0, 4.0]
    click(viewer, "search")
    write(viewer, "jaw")
    assert viewer.selection.places == {JOY}
    xdotool(viewer, "key", "Delete", "Return")
    assert until(viewer, lambda: not imgui.get_io().want_text_input)
    xdotool(viewer, "key", "Delete")
    assert until(viewer, lambda: "timeline" in viewer.messages.text)
    assert pose_times(viewer) == [0.0, 1.0, 3.0, 4.0]
    clear_search(viewer)
    press(viewer, key_at(viewer, JOY))
    xdotool(viewer, "key", "Delete")
    assert pose_times(viewer) == [0.0, 3.0, 4.0]


@pytest.mark.slow
def test_the_history_is_a_menu(viewer: Viewer) -> None:
    """Edit names what it undoes, and lists all that was done; a click goes there."""
    for key in ("1", "2", "n"):
        xdotool(viewer, "key", key)
    undo = next(each for each in viewer.commands if each.label == "Undo")
    assert undo.reads is not None and undo.reads() == "Undo neutral"
    click(viewer, "menu Edit")
    click(viewer, "menu Edit: History")
    (first,) = [name for name in viewer.gui.places if name.startswith("menu Edit: Show joy##")]
    click(viewer, first)
    assert viewer.session.is_alone(viewer.session.scene.expressions[0])
    assert undo.reads().startswith("Undo show")
    xdotool(viewer, "key", "Escape")
