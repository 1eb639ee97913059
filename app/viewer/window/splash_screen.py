"""The window during its opening: a line with the progress, while a thread makes the face."""

from __future__ import annotations

import logging
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TypeVar

import numpy as np
import PIL.Image
from PIL import ImageDraw, ImageFont

from risorius import render

from ...compiling_note import COMPILING_TEXT
from ...text import counted
from ..interface.gui import FONT_FILE, FONT_SIZE, THEMES, Theme, wait_for_event
from ..settings import Settings, load_settings

LOADING_TEXT = "Loading the face ..."
Result = TypeVar("Result")


class SplashScreen(logging.Handler):
    """An open window that is still empty; a context manager, which closes it.

    settings: the remembered settings. complaint: a line that names unusable settings, or "".
    """

    LOG = logging.getLogger("risorius.jit")  # reports each function that is compiled

    def __init__(self, size: tuple[int, int] | None, path: Path | None) -> None:
        """size: None for the remembered or the screen's size. path: file of the settings."""
        super().__init__()
        self.settings = Settings()
        self.complaint = ""
        if path is not None:
            self.settings, self.complaint = load_settings(path)
        remembered = self.settings.size
        known = size or remembered
        self._text = LOADING_TEXT
        self._compiled_count = 0
        self._drawn = ((0, 0), "")
        most = 2560, 1440  # [units of a screen of ordinary density]
        self.surface = render.open_window(known or most, "Risorius", is_scaled=known is None)
        height = self.surface.frame_size[1]
        if remembered is None:
            self.settings.zoom = zoom_for(self.surface, height)
        elif size is not None:  # the remembered size of words belongs to a window of another size
            former = zoom_for(self.surface, height * remembered[1] / size[1])
            self.settings.enlarge(zoom_for(self.surface, height) / former)
        self.LOG.addHandler(self)
        self._show()

    def emit(self, record: logging.LogRecord) -> None:
        """Show how many functions have been compiled; the log has a record for each of them."""
        self._compiled_count += 1
        self._text = compiling_text(self._compiled_count)

    def __enter__(self) -> SplashScreen:
        return self

    def __exit__(self, *_: object) -> None:
        self.LOG.removeHandler(self)
        self.surface.close()

    def run(self, work: Callable[[], Result]) -> Result:
        """Do long work while the window responds; if the work fails, the window closes."""
        thread = ThreadPoolExecutor(1)
        outcome = thread.submit(work)
        thread.shutdown(wait=False)
        while not outcome.done():
            wait_for_event(0.05)  # [s]
            if self._drawn != (self.surface.frame_size, self._text):
                self._show()
            if self.surface.should_close:  # no work can be lost yet
                os._exit(0)
        if outcome.exception() is not None:
            self.__exit__()
        return outcome.result()

    def _show(self) -> None:
        self._drawn = size, text = self.surface.frame_size, self._text
        letter = FONT_SIZE * self.settings.zoom * self.surface.pixel_scale
        self.surface.show(picture(size, letter, THEMES[self.settings.theme], text))


def compiling_text(count: int) -> str:
    """Return two lines that are shown while functions are compiled; count: their number so far.

    The number shows progress, because a busy machine takes longer than the first line says.
    """
    functions = counted(count, "function")
    return f"{COMPILING_TEXT}\n{functions} so far ..."


def zoom_for(surface: render.WindowSurface, height: float) -> float:
    """Return the factor on the size of words that makes them readable in a large window.

    height: height of the window [pixels].
    """
    usual_height = 1080.0  # [units of a screen of ordinary density]
    return min(max(height / surface.pixel_scale / usual_height, 1.0), 1.5)


def picture(size: tuple[int, int], letter: float, theme: Theme, text: str) -> render.Image:
    """Return an image with one or two lines of text in its middle."""
    shade = tuple(round(255.0 * part) for part in theme.panel)
    page = PIL.Image.new("RGB", size, shade)
    font = (
        ImageFont.truetype(FONT_FILE, letter)
        if FONT_FILE.exists()
        else ImageFont.load_default(letter)
    )
    ink = "white" if theme.is_dark else "black"
    middle = size[0] / 2, size[1] / 2
    ImageDraw.Draw(page).text(middle, text, ink, font, "mm", spacing=letter, align="center")
    return np.asarray(page)
