"""Driving the viewer's window from outside, with real mouse and key events."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from risorius.app.viewer import Viewer
from risorius.app.viewer.window import FRAMES_AFTER_EVENT

NEEDS_A_SCREEN = [
    pytest.mark.window,
    pytest.mark.skipif(
        not os.environ.get("DISPLAY") or shutil.which("xdotool") is None,
        reason="needs a display and xdotool; `make test` brings both",
    ),
]
DELIVERY = 0.02  # [s] that the screen may take to hand on what xdotool sent before it ended
SIZE = (900, 600)  # of the window that tests share


def draw_frames(viewer: Viewer, frames: int = FRAMES_AFTER_EVENT) -> None:
    """Let the window run for a few frames."""
    for _ in range(frames):
        viewer.frame()


def replace_state(part: object, fresh: object) -> None:
    """Make a part of the window, which others hold on to, like a fresh one of its kind."""
    vars(part).clear()
    vars(part).update(vars(fresh))


def xdotool(viewer: Viewer, *words: object) -> None:
    """Send real events and let the window take them in."""
    subprocess.run(["xdotool", *map(str, words)], check=True, capture_output=True)
    time.sleep(DELIVERY)
    draw_frames(viewer)


def until(viewer: Viewer, condition: Callable[[], bool], seconds: float = 10.0) -> bool:
    """Run until something has come true, or too long."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        viewer.frame()
    return False


def on_screen(viewer: Viewer, x: float, y: float) -> tuple[int, int]:
    """A place of the window, on the screen."""
    import glfw

    left, top = glfw.get_window_pos(viewer.surface.handle)
    return round(left + x), round(top + y)


def middle(viewer: Viewer, name: str) -> tuple[int, int]:
    """Where an item of a panel is, on the screen."""
    assert until(viewer, lambda: name in viewer.gui.places, 3.0), name
    left, top, right, bottom = viewer.gui.places[name]
    return on_screen(viewer, 0.5 * (left + right), 0.5 * (top + bottom))


def click(viewer: Viewer, name: str, *, times: int = 1) -> None:
    """Click in the middle of an item."""
    repeated = ("--repeat", times, "--delay", 50) if times > 1 else ()
    xdotool(viewer, "mousemove", *middle(viewer, name), "click", *repeated, 1)


def drag(viewer: Viewer, place: tuple[int, int], by: tuple[int, int], *, button: int = 1) -> None:
    """Press, move and stay pressed."""
    xdotool(viewer, "mousemove", *place)
    xdotool(viewer, "mousedown", button)
    xdotool(viewer, "mousemove_relative", "--", *by)


def write(viewer: Viewer, text: str) -> None:
    """Type into the line that has the focus; the window takes in about a key in two frames."""
    xdotool(viewer, "type", text)
    draw_frames(viewer, 2 * len(text))


def show_controls(viewer: Viewer, words: str) -> None:
    """Type into the search line."""
    click(viewer, "search")
    write(viewer, words)


def clear_search(viewer: Viewer) -> None:
    """Empty the search line."""
    click(viewer, "search")
    xdotool(viewer, "key", "ctrl+a", "BackSpace", "Return")


def moved(viewer: Viewer) -> float:
    """How far the farthest vertex is from rest [mm]."""
    return float(np.abs(viewer.session.scene.positions - viewer.session.scene.rest_positions).max())


def nose(viewer: Viewer) -> tuple[int, int]:
    """The tip of the nose, on the screen."""
    tip = viewer.session.scene.positions[viewer.session.scene.positions[:, 2].argmax()]
    left, top, width, height = viewer.view.area
    camera = viewer.view.camera
    matrix = np.asarray(camera.view_matrix() @ camera.projection_matrix(width / height))
    clip = np.append(tip, 1.0) @ matrix
    x, y = clip[:2] / clip[3]
    return on_screen(viewer, left + width * (0.5 + 0.5 * x), top + height * (0.5 - 0.5 * y))


def drop(viewer: Viewer, *paths: Path) -> None:
    """Let another program drop files onto the face; the window must have taken them."""
    command = [sys.executable, "-m", "tests.app.dropping", "Risorius", *map(str, nose(viewer))]
    source = subprocess.Popen(
        [*command, *map(str, paths)], stderr=subprocess.PIPE, text=True,
        cwd=Path(__file__).parents[2],
    )  # fmt: skip
    assert until(viewer, lambda: source.poll() is not None, 60.0)
    assert source.returncode == 0, source.communicate()[1]
    draw_frames(viewer)
