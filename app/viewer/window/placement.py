"""The window on the desktop: what it is called, full screen and back, minimised."""

from __future__ import annotations

from typing import Any

import glfw  # the GUI library's: the package imports that first

from risorius import render

FIRST_SIZE = 1280, 800  # [units of a screen of ordinary density]


def first_size(remembered: tuple[int, int] | None) -> tuple[int, int]:
    """How large the window opens: as it was closed, else as the screen suits."""
    if remembered is None:
        return render.size_on_screen(FIRST_SIZE, is_scaled=True)
    return render.size_on_screen(remembered, is_scaled=False)


class Placement:
    """Speaks to the desktop about one window."""

    def __init__(self, window: Any) -> None:
        self._window = window
        self._title = ""
        self._before: tuple[int, int, int, int] | None = None  # left, top, width, height
        self._was_maximised = False
        # A file dialog of the system's comes up over a full screen, which must not vanish then.
        glfw.set_window_attrib(window, glfw.AUTO_ICONIFY, glfw.FALSE)

    def set_title(self, title: str) -> None:
        """Give the window a title, if it has another one."""
        if title != self._title:
            self._title = title
            glfw.set_window_title(self._window, title)

    @property
    def is_full(self) -> bool:
        """Whether the window fills the screen and has no frame."""
        return self._before is not None

    def toggle_full(self) -> None:
        """Fill the screen that the window is on, or go back to where it was."""
        if self._before is not None:
            place, self._before = self._before, None
            no_monitor: Any = None  # the stubs know of none
            glfw.set_window_monitor(self._window, no_monitor, *place, 0)
            if self._was_maximised:
                glfw.maximize_window(self._window)
            return
        monitor = self._monitor()
        if monitor is None:
            return
        self._before = self._place()
        self._was_maximised = bool(glfw.get_window_attrib(self._window, glfw.MAXIMIZED))
        mode = glfw.get_video_mode(monitor)
        width, height = mode.size
        glfw.set_window_monitor(self._window, monitor, 0, 0, width, height, mode.refresh_rate)

    @property
    def size(self) -> tuple[int, int]:
        """Of the window, or of what it goes back to from the full screen [screen units]."""
        return (self._before or self._place())[2:]

    @property
    def is_minimised(self) -> bool:
        """Whether nothing of the window is to be seen."""
        return bool(glfw.get_window_attrib(self._window, glfw.ICONIFIED))

    def restore(self) -> None:
        """Show a window that was minimised."""
        if self.is_minimised:
            glfw.restore_window(self._window)

    def _place(self) -> tuple[int, int, int, int]:
        left, top = glfw.get_window_pos(self._window)
        width, height = glfw.get_window_size(self._window)
        return int(left), int(top), int(width), int(height)

    def _monitor(self) -> Any:
        """The screen that shows most of the window."""
        left, top, width, height = self._place()

        def shared(monitor: Any) -> int:
            """How much of it the window covers [screen units squared]."""
            x, y = glfw.get_monitor_pos(monitor)
            wide, high = glfw.get_video_mode(monitor).size
            across = min(left + width, x + wide) - max(left, x)
            along = min(top + height, y + high) - max(top, y)
            return int(max(across, 0) * max(along, 0))

        return max(glfw.get_monitors(), key=shared, default=None)
