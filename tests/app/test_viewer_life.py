"""The face moves without input in the window, until a user or a script controls it."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from risorius.app.script import Channel
from risorius.app.viewer import Viewer
from risorius.app.viewer.picture.stage import COARSEST_IDLE_LEVEL, DETAIL_LEVELS
from risorius.app.viewer.session.physics import SLEEP_DELAY
from risorius.app.viewer.window.schedule import Schedule

from .driving import NAP, NEEDS_A_SCREEN, SIZE, moved, on_screen, press_keys, settle, until, xdotool

pytestmark = [*NEEDS_A_SCREEN, pytest.mark.usefixtures("alive")]


@pytest.fixture
def alive(viewer: Viewer, calm: None) -> Iterator[None]:
    """Switch life on for one test."""
    viewer.settings.is_alive = True
    viewer.face.life.note_input()
    yield
    viewer.settings.is_alive = False


def test_it_looks_at_the_viewer_and_nothing_is_changed(viewer):
    """The eyes turn to the camera; sliders, undo and unsaved work are unchanged."""
    session = viewer.session
    assert until(viewer, lambda: session.scene.values["gaze_horizontal_left"] != 0.0)
    assert until(viewer, lambda: moved(viewer) > 0.5)
    settle(viewer)
    assert not any(session.values.values())
    assert not session.work.unsaved
    assert not session.can_undo
    eye = viewer.face.view.camera.eye
    motion = session.scene.bone_transforms()["eye_left"][:3, :3]
    assert (motion @ [0.0, 0.0, 1.0]) @ (eye / np.linalg.norm(eye)) > 0.97


def test_a_key_switches_it_off_and_on(viewer):
    """The key A stops the face, so that the window can sleep; pressed again, it wakes the face."""
    assert until(viewer, lambda: moved(viewer) > 0.1)
    press_keys(viewer, "a")
    assert not viewer.settings.is_alive
    assert until(viewer, lambda: viewer.schedule.is_idle)
    assert moved(viewer) < 0.05
    press_keys(viewer, "a")
    assert viewer.settings.is_alive
    assert not viewer.schedule.is_idle
    assert until(viewer, lambda: moved(viewer) > 0.1)


def test_only_a_script_that_is_alive_has_life_while_it_plays(viewer):
    """A script with `alive = true` has idle life in controls that it never names."""
    session = viewer.session
    track = {"jaw_open": Channel([0.0, 9.0], [0.3, 0.3])}
    for is_alive in (False, True):
        session.script = replace(session.script, duration=9.0, tracks=track, alive=is_alive)
        session.seek(0.0)
        session.toggle_playing()
        assert until(viewer, lambda: session.time > 0.5)
        assert viewer.face.life.is_on == is_alive
        assert (session.scene.values["head_pitch"] != 0.0) == is_alive
        assert session.scene.values["jaw_open"] == pytest.approx(0.3)
        session.toggle_playing()


def test_it_sleeps_without_input(viewer):
    """After some minutes without input the window sleeps; a key wakes the face."""
    viewer.face.life.after(SLEEP_DELAY, is_held=False)
    assert not viewer.face.life.is_on
    assert until(viewer, lambda: viewer.schedule.is_idle)
    press_keys(viewer, "Shift_L")
    assert viewer.face.life.is_on


def test_slow_frames_lower_the_detail_of_idle_life(viewer, monkeypatch):
    """Idle life has fewer pixels where frames are slow, and more after they are fast again.

    It had all pixels, so that a face blinked at three frames a second beside other programs.
    """
    coarse = DETAIL_LEVELS[COARSEST_IDLE_LEVEL]
    assert until(viewer, lambda: viewer.schedule.is_idling)
    with monkeypatch.context() as patch:
        patch.setattr(Schedule, "spent", 0.2)
        assert until(viewer, lambda: viewer.surface.detail == coarse, nap=NAP)
        assert viewer.schedule.is_idling
    monkeypatch.setattr(Schedule, "spent", 0.01)
    assert until(viewer, lambda: viewer.surface.detail != coarse, nap=NAP)


def test_slow_frames_seldom_draw_panels(viewer, monkeypatch):
    """While a script plays in frames of 0.1 s, a third of them draws the panels."""
    drawn = []
    panels = Viewer._draw_gui

    def draw(self, *, is_visible):
        """Note whether the panels are drawn."""
        drawn.append(is_visible)
        panels(self, is_visible=is_visible)

    press_keys(viewer, "1")
    assert until(viewer, lambda: not viewer.schedule.is_awake)
    monkeypatch.setattr(Schedule, "begin_frame", lambda schedule: 0.1)
    monkeypatch.setattr(Viewer, "_draw_gui", draw)
    viewer.session.toggle_playing()
    viewer.session.is_looping = True
    frame_count = 12
    for _ in range(frame_count):
        viewer.frame()
    viewer.session.toggle_playing()
    assert 3 <= drawn.count(True) <= 5


def test_panels_lie_beside_the_picture_of_a_smaller_window(viewer):
    """After a window gets smaller without input, panels do not cover an old picture.

    They were drawn over the old picture.
    """
    import glfw

    handle = viewer.surface.handle
    xdotool(viewer, "mousemove", *on_screen(viewer, 450, 200))  # it neither leaves nor enters
    assert until(viewer, lambda: viewer.schedule.is_idling)
    try:
        glfw.set_window_size(handle, 600, 420)
        assert until(viewer, lambda: viewer.surface.size == (600, 420))
        assert until(viewer, lambda: viewer.schedule.is_idling)
        left = int(viewer.face.view.area[0])
        seen = viewer.surface.read()[:, :left].astype(int)
        settle(viewer)
        assert np.abs(seen - viewer.surface.read()[:, :left]).max() < 8
    finally:
        glfw.set_window_size(handle, *SIZE)
        settle(viewer)
