"""The window among others: what is seen first, hidden panels, minimised, the first size."""

import contextlib
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import glfw
import numpy as np
import pytest
from Xlib import X, display
from Xlib.error import XError
from Xlib.protocol import event

from risorius.app.viewer import Viewer
from risorius.app.viewer.interface.gui import THEMES
from risorius.app.viewer.window.splash_screen import COMPILING, FIRST_SIZE, LOADING, picture

from .driving import (
    DEADLINE,
    NEEDS_A_SCREEN,
)

pytestmark = NEEDS_A_SCREEN


ROOT = Path(__file__).parents[2]


def screen_size() -> tuple[int, int]:
    """Of the whole screen."""
    screen = display.Display().screen()
    return screen.width_in_pixels, screen.height_in_pixels


@pytest.mark.usefixtures("calm")
def test_a_minimised_window_draws_nothing(viewer: Viewer, monkeypatch: pytest.MonkeyPatch) -> None:
    """As long as the desktop hides it, though it plays; then it goes on."""
    ask, hidden, drawn = glfw.get_window_attrib, [True, True, True], []

    def attribute(window: Any, name: int) -> int:
        return bool(hidden and hidden.pop()) if name == glfw.ICONIFIED else ask(window, name)

    def frame() -> None:
        drawn.append(len(hidden))
        viewer.session.is_playing = False

    monkeypatch.setattr(glfw, "get_window_attrib", attribute)
    monkeypatch.setattr(viewer, "frame", frame)
    viewer.run(playing=True, once=True)
    assert drawn == [0]


@pytest.mark.slow
def test_the_first_size_suits_the_screen(tmp_path: Path) -> None:
    """Without a size the window is no larger than the screen; on a dense one it grows with it."""
    for dots, wanted in ((96, FIRST_SIZE), (192, (2 * FIRST_SIZE[0], 2 * FIRST_SIZE[1]))):
        result = subprocess.run(
            [sys.executable, "-m", "tests.app.dense_window", "first", str(dots)],
            capture_output=True, text=True, timeout=120, check=False, cwd=ROOT,
        )  # fmt: skip
        assert result.returncode == 0, result.stderr
        found = json.loads(result.stdout)
        width, height = screen_size()
        least = min(wanted[0], width - 20), min(wanted[1], height - 120)  # frames take some
        assert least[0] <= found["window"][0] <= min(wanted[0], width), dots
        assert least[1] <= found["window"][1] <= min(wanted[1], height), dots
        assert found["panel"] == pytest.approx(22.5 * 15 * dots / 96, abs=3), dots


def ask_to_close(window: int) -> None:
    """What a click on the cross above the window sends it."""
    screen = display.Display()
    target = screen.create_resource_object("window", window)
    words = [screen.intern_atom("WM_DELETE_WINDOW"), X.CurrentTime, 0, 0, 0]
    kind = screen.intern_atom("WM_PROTOCOLS")
    target.send_event(event.ClientMessage(window=target, client_type=kind, data=(32, words)))
    screen.sync()


def windows_of(process: subprocess.Popen[bytes], screen: display.Display) -> Iterator[Any]:
    """Those on the screen that a process has opened."""
    number = screen.get_atom("_NET_WM_PID")
    for window in screen.screen().root.query_tree().children:
        with contextlib.suppress(XError):  # it is not there any more
            told = window.get_full_property(number, X.AnyPropertyType)
            if told is not None and told.value[0] == process.pid:
                yield window


def first_pictures(process: subprocess.Popen[bytes]) -> Iterator[np.ndarray]:
    """What the window of a process that starts shows, again and again, (H, W, 3)."""
    screen = display.Display()
    while process.poll() is None:
        for window in windows_of(process, screen):
            with contextlib.suppress(XError):  # it is not shown yet
                size = window.get_geometry()
                read = window.get_image(0, 0, size.width, size.height, X.ZPixmap, 0xFFFFFFFF)
                pixels = np.frombuffer(read.data, np.uint8).reshape(size.height, size.width, 4)
                yield pixels[..., 2::-1].astype(int)
        time.sleep(0.02)


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Callable[[], subprocess.Popen[bytes]]]:
    """Start `risorius view` as on a machine where nothing is compiled yet."""
    begun = []
    folders = {"XDG_CONFIG_HOME": tmp_path / "config", "NUMBA_CACHE_DIR": tmp_path / "compiled"}
    environment = {**os.environ, **{name: str(path) for name, path in folders.items()}}

    def view() -> subprocess.Popen[bytes]:
        """Start it."""
        command = [sys.executable, "-m", "risorius", "view", "--size", "640x400"]
        begun.append(subprocess.Popen(command, env=environment, stderr=subprocess.PIPE))
        return begun[-1]

    yield view
    for process in begun:
        process.kill()
        process.wait()


def test_a_line_is_seen_before_anything_is_compiled(
    start: Callable[[], subprocess.Popen[bytes]], tmp_path: Path
) -> None:
    """The first start says what goes on, and closes when asked."""
    process = start()
    wanted = [
        picture((640, 400), 15.0, THEMES["light"], text).astype(int)
        for text in (LOADING, COMPILING)
    ]
    is_like = [False, False]
    for shown in first_pictures(process):
        for index, image in enumerate(wanted):
            is_like[index] |= bool(np.abs(shown - image).max() <= 8)
        if not is_like[0]:
            assert not list((tmp_path / "compiled").rglob("*.nbc"))
        if all(is_like):
            break
    assert all(is_like)
    for window in windows_of(process, display.Display()):
        ask_to_close(window.id)
    assert process.wait(DEADLINE) == 0
