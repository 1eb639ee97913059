"""Clicks, keys and words as they come to a window that draws slowly: each does what it is for."""

from __future__ import annotations

import subprocess
import time
from pathlib import Path

import pytest
from imgui_bundle import imgui

from risorius.app.script import load_script
from risorius.app.viewer import Viewer
from risorius.app.viewer.keyframes import POSES
from risorius.app.viewer.places import KeyPlace

from .driving import (
    NEEDS_A_SCREEN,
    clear_search,
    draw_frames,
    middle,
    on_screen,
    show_controls,
    until,
    xdotool,
)

pytestmark = [*NEEDS_A_SCREEN, pytest.mark.usefixtures("calm")]

SLOW = 0.15  # [s] beside what it takes to draw a frame


def slowly(viewer: Viewer, *words: object, frames: int = 3) -> None:
    """Send real events while the window draws a few frames a second, and some frames more."""
    events = subprocess.Popen(["xdotool", *map(str, words)])
    while events.poll() is None:
        viewer.frame()
        time.sleep(SLOW)
    assert events.returncode == 0
    for _ in range(frames):
        viewer.frame()
        time.sleep(SLOW)


def typed(words: object) -> tuple[object, ...]:
    """Events of words that are written at once, and entered."""
    return "type", "--delay", 2, "--args", 1, words, "key", "Return"


def test_a_number_is_typed_into_a_slow_window(viewer: Viewer) -> None:
    """A double click and the number after it go to the slider, and to nothing else."""
    show_controls(viewer, "jaw open")
    xdotool(viewer, "mousemove", *middle(viewer, "jaw_open"))
    for number, delay in ((0.3, 100), (0.85, 220)):
        click = ("click", "--repeat", 2, "--delay", delay, 1)
        slowly(viewer, *click, *typed(number))
        assert until(viewer, lambda: viewer.session.values["jaw_open"] == number, 2.0), number  # noqa: B023
        assert [name for name, value in viewer.session.values.items() if value] == ["jaw_open"]
    slowly(viewer, "click", 1, "sleep", 0.9, "click", 1)
    assert not imgui.get_io().want_text_input  # two clicks, no double click
    clear_search(viewer)


def test_a_pose_is_named_in_a_slow_window(viewer: Viewer) -> None:
    """Words typed right after the double click are the name; none of them is a shortcut."""
    viewer.session.open(load_script(Path(__file__).parents[2] / "docs" / "hello.toml"))
    draw_frames(viewer)
    place = on_screen(viewer, *viewer.timeline.dope_sheet.where(KeyPlace(POSES, 1.0)))
    xdotool(viewer, "mousemove", *place)
    click = ("click", "--repeat", 2, "--delay", 100, 1)
    slowly(viewer, *click, *typed("big smile"))
    names = [pose.name for pose in viewer.session.script.poses]
    assert "big smile" in names
    assert not viewer.session.is_playing and not viewer.session.has_unsaved_pose


def test_chords_keep_their_modifier(viewer: Viewer) -> None:
    """Ctrl let go with the key, in one frame with it, counts as held."""
    for _ in range(6):
        viewer.session.toggle_alone("joy")
        slowly(viewer, "key", "--delay", 2, "ctrl+z", frames=1)
        assert not viewer.session.is_alone("joy")
        viewer.session.neutral()


def test_tabs_are_clicked_while_a_script_plays(viewer: Viewer) -> None:
    """Mouse there, and pressed at once: the tab comes up, in each of many times."""
    tabs = {title: middle(viewer, f"tab {title}") for title in ("Mechanism", "Live", "Face")}
    viewer.session.is_looping = True
    viewer.session.toggle_playing()
    for title in (*tabs, *tabs):
        slowly(viewer, "mousemove", *tabs[title], "click", 1)
        assert viewer.settings.tab == title
