"""Poses, keys and recordings in the real window: nothing is lost without a word."""

from __future__ import annotations

from pathlib import Path

import pytest
from imgui_bundle import imgui

from risorius.app.script import load_script
from risorius.app.script.keyframes import POSES
from risorius.app.script.places import KeyPlace
from risorius.app.viewer import Viewer

from .driving import (
    NEEDS_A_SCREEN,
    clear_search,
    click,
    drag,
    middle,
    on_screen,
    settle,
    show_controls,
    until,
    write,
    xdotool,
)
from .test_viewer_timeline import at, own, pose_times, press

__all__ = ["own"]
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
def test_a_pose_that_was_scrubbed_away_is_told_and_comes_back(viewer: Viewer) -> None:
    """The ruler, and a click on a key: each says in a line what it lets go; Ctrl+Z has it."""
    scrub(viewer, 2.0)
    time, value = viewer.session.time, open_jaw(viewer)
    assert viewer.session.differing == {"jaw_open"}
    for away in (lambda: scrub(viewer, 3.5), lambda: press(viewer, at(viewer, JOY))):
        viewer.messages.text = ""
        away()
        assert viewer.session.values["jaw_open"] < value
        assert "Jaw open not keyed" in viewer.messages.text and "[Undo]" in viewer.messages.text
        xdotool(viewer, "key", "ctrl+z")
        assert viewer.session.values["jaw_open"] == value and viewer.session.time == time


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


@pytest.mark.slow
def test_recording_punches_in(viewer: Viewer) -> None:
    """Ctrl+R begins at the playhead, and replaces what was moved while it ran; Ctrl+Z takes it."""
    before = viewer.session.script
    scrub(viewer, 2.0)
    start = viewer.session.time
    show_controls(viewer, "jaw open")
    clear_search(viewer)
    xdotool(viewer, "key", "ctrl+r")
    assert viewer.session.is_recording and "Recording from 2.0" in viewer.messages.text
    viewer.session.set("jaw_open", 0.7)
    assert until(viewer, lambda: viewer.session.time > start + 0.4)
    xdotool(viewer, "key", "ctrl+r")
    script = viewer.session.script
    assert "1 control recorded" in viewer.messages.text and "[Save script]" in viewer.messages.text
    assert script.poses == before.poses and set(script.tracks) == {"blink", "jaw_open"}
    assert script.tracks["blink"] == before.tracks["blink"]
    assert script.tracks["jaw_open"].times[0] >= start
    assert script.at(1.0) == {**before.at(1.0), "jaw_open": before.at(1.0)["jaw_open"]}
    assert viewer.session.name == "own.toml"
    xdotool(viewer, "key", "ctrl+z")
    assert viewer.session.script == before


@pytest.mark.slow
def test_keys_are_copied_and_pasted(viewer: Viewer, own: Path, tmp_path: Path) -> None:
    """Ctrl+C and Ctrl+V: at the playhead, and in another script, too."""
    press(viewer, at(viewer, JOY))
    xdotool(viewer, "key", "ctrl+c")
    scrub(viewer, 2.0)
    xdotool(viewer, "key", "ctrl+v")
    assert pose_times(viewer) == [0.0, 1.0, 2.0, 3.0, 4.0]
    assert viewer.session.script.poses[2].name == "joy"
    xdotool(viewer, "key", "ctrl+z")
    viewer.session.open(load_script(own))
    viewer.session.begin_script()
    settle(viewer)  # the row of tracks goes
    scrub(viewer, 1.5)
    xdotool(viewer, "key", "ctrl+v")
    assert pose_times(viewer) == [0.0, 1.5] and viewer.session.script.poses[1].name == "joy"


def test_keys_are_deleted_only_when_somebody_means_it(viewer: Viewer) -> None:
    """Never by Backspace; by Delete when the timeline was touched last, not after other work."""
    settle(viewer)
    press(viewer, at(viewer, JOY))
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
    press(viewer, at(viewer, JOY))
    xdotool(viewer, "key", "Delete")
    assert pose_times(viewer) == [0.0, 3.0, 4.0]


def test_a_name_leaves_the_strip_where_it_is(viewer: Viewer) -> None:
    """Rows stay where they are when the first pose of a script gets its name, or loses it."""
    viewer.session.begin_script()
    settle(viewer)
    first = KeyPlace(POSES, 0.0)
    before = viewer.timeline.height(), at(viewer, first)
    viewer.selection.rename()
    assert until(viewer, lambda: "pose name" in viewer.gui.places)
    write(viewer, "rest")
    xdotool(viewer, "key", "Return")
    assert viewer.session.script.key_poses
    assert (viewer.timeline.height(), at(viewer, first)) == before


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
