"""The graph editor in the real window: curves whose keys are dragged in time and in value."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from risorius.app.script import parse_script, script_text
from risorius.app.script.keyframes import POSES, on_frame
from risorius.app.script.places import KeyPlace, Places
from risorius.app.viewer import Viewer

from .driving import NEEDS_A_SCREEN, click, drag, on_screen, settle, xdotool

pytestmark = [*NEEDS_A_SCREEN, pytest.mark.usefixtures("calm", "curves")]


@pytest.fixture
def curves(viewer: Viewer, own: Path) -> None:
    """Values in place of the rows."""
    viewer.settings.shows_curves = True
    settle(viewer)


def place_of(viewer: Viewer, when: float, value: float) -> tuple[float, float]:
    """Where a time and a value are in the graph [window units]."""
    return viewer.time_axis.x(when), float(viewer.timeline.dope_sheet.graph.y(value))


def at(viewer: Viewer, when: float, value: float) -> tuple[int, int]:
    """The same, on the screen."""
    return on_screen(viewer, *place_of(viewer, when, value))


def move(viewer: Viewer, x: float, y: float) -> None:
    """Move the mouse on, in two steps, and let go."""
    xdotool(viewer, "mousemove_relative", "--", round(x), round(y))
    xdotool(viewer, "mouseup", 1)


def values(viewer: Viewer, control: str) -> list[float]:
    """What each pose has of a control."""
    return [pose.values.get(control, 0.0) for pose in viewer.session.script.poses]


def test_a_key_is_dragged_in_value(viewer: Viewer) -> None:
    """The pose's value of that curve alone goes along, the face follows, one undo takes it back."""
    before = viewer.session.script
    viewer.session.seek(1.0)
    drag(viewer, at(viewer, 1.0, 1.0), (0, 10))
    move(viewer, 0, 20)
    assert [pose.time for pose in viewer.session.script.poses] == [0.0, 1.0, 3.0, 4.0]
    joy = values(viewer, "joy")[1]
    assert joy == round(joy, 2) < 0.95 and viewer.session.values["joy"] == joy
    assert values(viewer, "jaw_open") == [0.0, 0.1, 0.0, 0.0]
    assert viewer.session.script.tracks is not before.tracks
    assert viewer.session.script.tracks == before.tracks
    assert viewer.selection.places == {KeyPlace(POSES, 1.0)}
    xdotool(viewer, "key", "ctrl+z")
    assert viewer.session.script == before


def test_a_key_is_dragged_in_time_and_value(viewer: Viewer) -> None:
    """Both at once, to frames and within limits; Escape puts it back."""
    before = viewer.session.script
    drag(viewer, at(viewer, 1.0, 1.0), (-10, 10))
    xdotool(viewer, "mousemove_relative", "--", -10, 10)
    pose = viewer.session.script.poses[1]
    assert pose.time == on_frame(pose.time) < 0.9 and 0.3 < pose.values["joy"] < 0.95
    xdotool(viewer, "mousemove_relative", "--", 0, -300)
    assert viewer.session.script.poses[1].values["joy"] == 1.0
    xdotool(viewer, "key", "Escape")
    xdotool(viewer, "mouseup", 1)
    assert viewer.session.script == before


def test_a_box_selects_by_value(viewer: Viewer) -> None:
    """Only keys inside move, all by as much; poses keep the values of other curves."""
    left, top = at(viewer, 0.9, 1.0)
    right, bottom = at(viewer, 2.3, 0.7)
    drag(viewer, (left, top - 6), (10, 10))
    move(viewer, right - left - 10, bottom - top - 4)
    chosen = viewer.selection.places
    assert chosen == {KeyPlace(POSES, 1.0), KeyPlace("blink", 2.12), KeyPlace("blink", 2.22)}
    drag(viewer, at(viewer, 2.22, 1.0), (0, 20))
    move(viewer, 0, 20)
    keys = viewer.session.script.tracks["blink"].values.tolist()
    assert keys[0] == keys[3] == 0.0 and keys[1] == keys[2] < 0.9
    assert values(viewer, "joy")[1] == 1.0 and viewer.selection.places == chosen


def test_easings_are_chosen_and_seen(viewer: Viewer) -> None:
    """A right click on a key chooses how it is approached, and the curve is what is played."""
    xdotool(viewer, "mousemove", *at(viewer, 3.0, 0.6))
    xdotool(viewer, "click", 3)
    click(viewer, "menu Keys: Easing: hold")
    script = viewer.session.script
    assert script.poses[2].easing == "hold"
    times, drawn = script.posed_channel("joy").outline(0.0, 4.0, 200)
    played = [script.posed(when)["joy"] for when in times.tolist()]
    assert drawn == pytest.approx(played)
    assert max(np.abs(np.diff(drawn))) == pytest.approx(0.4)  # it jumps
    xdotool(viewer, "mousemove", *at(viewer, 2.9, 1.0))  # on the curve that now stays
    graph = viewer.timeline.dope_sheet.graph
    hit = graph.at(*place_of(viewer, 2.9, 1.0))
    assert hit is not None and hit.curve.name == "pose joy" and not hit.key


def test_handles_set_slopes(viewer: Viewer) -> None:
    """Handles of the way to a selected key bend it; face and file get the same; undo, Escape."""
    before = viewer.session.script
    viewer.selection.places = Places.of(KeyPlace(POSES, 1.0))
    settle(viewer)
    graph = viewer.timeline.dope_sheet.graph
    first, last = (handle for handle in graph.handles() if handle.ends in ((0, 1), (1, 0)))
    assert first.slopes == last.slopes == (2.0, 0.0)  # ease-out
    drag(viewer, on_screen(viewer, *first.place), (0, 8))
    move(viewer, 0, round(first.root[1] - first.place[1]))  # as low as the key before
    drag(viewer, on_screen(viewer, *last.place), (0, 8))
    move(viewer, 0, 12)
    pose = viewer.session.script.poses[1]
    start, end = map(float, pose.easing.split(","))
    assert start == 0.0 < end < 3.0 and pose.values == before.poses[1].values
    again = parse_script(script_text(viewer.session.script), source="again")
    assert again.at(0.4) == viewer.session.script.at(0.4) != before.at(0.4)
    viewer.session.seek(0.4)
    assert viewer.session.values["joy"] == pytest.approx(again.at(0.4)["joy"])
    xdotool(viewer, "key", "ctrl+z")
    xdotool(viewer, "key", "ctrl+z")
    assert viewer.session.script == before
    drag(viewer, on_screen(viewer, *last.place), (0, 8))
    assert viewer.session.script != before
    xdotool(viewer, "key", "Escape")
    xdotool(viewer, "mouseup", 1)
    assert viewer.session.script == before
