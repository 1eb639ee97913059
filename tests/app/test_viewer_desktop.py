"""The window on the desktop: first picture, hidden panels, minimised, first size."""

import contextlib
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from Xlib import X, display
from Xlib.error import XError
from Xlib.protocol import event

from risorius.app.performances import script_for
from risorius.app.viewer import Viewer
from risorius.app.viewer.interface.gui import THEMES
from risorius.app.viewer.settings import Display
from risorius.app.viewer.window.splash_screen import LOADING_TEXT, compiling_text, picture

from .driving import (
    DEADLINE,
    NEEDS_A_SCREEN,
    SIZE,
    settle,
)

pytestmark = NEEDS_A_SCREEN

ROOT = Path(__file__).parents[2]


def ask_to_close(window):
    """Send the message of a click on the window's close button."""
    screen = display.Display()
    target = screen.create_resource_object("window", window)
    words = [screen.intern_atom("WM_DELETE_WINDOW"), X.CurrentTime, 0, 0, 0]
    kind = screen.intern_atom("WM_PROTOCOLS")
    target.send_event(event.ClientMessage(window=target, client_type=kind, data=(32, words)))
    screen.sync()


def windows_of(process, screen):
    """Windows on the screen opened by a process."""
    number = screen.get_atom("_NET_WM_PID")
    for window in screen.screen().root.query_tree().children:
        with contextlib.suppress(XError):  # closed meanwhile
            owner = window.get_full_property(number, X.AnyPropertyType)
            if owner is not None and owner.value[0] == process.pid:
                yield window


def first_pictures(process):
    """Yield pictures of the window of a starting process, (H, W, 3)."""
    screen = display.Display()
    while process.poll() is None:
        for window in windows_of(process, screen):
            with contextlib.suppress(XError):  # not visible yet
                size = window.get_geometry()
                read = window.get_image(0, 0, size.width, size.height, X.ZPixmap, 0xFFFFFFFF)
                pixels = np.frombuffer(read.data, np.uint8).reshape(size.height, size.width, 4)
                yield pixels[..., 2::-1].astype(int)
        time.sleep(0.02)


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Callable[[], subprocess.Popen[bytes]]]:
    """A function that starts `risorius view` as on a machine without compiled code."""
    begun = []
    folders = {"XDG_CONFIG_HOME": tmp_path / "config", "NUMBA_CACHE_DIR": tmp_path / "compiled"}
    environment = {**os.environ, **{name: str(path) for name, path in folders.items()}}

    def view():
        """Start it."""
        command = [sys.executable, "-m", "risorius", "view", "--size", "640x400"]
        begun.append(subprocess.Popen(command, env=environment, stderr=subprocess.PIPE))
        return begun[-1]

    yield view
    for process in begun:
        process.kill()
        process.wait()


def test_a_line_is_seen_before_anything_is_compiled(start, tmp_path):
    """The first start says that it loads, then that it compiles, and counts compiled functions.

    It closes on request.
    """
    process = start()
    loading, compiling = (
        picture((640, 400), 15.0, THEMES["light"], text).astype(int)
        for text in (LOADING_TEXT, compiling_text(1))
    )
    middle = 200  # row below which the number of functions is shown
    is_loading_seen = False
    counts = set()
    for shown in first_pictures(process):
        is_loading_seen |= bool(np.abs(shown - loading).max() <= 8)
        if not is_loading_seen:
            assert not list((tmp_path / "compiled").rglob("*.nbc"))
        if np.abs(shown - compiling)[:middle].max() <= 8:
            counts.add(shown[middle:].tobytes())
        if len(counts) > 2:
            break
    assert is_loading_seen
    assert len(counts) > 2
    for window in windows_of(process, display.Display()):
        ask_to_close(window.id)
    assert process.wait(DEADLINE) == 0


@pytest.mark.slow
def test_a_plane_has_no_settings_of_a_face():
    """With the plane, panels and menus have settings for all scenes, but none of a face."""
    with Viewer(script_for(None, "plane"), SIZE, Display()) as viewer:
        for tab, there, missing in (
            ("Face", {"search", "Neutral"}, {"Mirror", "Link sides", "tab Live", "menu Live"}),
            ("Mechanism", {"Look", "Shading"}, {"Skin maps", "Wrinkles", "Muscles"}),
            ("Scene", {"Light", "lens"}, {"Person", "Skin tone", "Hair"}),
        ):
            viewer.context.wanted_tab = tab
            viewer.settings.folds["Advanced"] = True
            settle(viewer)
            shown = set(viewer.gui.places)
            assert there <= shown
            assert not missing & shown
        cannot_run = {each.label for each in viewer.face.commands if not each.can_run()}
        assert {"Texture", "Muscles", "Idle life", "Mirror"} <= cannot_run
