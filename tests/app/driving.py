"""Control of the viewer's window from outside, with real mouse and key events."""

import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from unittest import mock

import numpy as np
import pytest
from imgui_bundle import imgui

from risorius.app.script.key_sets import KeyId
from risorius.app.viewer import Viewer
from risorius.app.viewer.session.physics import STEP_TIME
from risorius.app.viewer.session.session import Session

import glfw  # isort: skip - after imgui_bundle, which the viewer imports

NEEDS_A_SCREEN = [
    pytest.mark.window,
    pytest.mark.skipif(
        not os.environ.get("DISPLAY") or shutil.which("xdotool") is None,
        reason="needs a display and xdotool; `make test` brings both",
    ),
]
HELLO_FILE = Path(__file__).parents[2] / "docs" / "hello.toml"
SIZE = (760, 520)  # size of the window that tests share
DEADLINE = 60.0  # [s] limit for an answer that an idle machine gives at once
LEAST_FRAMES = 10  # frames shown before a deadline counts: one that loads a head may last longer
NAP = 0.05  # [s] between frames while another process or thread works, which gets the core
STEADY_FRAMES = 3  # equal frames, after which no panel moves


def settle(viewer: Viewer) -> None:
    """Draw until the window has handled all events, and panels show all set values.

    When xdotool ends, the X server has processed its events: a query to the server returns all of
    them, in order, before the answer. A panel is laid out with sizes of the previous frame.
    """
    shown: list[object] = []
    glfw.get_window_pos(viewer.surface.handle)

    def is_steady() -> bool:
        if viewer.file_drop.is_making:
            time.sleep(NAP)
            return False
        shown.append((dict(viewer.gui.places), imgui.get_io().want_text_input))
        return shown[-STEADY_FRAMES:] == STEADY_FRAMES * shown[-1:]

    # While a face moves, panels may show older values.
    with mock.patch.object(viewer, "refresh", 0.0):
        assert until(viewer, is_steady), shown[-2:]


def replace_state(part: object, fresh: object) -> None:
    """Reset a part of the window to the state of a new one, keeping all references to it."""
    vars(part).clear()
    vars(part).update(vars(fresh))


def xdotool(viewer: Viewer, *words: object) -> None:
    """Send real events with xdotool, and let the window handle them."""
    subprocess.run(["xdotool", *map(str, words)], check=True, capture_output=True)
    settle(viewer)


def press_keys(viewer: Viewer, *keys: str) -> None:
    """Press keys one after another, and let the window handle them."""
    xdotool(viewer, "key", *keys)


def until(
    viewer: Viewer,
    condition: Callable[[], object],
    seconds: float = DEADLINE,
    *,
    nap: float = 0.0,
) -> bool:
    """Show at least one frame until a condition is true; return whether it was in time.

    nap: pause after each frame [s].
    """
    end = time.monotonic() + seconds
    shown = 0
    while shown < LEAST_FRAMES or time.monotonic() < end:
        viewer.frame()
        time.sleep(nap)
        shown += 1
        if condition():
            return True
    return False


def run(session: Session, steps: int) -> None:
    """Simulate this number of time steps, without a window."""
    for _ in range(steps):
        session.advance(STEP_TIME)


def set_by_hand(session: Session, **values: float) -> None:
    """Move sliders as a user does, and release them."""
    for name, value in values.items():
        session.set(name, value)
    session.note()


def wait_for(condition: Callable[[], object], seconds: float = DEADLINE) -> None:
    """Wait for a condition on another process; AssertionError after too long."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.02)


def on_screen(viewer: Viewer, x: float, y: float) -> tuple[int, int]:
    """Screen coordinates of a place in the window."""
    left, top = glfw.get_window_pos(viewer.surface.handle)
    return round(left + x), round(top + y)


def middle(viewer: Viewer, name: str) -> tuple[int, int]:
    """Screen coordinates of the middle of a panel's item."""
    assert until(viewer, lambda: name in viewer.gui.places), name
    left, top, right, bottom = viewer.gui.places[name]
    return on_screen(viewer, 0.5 * (left + right), 0.5 * (top + bottom))


def click(viewer: Viewer, name: str, *, times: int = 1) -> None:
    """Click in the middle of an item."""
    repeated = ("--repeat", times, "--delay", 50) if times > 1 else ()
    xdotool(viewer, "mousemove", *middle(viewer, name), "click", *repeated, 1)


def drag(viewer: Viewer, place: tuple[int, int], by: tuple[int, int], *, button: int = 1) -> None:
    """Press, move, and keep the button down."""
    xdotool(viewer, "mousemove", *place, "mousedown", button)
    xdotool(viewer, "mousemove_relative", "--", *by)


def drag_and_release(
    viewer: Viewer, place: tuple[int, int], by: tuple[int, int], *, button: int = 1
) -> None:
    """Press, move and release at the end."""
    drag(viewer, place, by, button=button)
    xdotool(viewer, "mouseup", button)


def write(viewer: Viewer, text: str) -> None:
    """Type into the line with the keyboard focus."""
    xdotool(viewer, "type", text)


def show_controls(viewer: Viewer, words: str) -> None:
    """Type words into the search line."""
    click(viewer, "search")
    write(viewer, words)


def clear_search(viewer: Viewer) -> None:
    """Empty the search line."""
    click(viewer, "search")
    press_keys(viewer, "ctrl+a", "BackSpace", "Return")


def moved(viewer: Viewer) -> float:
    """The largest change of a vertex's coordinate since rest [mm]."""
    scene = viewer.session.scene
    return float(np.abs(scene.positions - scene.rest_positions).max())


def nose(viewer: Viewer) -> tuple[int, int]:
    """Screen coordinates of the tip of the nose."""
    positions = viewer.session.scene.positions
    return seen_at(viewer, positions[positions[:, 2].argmax()])


def seen_at(viewer: Viewer, point: np.ndarray) -> tuple[int, int]:
    """Screen coordinates of a point of the scene."""
    left, top, width, height = viewer.face.view.area
    camera = viewer.face.view.camera
    matrix = np.asarray(camera.view_matrix() @ camera.projection_matrix(width / height))
    clip = np.append(point, 1.0) @ matrix
    x, y = clip[:2] / clip[3]  # -1 to 1, to the right and up
    across = 0.5 + 0.5 * x
    down = 0.5 - 0.5 * y
    return on_screen(viewer, left + width * across, top + height * down)


def drop(viewer: Viewer, *paths: Path) -> None:
    """Drop files onto the face from another program, and wait until the window has them."""
    command = [sys.executable, "-m", "tests.app.dropping", "Risorius", *map(str, nose(viewer))]
    source = subprocess.Popen(
        [*command, *map(str, paths)], stderr=subprocess.PIPE, text=True,
        cwd=Path(__file__).parents[2],
    )  # fmt: skip
    assert until(viewer, lambda: source.poll() is not None)
    assert source.returncode == 0, source.communicate()[1]
    settle(viewer)


def put(viewer: Viewer, *paths: Path) -> None:
    """Drop files by a call, without another program."""
    viewer.drop([str(path) for path in paths])
    settle(viewer)


def where_key(viewer: Viewer, key: KeyId) -> tuple[float, float]:
    """Place of a key in the first row that has keys [window units]."""
    row = next(row for row in viewer.face.timeline.dope_sheet.rows if key in row.keys)
    _, top, _, bottom = viewer.gui.places[f"row {row.name}"]
    return viewer.face.time_axis.x(key.time), 0.5 * (top + bottom)


def key_at(viewer: Viewer, key: KeyId) -> tuple[int, int]:
    """Screen coordinates of such a key."""
    return on_screen(viewer, *where_key(viewer, key))


def press(viewer: Viewer, place: tuple[int, int], *keys: str, button: int = 1) -> None:
    """Click at a place with keys held down, never as the second half of a double click."""
    usual, viewer.gui.double_click_time = viewer.gui.double_click_time, 0.0
    held = [word for key in keys for word in ("keydown", key)]
    xdotool(viewer, "mousemove", *place, *held)
    xdotool(viewer, "mousedown", button)
    xdotool(viewer, "mouseup", button, *(word for key in keys for word in ("keyup", key)))
    viewer.gui.double_click_time = usual


def pose_times(viewer: Viewer) -> list[float]:
    """Times of the script's poses [s]."""
    return [pose.time for pose in viewer.session.script.poses]
