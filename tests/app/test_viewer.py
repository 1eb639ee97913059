"""The real window, driven by real mouse and key events."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.viewer import Viewer  # before render: see app/gui.py

import render  # isort: skip
from app.choices import script_for  # isort: skip

pytestmark = [
    pytest.mark.window,
    pytest.mark.skipif(
        not os.environ.get("DISPLAY") or shutil.which("xdotool") is None,
        reason="needs a display and xdotool; `make test` brings both",
    ),
]


@pytest.fixture(scope="module")
def viewer() -> Iterator[Viewer]:
    """One window for all tests of this file."""
    script = replace(script_for(None, "face"), duration=0.5)
    with Viewer(script, (900, 600), "kahler", render.Style()) as opened:
        settle(opened)
        yield opened


@pytest.fixture(autouse=True)
def calm(viewer: Viewer) -> None:
    """Each test starts from the neutral face with refinement on."""
    viewer.neutral()
    viewer.scene.reset()
    viewer.is_refined, viewer.style = True, render.Style()
    viewer.camera = viewer._framed()
    viewer.script_time = 0.0
    settle(viewer)


def settle(viewer: Viewer, frames: int = 6) -> None:
    """Let the window run for a few frames."""
    for _ in range(frames):
        viewer.frame()


def xdotool(viewer: Viewer, *words: object) -> None:
    """Send real events and let the window take them in."""
    subprocess.run(["xdotool", *map(str, words)], check=True, capture_output=True)
    settle(viewer)


def until(viewer: Viewer, condition: Callable[[], bool], frames: int = 240) -> bool:
    """Run until something has come true, or too long."""
    for _ in range(frames):
        if condition():
            return True
        viewer.frame()
    return False


def middle(viewer: Viewer, name: str) -> tuple[int, int]:
    """Where an item of the panel is, on the screen."""
    import glfw

    left, top, right, bottom = viewer.panel.places[name]
    x, y = glfw.get_window_pos(viewer.surface.handle)
    return round(x + (left + right) / 2), round(y + (top + bottom) / 2)


def click(viewer: Viewer, name: str) -> None:
    """Click in the middle of an item."""
    xdotool(viewer, "mousemove", *middle(viewer, name))
    xdotool(viewer, "mousedown", 1)
    xdotool(viewer, "mouseup", 1)


def moved(viewer: Viewer) -> float:
    """How far the farthest vertex is from rest [mm]."""
    return float(np.abs(viewer.scene.positions - viewer.scene.rest_positions).max())


def test_a_slider_moves_the_skin(viewer: Viewer) -> None:
    """Open the jaw's group, drag its slider: the vertices move."""
    title = next(title for title, names in viewer.scene.groups.items() if "jaw_open" in names)
    click(viewer, title)
    assert until(viewer, lambda: "jaw_open" in viewer.panel.places, 30)
    settle(viewer)
    xdotool(viewer, "mousemove", *middle(viewer, "jaw_open"))
    xdotool(viewer, "mousedown", 1)
    xdotool(viewer, "mousemove_relative", 60, 0)
    xdotool(viewer, "mouseup", 1)
    assert viewer.controls["jaw_open"] > 0.4
    assert until(viewer, lambda: moved(viewer) > 8.0)
    click(viewer, title)


def test_keys_show_expressions(viewer: Viewer) -> None:
    """1 shows the first expression, 1 again is neutral; refined triangles come and go."""
    xdotool(viewer, "key", "1")
    first = next(iter(viewer.scene.expressions))
    assert viewer.expression == first
    assert until(viewer, lambda: moved(viewer) > 3.0)
    assert until(viewer, lambda: viewer.picture.triangle_count > 2100)
    xdotool(viewer, "key", "r")
    assert viewer.picture.triangle_count == len(viewer.scene.faces)
    xdotool(viewer, "key", "r")
    assert viewer.picture.triangle_count > 2100
    xdotool(viewer, "key", "1")
    assert until(viewer, lambda: moved(viewer) < 0.5)


def test_keys_change_the_picture(viewer: Viewer) -> None:
    """W, C, T and S each change what is seen, and back."""
    viewer.toggle_expression("disgust")
    viewer.scene.pose(viewer.controls)
    viewer.scene.step(3.0)
    settle(viewer)
    before = viewer.surface.read()
    for key, times in (("w", 2), ("c", 2), ("t", 2), ("s", 3)):
        xdotool(viewer, "key", key)
        changed = viewer.surface.read()[:, 340:].astype(int) - before[:, 340:]
        assert np.abs(changed).max() > 20, key
        for _ in range(times - 1):
            xdotool(viewer, "key", key)
        back = viewer.surface.read()[:, 340:].astype(int) - before[:, 340:]
        assert np.abs(back).mean() < 0.5, key


def test_the_mouse_orbits_and_the_wheel_zooms(viewer: Viewer) -> None:
    """Dragging in the picture turns the camera; the wheel moves it; F frames again."""
    import glfw

    view = viewer.camera.view_matrix().copy()
    x, y = glfw.get_window_pos(viewer.surface.handle)
    xdotool(viewer, "mousemove", x + 600, y + 300)
    xdotool(viewer, "mousedown", 1)
    xdotool(viewer, "mousemove_relative", 80, 20)
    xdotool(viewer, "mouseup", 1)
    turned = viewer.camera.view_matrix().copy()
    assert np.abs(turned - view).max() > 0.1
    xdotool(viewer, "click", 4)
    assert np.abs(viewer.camera.view_matrix() - turned).max() > 1e-3
    xdotool(viewer, "key", "f")
    assert np.allclose(viewer.camera.view_matrix(), view)


def test_dragging_on_the_panel_does_not_orbit(viewer: Viewer) -> None:
    """The panel keeps the mouse to itself."""
    view = viewer.camera.view_matrix().copy()
    xdotool(viewer, "mousemove", *middle(viewer, "time"))
    xdotool(viewer, "mousedown", 1)
    xdotool(viewer, "mousemove_relative", 30, 0)
    xdotool(viewer, "mouseup", 1)
    assert np.array_equal(viewer.camera.view_matrix(), view)
    assert viewer.script_time > 0.2


def test_space_plays_the_script_to_its_end(viewer: Viewer) -> None:
    """Space starts the script; it stops by itself at the end, the face posed by it."""
    xdotool(viewer, "key", "space")
    assert until(viewer, lambda: viewer.script_time > 0.0)
    assert until(viewer, lambda: not viewer.is_playing, 600)
    assert viewer.script_time == viewer.script.duration


def test_a_stalled_window_goes_on_calmly(viewer: Viewer) -> None:
    """Ten seconds of standstill are not caught up at once: nothing explodes."""
    xdotool(viewer, "key", "2")
    viewer._last -= 10.0
    viewer.frame()
    assert np.isfinite(viewer.scene.positions).all()
    assert moved(viewer) < 60.0


def test_buttons_of_the_panel(viewer: Viewer) -> None:
    """An expression's button and the neutral button do what their keys do."""
    name = list(viewer.scene.expressions)[2]
    click(viewer, name)
    assert viewer.expression == name
    click(viewer, "Neutral (N)")
    assert viewer.expression is None
    assert not any(viewer.controls.values())


def test_replay_plays_a_script_and_ends(tmp_path: Path) -> None:
    """`risorius replay --once` shows a script in real time in a window of its own."""
    path = tmp_path / "short.toml"
    path.write_text("[[pose]]\ntime = 0.0\n[[pose]]\ntime = 0.6\njoy = 1.0\n")
    command = [sys.executable, "-m", "app", "replay", str(path), "--once", "--size", "500x400"]
    start = time.monotonic()
    result = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert result.returncode == 0, result.stderr
    assert result.stderr == ""
    assert time.monotonic() - start > 0.6


def test_checkboxes_do_what_their_keys_do(viewer: Viewer) -> None:
    """A click on each checkbox switches it, a second one switches it back."""
    for label in ("Refine (R)", "Wireframe (W)", "Splits (C)", "Texture (T)"):
        before = (viewer.is_refined, viewer.style)
        click(viewer, label)
        assert (viewer.is_refined, viewer.style) != before, label
        click(viewer, label)
        assert (viewer.is_refined, viewer.style) == before, label
