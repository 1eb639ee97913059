"""The face lives in the window while nobody moves it; what a user or a script moves is theirs."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from risorius.app.motion.life import LID
from risorius.app.viewer import Viewer
from risorius.app.viewer.session.physics import ASLEEP_AFTER, STEP

from .driving import (
    NEEDS_A_SCREEN,
    clear_search,
    drag,
    middle,
    moved,
    settle,
    show_controls,
    until,
    xdotool,
)

pytestmark = [*NEEDS_A_SCREEN, pytest.mark.usefixtures("alive")]


@pytest.fixture
def alive(viewer: Viewer, calm: None) -> Iterator[None]:
    """Life is switched on for one test."""
    viewer.settings.is_alive = True
    viewer.life.note_input()
    yield
    viewer.settings.is_alive = False


def lids(viewer: Viewer) -> float:
    """How far the lids' muscle is asked to shut the left eye."""
    return viewer.session.scene.values[f"{LID}_left"]


def drawn_lids(viewer: Viewer, frames: int = 900) -> float:
    """The most of it in so many steps of the simulation."""
    most = 0.0
    for _ in range(frames):
        viewer.session.advance(STEP, viewer.life.after(STEP, is_held=False))
        most = max(most, lids(viewer))
    return most


def test_it_looks_at_the_viewer_and_nothing_is_changed(viewer: Viewer) -> None:
    """The eyes turn to the camera; sliders, undo and what is unsaved stay as they were."""
    assert until(viewer, lambda: viewer.session.scene.values["gaze_horizontal_left"] != 0.0)
    assert until(viewer, lambda: moved(viewer) > 0.5)
    settle(viewer)
    assert not any(viewer.session.values.values())
    assert not viewer.session.unsaved and not viewer.session.can_undo
    eye = viewer.view.camera.eye
    motion = viewer.session.scene.bone_transforms()["eye_left"][:3, :3]
    assert (motion @ [0.0, 0.0, 1.0]) @ (eye / np.linalg.norm(eye)) > 0.97


def test_a_key_switches_it_off_and_on(viewer: Viewer) -> None:
    """A lets the face come to rest, so that the window sleeps; A again wakes it."""
    assert until(viewer, lambda: moved(viewer) > 0.1)
    xdotool(viewer, "key", "a")
    assert not viewer.settings.is_alive
    assert until(viewer, lambda: viewer.is_idle)
    assert moved(viewer) < 0.05
    xdotool(viewer, "key", "a")
    assert viewer.settings.is_alive and not viewer.is_idle
    assert until(viewer, lambda: moved(viewer) > 0.1)


@pytest.mark.slow
def test_what_is_set_by_hand_stays(viewer: Viewer) -> None:
    """Eyes that the user turned stay turned, and blink; a lid that he lowered stays."""
    viewer.session.set("gaze_horizontal", 0.5)
    assert drawn_lids(viewer) == 1.0
    values = viewer.session.scene.values
    assert values["gaze_horizontal"] == 0.5 and values["gaze_vertical_left"] == 0.0
    viewer.session.set(f"{LID}_right", 0.3)
    assert drawn_lids(viewer) == 0.0
    assert viewer.session.scene.values[f"{LID}_right"] == 0.3


@pytest.mark.slow
def test_a_face_that_somebody_holds_does_not_twitch(viewer: Viewer) -> None:
    """While a slider is dragged the face looks at the user, and that is all."""
    show_controls(viewer, "jaw open")
    drag(viewer, middle(viewer, "jaw_open"), (40, 0))
    try:
        settle(viewer)
        active = {name for name, value in viewer.session.scene.values.items() if value}
    finally:
        xdotool(viewer, "mouseup", 1)
        clear_search(viewer)
    assert "jaw_open" in active
    assert all(name.startswith(("jaw_open", "gaze", "head")) for name in active), active


def test_a_script_moves_the_face_alone(viewer: Viewer) -> None:
    """While it plays, and where it is stopped; at its end the face is left to its life."""
    session = viewer.session
    session.toggle_playing()
    assert not viewer.life.is_on
    session.advance(0.1)
    session.toggle_playing()
    assert session.is_following and not viewer.life.is_on
    session.seek(session.script.duration)
    assert viewer.life.is_on


def test_a_recording_has_only_what_the_user_did(viewer: Viewer) -> None:
    """Life rests while something is recorded, and no track is of it."""
    session = viewer.session
    assert until(viewer, lambda: moved(viewer) > 0.1)
    before = session.script.tracks
    session.toggle_recording()
    assert not viewer.life.is_on
    session.set("jaw_open", 0.5)
    settle(viewer)
    session.toggle_recording()
    after = session.script.tracks
    assert {name for name in after if after[name] is not before.get(name)} == {"jaw_open"}


def test_it_sleeps_when_nobody_is_there(viewer: Viewer) -> None:
    """After some minutes without input the window rests; a key wakes the face."""
    viewer.life.after(ASLEEP_AFTER, is_held=False)
    assert not viewer.life.is_on
    assert until(viewer, lambda: viewer.is_idle)
    xdotool(viewer, "key", "Shift_L")
    assert viewer.life.is_on
