"""Dear ImGui in the GLFW window: set up, one frame, shut down.

imgui-bundle brings GLFW of its own and must be imported before `glfw` is, so that both speak to
the same library; this module is therefore imported before a window is opened.
"""

from __future__ import annotations

import contextlib
import ctypes
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import imgui_bundle
from imgui_bundle import imgui

import glfw  # isort: skip - after imgui_bundle, see above

FONT = Path(imgui_bundle.__file__).parent / "assets/fonts/Roboto/Roboto-Regular.ttf"
FONT_SIZE = 16.0  # [window units]


class Gui:
    """The Dear ImGui context of one window."""

    def __init__(self, window: Any) -> None:
        self._context = imgui.create_context()
        io = imgui.get_io()
        io.set_ini_filename("")  # nothing is written into the user's folder
        if FONT.exists():
            io.fonts.add_font_from_file_ttf(str(FONT), FONT_SIZE)
        _dress(imgui.get_style())
        address = ctypes.cast(window, ctypes.c_void_p).value
        if address is None:
            raise RuntimeError("the window is closed already")
        imgui.backends.glfw_init_for_opengl(address, True)
        imgui.backends.opengl3_init("#version 330")

    @contextlib.contextmanager
    def frame(self) -> Iterator[None]:
        """Everything drawn with imgui in this block appears over what was drawn before."""
        imgui.backends.opengl3_new_frame()
        imgui.backends.glfw_new_frame()
        imgui.new_frame()
        try:
            yield
        finally:
            imgui.render()
            imgui.backends.opengl3_render_draw_data(imgui.get_draw_data())

    def close(self) -> None:
        """Give back what the GUI holds; the window stays."""
        imgui.backends.opengl3_shutdown()
        imgui.backends.glfw_shutdown()
        imgui.destroy_context(self._context)


def _dress(style: Any) -> None:
    """A quiet dark panel: the face is what is looked at."""
    imgui.style_colors_dark(style)
    style.window_rounding = 0.0
    style.frame_rounding = 3.0
    style.grab_rounding = 3.0
    style.window_border_size = 0.0
    style.item_spacing = imgui.ImVec2(8.0, 4.0)
    colour = imgui.ImVec4
    for index, value in (
        (imgui.Col_.window_bg, colour(0.11, 0.115, 0.13, 1.0)),
        (imgui.Col_.frame_bg, colour(0.19, 0.20, 0.22, 1.0)),
        (imgui.Col_.frame_bg_hovered, colour(0.25, 0.26, 0.29, 1.0)),
        (imgui.Col_.frame_bg_active, colour(0.29, 0.30, 0.33, 1.0)),
        (imgui.Col_.slider_grab, colour(0.80, 0.52, 0.40, 1.0)),
        (imgui.Col_.slider_grab_active, colour(0.95, 0.62, 0.47, 1.0)),
        (imgui.Col_.check_mark, colour(0.95, 0.62, 0.47, 1.0)),
        (imgui.Col_.header, colour(0.22, 0.23, 0.26, 1.0)),
        (imgui.Col_.header_hovered, colour(0.28, 0.29, 0.33, 1.0)),
        (imgui.Col_.header_active, colour(0.33, 0.34, 0.38, 1.0)),
        (imgui.Col_.button, colour(0.24, 0.25, 0.29, 1.0)),
        (imgui.Col_.button_hovered, colour(0.42, 0.31, 0.27, 1.0)),
        (imgui.Col_.button_active, colour(0.60, 0.40, 0.32, 1.0)),
    ):
        style.set_color_(index, value)


def poll_events() -> None:
    """Take in what the user did since the last call."""
    glfw.poll_events()


def time_now() -> float:
    """Seconds on GLFW's clock."""
    return float(glfw.get_time())
