"""The window among others on the desktop: what it is called, and how it is shown."""

from __future__ import annotations

from typing import Any

import glfw  # the GUI library's: the package imports that first


class Placement:
    """Speaks to the desktop about one window."""

    def __init__(self, window: Any) -> None:
        self._window = window
        self._title = ""

    def call(self, title: str) -> None:
        """Give the window a title, if it has another one."""
        if title != self._title:
            self._title = title
            glfw.set_window_title(self._window, title)
