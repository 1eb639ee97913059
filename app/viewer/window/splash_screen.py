"""The window as it opens: a picture of the face at once, while the face itself is made.

Imports little, so that it comes quickly; what takes long is done in a thread meanwhile.
"""

from __future__ import annotations

import contextlib
import functools
import logging
import os
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from importlib.resources import files
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import PIL.Image
from PIL import ImageDraw, ImageFont

from risorius import render
from risorius.schema import read_what_fits

from ...errors import UserError
from ..interface.gui import FONT, FONT_SIZE, THEMES, Theme, wait_for_event
from ..setting_rules import WindowSettings, stored_settings
from .placement import first_size

LOADING, COMPILING = "Loading the face ...", "Compiling, this once: half a minute ..."
PANEL, TOP, BELOW = 22.5, 1.4, 7.9  # [em] that panels, menus and the timeline take at first
PAUSE, REDRAWN = 0.05, 10  # [s] between two looks at what the user does; so many of them
LOG = logging.getLogger("risorius.jit")  # where it is told what is compiled
Result = TypeVar("Result")


class SplashScreen(logging.Handler):
    """An open window with nothing in it yet; a context manager, which closes it."""

    def __init__(self, size: tuple[int, int] | None, path: Path | None, *, is_own: bool) -> None:
        """path: of the settings. is_own: it is not the built-in face that will be seen."""
        super().__init__()
        stored: Any = {}
        with contextlib.suppress(UserError, OSError, ValueError):  # which load_settings tells
            stored = {} if path is None else stored_settings(path)
        found = read_what_fits(WindowSettings, stored)[0]
        self._theme, self._is_own = THEMES[found.theme], is_own
        self._text, self._drawn = LOADING, ((0, 0), "")
        self.surface = render.open_window(size or first_size(found.size), "Risorius")
        self._em = FONT_SIZE * found.zoom * self.surface.pixel_scale
        LOG.addHandler(self)
        self._show()

    def emit(self, record: logging.LogRecord) -> None:
        """Somebody tells that code is compiled."""
        self._text = COMPILING

    def __enter__(self) -> SplashScreen:
        return self

    def __exit__(self, *_: object) -> None:
        LOG.removeHandler(self)
        self.surface.close()

    def during(self, work: Callable[[], Result]) -> Result:
        """Do what takes long, while the window answers; where it fails, the window closes."""
        thread = ThreadPoolExecutor(1)
        outcome, looks = thread.submit(work), 0
        thread.shutdown(wait=False)
        while not outcome.done():
            wait_for_event(PAUSE)
            looks += 1
            if looks % REDRAWN == 0 or self._drawn != (self.surface.frame_size, self._text):
                self._show()
            if self.surface.should_close:  # there is nothing yet that could be lost
                os._exit(0)
        if outcome.exception() is not None:
            self.__exit__()
        return outcome.result()

    def _show(self) -> None:
        self._drawn = size, text = self.surface.frame_size, self._text
        self.surface.show(picture(size, self._em, self._theme, text, is_own=self._is_own))


@functools.lru_cache(maxsize=1)
def picture(
    size: tuple[int, int], em: float, theme: Theme, text: str, *, is_own: bool
) -> render.Image:
    """The window's frame with the face at rest, panels without anything, and a line of text."""
    shade = tuple(round(255.0 * part) for part in theme.panel)
    page = PIL.Image.new("RGB", size, shade)
    left, top = round(min(PANEL * em, 0.45 * size[0])), round(TOP * em)
    width, height = max(size[0] - left, 1), max(size[1] - top - round(BELOW * em), 1)
    x, y = np.linspace(-1.0, 1.0, width) + 0.08, np.linspace(1.0, -1.0, height)[:, None] - 0.16
    far = 0.44 * (x**2 + y**2)[..., None]  # as in background.glsl
    centre, edge = np.array(theme.background.centre), np.array(theme.background.edge)
    colours = centre + (edge - centre) * (far / (0.35 + far) * 1.35)
    scene = PIL.Image.fromarray((255.0 * colours.clip(0.0, 1.0) + 0.5).astype(np.uint8))
    if not is_own:
        with (files("risorius.assets") / "data" / "first_picture.png").open("rb") as file:
            face = PIL.Image.open(file).resize((height, height), PIL.Image.Resampling.BILINEAR)
        scene.paste(face, ((width - height) // 2, 0), face)
    draw = ImageDraw.Draw(scene)
    font = ImageFont.truetype(FONT, em) if FONT.exists() else ImageFont.load_default(em)
    place = 1.3 * em, height - 1.8 * em
    box = draw.textbbox(place, text, font=font, anchor="lm")
    draw.rectangle((box[0] - em / 2, place[1] - em, box[2] + em / 2, place[1] + em), fill=shade)
    draw.text(place, text, font=font, anchor="lm", fill="white" if theme.is_dark else "black")
    page.paste(scene, (left, top))
    return np.asarray(page)


def settings_path() -> Path:
    """Where this system keeps a user's settings."""
    home = Path.home()
    if sys.platform == "win32":
        folder = Path(os.environ.get("APPDATA", home / "AppData" / "Roaming"))
    elif sys.platform == "darwin":
        folder = home / "Library" / "Application Support"
    else:
        folder = Path(os.environ.get("XDG_CONFIG_HOME") or home / ".config")
    return folder / "risorius" / "viewer.json"
