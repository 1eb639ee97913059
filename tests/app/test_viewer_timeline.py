"""The timeline in the real window: keys, in rows and as curves, are dragged and undone."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from imgui_bundle import imgui
from pytest import approx

from risorius.app.script.key_sets import KeyId, KeySet
from risorius.app.script.keyframes import POSE_TRACK, on_frame
from risorius.app.script.script_file import load_script, parse_script, script_text
from risorius.app.viewer import Viewer

from .driving import (
    NEEDS_A_SCREEN,
    clear_search,
    click,
    drag,
    drag_and_release,
    key_at,
    middle,
    on_screen,
    pose_times,
    press,
    press_keys,
    settle,
    show_controls,
    where_key,
    xdotool,
)

pytestmark = [*NEEDS_A_SCREEN, pytest.mark.usefixtures("calm", "own")]


JOY_KEY = KeyId(POSE_TRACK, 1.0)
REST_KEY = KeyId(POSE_TRACK, 3.0)


def test_a_key_is_dragged_and_undone_in_one_step(viewer, own):
    """A dragged key moves to whole frames, the face follows, the file stores it.

    One undo reverts it.
    """
    session = viewer.session
    before = session.script
    session.seek(1.0)
    drag(viewer, key_at(viewer, JOY_KEY), (40, 0))
    xdotool(viewer, "mousemove_relative", "--", 13, 0)
    assert session.values["joy"] < 1.0  # visible during the drag
    xdotool(viewer, "mouseup", 1)
    time = pose_times(viewer)[1]
    assert time == on_frame(time) > 1.1
    assert viewer.face.selection.keys == {KeyId(POSE_TRACK, time)}
    assert session.work.name == "own.toml"
    assert session.work.script_is_unsaved
    press_keys(viewer, "ctrl+s")
    assert not session.work.unsaved
    assert load_script(own) == session.script
    assert load_script(own).poses[1].time == time
    press_keys(viewer, "ctrl+z")
    assert session.script == before
    assert session.work.script_is_unsaved
    press_keys(viewer, "ctrl+shift+z")
    assert pose_times(viewer)[1] == time
    assert not session.work.script_is_unsaved


def test_the_first_key_of_a_track_leaves_the_ruler_under_the_mouse(viewer):
    """The rows of a new track appear when the mouse leaves the ruler, which they move up."""
    session = viewer.session
    session.edit(replace(session.script, tracks={}))
    session.seek(0.5)
    settle(viewer)
    before = viewer.gui.places["time"]
    xdotool(viewer, "mousemove", *middle(viewer, "time"))
    session.set("AU12_left", 0.5)
    press_keys(viewer, "k")
    assert len(session.script.tracks) == 1
    assert viewer.gui.places["time"] == before
    xdotool(viewer, "mousemove_relative", "--", 0, -200)
    assert viewer.gui.places["time"][1] < before[1]


def test_a_click_selects_a_key_and_goes_there(viewer):
    """A click selects and shows a pose.

    A click with Shift also selects another, without showing it.
    """
    session = viewer.session
    press(viewer, key_at(viewer, JOY_KEY))
    assert viewer.face.selection.keys == {JOY_KEY}
    assert session.time == 1.0
    assert session.values["joy"] == 1.0
    press(viewer, key_at(viewer, REST_KEY), "shift")
    assert viewer.face.selection.keys == {JOY_KEY, REST_KEY}
    assert session.time == 1.0
    press(viewer, key_at(viewer, JOY_KEY), "shift")
    assert viewer.face.selection.keys == {REST_KEY}
    x, y = key_at(viewer, KeyId(POSE_TRACK, 1.0))
    press(viewer, (x + 50, y))
    assert not viewer.face.selection.keys
    assert not session.work.unsaved


def test_a_box_selects_keys_that_then_move_together(viewer):
    """A drag over empty space selects poses and keys in a box; they move together."""
    session = viewer.session
    x, y = key_at(viewer, JOY_KEY)
    right, low = key_at(viewer, KeyId("blink", 2.4))
    drag_and_release(viewer, (x - 30, y - 4), (right + 12 - x + 30, low - y + 8))
    chosen = viewer.face.selection.keys
    assert {place.track for place in chosen} == {POSE_TRACK, "blink"}
    assert len(chosen) == 5
    drag_and_release(viewer, key_at(viewer, JOY_KEY), (-30, 0))
    by = session.script.poses[1].time - 1.0
    assert by < -0.1
    times = [key.time + 0.0 for key in session.script.tracks["blink"].keys]
    assert times == approx([time + by for time in (2.0, 2.12, 2.22, 2.4)])
    press_keys(viewer, "shift+Right")
    assert session.script.poses[1].time == approx(1.0 + by + 1.0 / 30.0, abs=1e-5)
    press_keys(viewer, "ctrl+z", "ctrl+z")
    assert not session.work.script_is_unsaved


def test_the_face_becomes_a_key(viewer):
    """Shift+K makes a pose of the current face at the playhead."""
    session = viewer.session
    session.seek(2.0)
    open_jaw(viewer)
    wanted = dict(session.values)
    press_keys(viewer, "shift+k")
    assert pose_times(viewer) == [0.0, 1.0, 2.0, 3.0, 4.0]
    assert session.script.at(2.0)["jaw_open"] == approx(wanted["jaw_open"])
    assert viewer.face.selection.keys == {KeyId(POSE_TRACK, 2.0)}
    assert session.work.unsaved == "the script"
    press_keys(viewer, "Home")
    press(viewer, key_at(viewer, KeyId(POSE_TRACK, 2.0)))
    assert session.values == approx(wanted)
    click(viewer, "set key")
    assert viewer.messages.is_error and "No control was moved" in viewer.messages.text
    assert pose_times(viewer) == [0.0, 1.0, 2.0, 3.0, 4.0]


def test_the_menu_of_a_bar_keys_one_control(viewer):
    """A slider's menu adds a key of its control, deletes this key, and clears the track."""
    viewer.session.seek(2.0)
    show_controls(viewer, "jaw open")
    drag_and_release(viewer, middle(viewer, "jaw_open"), (40, 0))
    xdotool(viewer, "mousemove", *middle(viewer, "jaw_open"), "click", 3)
    click(viewer, "control menu: Key this")
    session = viewer.session
    assert pose_times(viewer) == [0.0, 1.0, 3.0, 4.0]
    assert session.script.tracks["jaw_open"].times.tolist() == [1.0, 2.0, 3.0]
    assert "Jaw open keyed" in viewer.messages.text
    xdotool(viewer, "mousemove", *middle(viewer, "jaw_open"), "click", 3)
    click(viewer, "control menu: Delete key")
    assert session.script.tracks["jaw_open"].times.tolist() == [1.0, 3.0]
    xdotool(viewer, "mousemove", *middle(viewer, "jaw_open"), "click", 3)
    click(viewer, "control menu: Clear track")
    assert "jaw_open" not in session.script.tracks
    clear_search(viewer)


def test_the_ruler_scrubs_and_the_wheel_zooms(viewer):
    """A drag in the ruler goes through frames; its end can be dragged; wheels zoom, scroll."""
    axis = viewer.face.time_axis
    session = viewer.session
    x, y = middle(viewer, "time")
    drag(viewer, (x, y), (30, 0))
    assert session.time == on_frame(session.time) > 1.0
    xdotool(viewer, "mouseup", 1)
    kept = axis.time(x - on_screen(viewer, 0, 0)[0] + 30)
    xdotool(viewer, "click", "--repeat", 3, 4)
    assert axis.span < 3.0
    assert not axis.is_whole
    assert axis.time(x - on_screen(viewer, 0, 0)[0] + 30) == approx(kept, abs=0.02)
    start = axis.start
    xdotool(viewer, "keydown", "shift")
    xdotool(viewer, "click", 5)
    xdotool(viewer, "keyup", "shift")
    assert axis.start > start
    press_keys(viewer, "shift+f")
    assert axis.is_whole
    assert axis.start == 0.0
    end = on_screen(viewer, axis.x(4.0) + 3, 0)[0]
    drag_and_release(viewer, (end, y), (-60, 0))
    assert 2.0 < session.script.duration < 3.9
    press_keys(viewer, "ctrl+z")
    assert session.script.duration == 4.0


def test_tracks_unfold_into_rows(viewer):
    """A click on the arrow gives each track a row with selectable keys."""
    left = viewer.gui.places["keys"][0]
    rows = viewer.face.timeline.height()
    _, y = where_key(viewer, KeyId("blink", 2.0))
    xdotool(viewer, "mousemove", *on_screen(viewer, left + 8, y))
    xdotool(viewer, "click", 1)
    assert viewer.face.timeline.height() > rows
    assert viewer.settings.folds["Tracks"]
    settle(viewer)
    x, y = where_key(viewer, KeyId("blink", 2.4))
    press(viewer, on_screen(viewer, x, y + imgui.get_font_size() * 1.35))
    assert viewer.face.selection.keys == {KeyId("blink", 2.4)}


def open_jaw(viewer):
    """Drag the jaw's slider with the mouse, and release it; return its value."""
    show_controls(viewer, "jaw open")
    drag_and_release(viewer, middle(viewer, "jaw_open"), (40, 0))
    clear_search(viewer)
    value = viewer.session.values["jaw_open"]
    assert value > 0.2
    return value


def scrub(viewer, time):
    """Click in the ruler."""
    x = on_screen(viewer, viewer.face.time_axis.x(time), 0.0)[0]
    press(viewer, (x, middle(viewer, "time")[1]))


def test_auto_key(viewer):
    """With auto key on, a released slider keys its control; off, it does not."""
    scrub(viewer, 2.0)
    click(viewer, "auto-key")
    value = open_jaw(viewer)
    assert "jaw_open" in viewer.session.script.tracks
    assert viewer.session.script.at(2.0)["jaw_open"] == approx(value)
    scrub(viewer, 3.5)
    assert not viewer.messages.text
    press_keys(viewer, "ctrl+z")
    assert "jaw_open" not in viewer.session.script.tracks
    click(viewer, "auto-key")
    open_jaw(viewer)
    assert "jaw_open" not in viewer.session.script.tracks


@pytest.fixture
def curves(viewer: Viewer, own: Path) -> None:
    """Show curves in the timeline in place of rows."""
    viewer.settings.shows_curves = True
    settle(viewer)


def place_of(viewer, when, value):
    """Place of a time and a value in the graph [window units]."""
    return viewer.face.time_axis.x(when), float(viewer.face.timeline.dope_sheet.graph.y(value))


def at(viewer, when, value):
    """Screen coordinates of a time and a value."""
    return on_screen(viewer, *place_of(viewer, when, value))


def move(viewer, x, y):
    """Move the mouse in two steps, and release."""
    xdotool(viewer, "mousemove_relative", "--", round(x), round(y))
    xdotool(viewer, "mouseup", 1)


@pytest.mark.usefixtures("curves")
def test_a_key_is_dragged_in_time_and_value(viewer):
    """A key in the graph moves in time and value, to frames and within limits.

    Escape reverts it.
    """
    session = viewer.session
    before = session.script
    drag(viewer, at(viewer, 1.0, 1.0), (-10, 10))
    xdotool(viewer, "mousemove_relative", "--", -10, 10)
    pose = session.script.poses[1]
    assert pose.time == on_frame(pose.time) < 0.9
    assert 0.3 < pose.values["joy"] < 0.95
    xdotool(viewer, "mousemove_relative", "--", 0, -300)
    assert session.script.poses[1].values["joy"] == 1.0
    press_keys(viewer, "Escape")
    xdotool(viewer, "mouseup", 1)
    assert session.script == before


@pytest.mark.usefixtures("curves")
def test_easings_are_chosen_and_seen(viewer):
    """A right click on a key chooses its easing, and the script plays as its curve shows."""
    xdotool(viewer, "mousemove", *at(viewer, 3.0, 0.6))
    xdotool(viewer, "click", 3)
    click(viewer, "menu Keys: Easing: hold")
    script = viewer.session.script
    assert script.poses[2].easing == "hold"
    times, drawn = script.posed_channel("joy").outline(0.0, 4.0, 200)
    played = [script.posed(when)["joy"] for when in times.tolist()]
    assert drawn == approx(played)
    assert max(np.abs(np.diff(drawn))) == approx(0.4)  # a jump
    xdotool(viewer, "mousemove", *at(viewer, 2.9, 1.0))  # on the curve, which is constant here
    graph = viewer.face.timeline.dope_sheet.graph
    hit = graph.at(*place_of(viewer, 2.9, 1.0))
    assert hit.curve.name == "pose joy"
    assert not hit.key


@pytest.mark.usefixtures("curves")
def test_handles_set_slopes(viewer):
    """Handles change the slopes at a selected key in the face and the file.

    Undo and Escape revert the change.
    """
    session = viewer.session
    before = session.script
    viewer.face.selection.keys = KeySet.from_keys(KeyId(POSE_TRACK, 1.0))
    settle(viewer)
    graph = viewer.face.timeline.dope_sheet.graph
    first, last = (handle for handle in graph.handles() if handle.ends in ((0, 1), (1, 0)))
    assert first.slopes == last.slopes == (2.0, 0.0)  # ease-out
    drag(viewer, on_screen(viewer, *first.place), (0, 8))
    move(viewer, 0, round(first.root[1] - first.place[1]))  # to the height of the previous key
    drag(viewer, on_screen(viewer, *last.place), (0, 8))
    move(viewer, 0, 12)
    pose = session.script.poses[1]
    start, end = map(float, pose.easing.split(","))
    assert start == 0.0 < end < 3.0
    assert pose.values == before.poses[1].values
    again = parse_script(script_text(session.script), source="again")
    assert again.at(0.4) == session.script.at(0.4) != before.at(0.4)
    session.seek(0.4)
    assert session.values["joy"] == approx(again.at(0.4)["joy"])
    press_keys(viewer, "ctrl+z")
    press_keys(viewer, "ctrl+z")
    assert session.script == before
    drag(viewer, on_screen(viewer, *last.place), (0, 8))
    assert session.script != before
    press_keys(viewer, "Escape")
    xdotool(viewer, "mouseup", 1)
    assert session.script == before
