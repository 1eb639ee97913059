"""Dear ImGui in the GLFW window: set up, themes, one frame, shut down.

imgui-bundle contains its own GLFW library. It must be imported before `glfw`, so that both use the
same library; so this module is imported before a window is opened. We chose this binding because
its C++ backends draw in moderngl's window, without PyOpenGL.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import re
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import imgui_bundle
from imgui_bundle import imgui

from risorius import render

from ...text import as_text

import glfw  # isort: skip - must follow imgui_bundle, see above

FONT_FILE = Path(imgui_bundle.__file__).parent / "assets/fonts/Roboto/Roboto-Regular.ttf"
FONT_SIZE = 15.0  # [window units at scale 1]
# Buttons of the mouse.
LEFT_BUTTON = 0
RIGHT_BUTTON = 1
MIDDLE_BUTTON = 2
MODIFIER_KEYS = range(glfw.KEY_LEFT_SHIFT, glfw.KEY_RIGHT_SUPER + 1)
# Flags of a note over the picture: it has the size of its text, and takes no keyboard focus.
NOTE_FLAGS = (
    imgui.WindowFlags_.always_auto_resize
    | imgui.WindowFlags_.no_decoration
    | imgui.WindowFlags_.no_focus_on_appearing
)

_drop_callbacks: list[Any] = []  # keeps references, because GLFW keeps none


@dataclass(frozen=True)
class Theme:
    """Colours of the panels (sRGB), and the matching background behind the face."""

    background: render.Background
    is_dark: bool
    panel: tuple[float, float, float]
    field: tuple[float, float, float]
    raised: tuple[float, float, float]
    accent: tuple[float, float, float]
    text: tuple[float, float, float]
    muted: tuple[float, float, float]
    error: tuple[float, float, float]


THEMES = {
    "light": Theme(
        background=render.LIGHT,
        is_dark=False,
        panel=(0.945, 0.945, 0.95),
        field=(0.865, 0.87, 0.88),
        raised=(0.82, 0.825, 0.84),
        accent=(0.72, 0.33, 0.22),
        text=(0.12, 0.12, 0.14),
        muted=(0.40, 0.41, 0.44),
        error=(0.70, 0.10, 0.10),
    ),
    "dark": Theme(
        background=render.DARK,
        is_dark=True,
        panel=(0.115, 0.12, 0.13),
        field=(0.19, 0.195, 0.215),
        raised=(0.25, 0.26, 0.29),
        accent=(0.93, 0.58, 0.43),
        text=(0.92, 0.92, 0.94),
        muted=(0.62, 0.64, 0.68),
        error=(1.0, 0.50, 0.45),
    ),
}


class Gui:
    """The Dear ImGui context of one window; `places` has the area of each item for tests."""

    MOUSE_BUTTON_KEY = -1  # stands for a mouse button

    def __init__(self, window: Any) -> None:
        self._window = window
        self._title = ""
        self._context = imgui.create_context()
        self.double_click_time = 0.3  # [s] between two presses at most
        self.has_popup = False  # whether a menu, a list or a dialog was open at the turn's start
        self.is_reading = False  # whether a displayed text has the keyboard focus
        self._presses: list[tuple[int, int | None]] = []  # queued events before a key or button
        self._is_answering = False  # whether `turns` answers events that happened earlier
        self._last_reading = time.perf_counter()  # time of the last reading of events [s]
        self._last_answered = self._last_reading - 1.0 / 60.0  # reading before the last frame [s]
        self._largest_age = 0.0  # [s] between the last two readings: largest age of an event
        self.places: dict[str, tuple[float, float, float, float]] = {}
        self.keys: dict[str, str] = {}  # keys of commands, by the commands' labels
        self.theme = THEMES["light"]
        self._dressed: object = None
        io = imgui.get_io()
        io.set_ini_filename("")  # settings.py stores the panel's width and folds
        if FONT_FILE.exists():
            io.fonts.add_font_from_file_ttf(str(FONT_FILE), FONT_SIZE)
        address = ctypes.cast(window, ctypes.c_void_p).value
        if address is None:
            raise RuntimeError("the window is closed already")
        glfw.set_key_callback(window, self._note_key)  # ImGui calls this callback before its own
        glfw.set_mouse_button_callback(window, self._note_button)
        imgui.backends.glfw_init_for_opengl(address, True)
        imgui.backends.opengl3_init("#version 330")

    def set_theme(self, theme: str, zoom: float) -> None:
        """Apply a theme; sizes are scaled by `zoom`, and by the density of the screen."""
        density = max(glfw.get_window_content_scale(self._window))
        if self._dressed == (theme, zoom, density):
            return
        self._dressed = theme, zoom, density
        self.theme = THEMES[theme]
        scale = zoom * self._screen_scale(density)
        style = imgui.get_style()
        _set_colours(style, self.theme)
        style.scale_all_sizes(scale)
        style.font_scale_main = scale

    def _screen_scale(self, density: float) -> float:
        """Return the scale of a dense screen, or 1 where window units are scaled already.

        On macOS a window unit is two pixels, as imgui knows; on Windows and X11 it is one pixel.
        """
        width = max(glfw.get_window_size(self._window)[0], 1)
        pixels_per_unit = glfw.get_framebuffer_size(self._window)[0] / width
        return max(density / max(pixels_per_unit, 1.0), 1.0)

    def set_title(self, title: str) -> None:
        """Set the window's title if it has changed."""
        if title != self._title:
            self._title = title
            glfw.set_window_title(self._window, as_text(title))

    @property
    def window_size(self) -> tuple[int, int]:
        """The size of the window [screen units]."""
        width, height = glfw.get_window_size(self._window)
        return int(width), int(height)

    @property
    def is_minimised(self) -> bool:
        """Whether the window is minimised, so that it is invisible."""
        return bool(glfw.get_window_attrib(self._window, glfw.ICONIFIED))

    def restore(self) -> None:
        """Show a window that was minimised."""
        if self.is_minimised:
            glfw.restore_window(self._window)

    def read_events(self, seconds: float = 0.0) -> bool:
        """Wait for input of the user, `seconds` at most; return whether there is any."""
        self._largest_age = time.perf_counter() - self._last_reading
        glfw.wait_events_timeout(seconds)
        self._last_reading = time.perf_counter()
        return bool(self._context.input_events_queue.size() > 0)

    def _note_key(self, _: Any, key: int, code: int, action: int, modifiers: int) -> None:
        """Note the queue's length before a press, and before the release of a modifier.

        `turns` answers these events in separate frames, so a key keeps its modifiers.
        """
        is_modifier = key in MODIFIER_KEYS
        if action == glfw.PRESS or (is_modifier and action == glfw.RELEASE):
            count = self._context.input_events_queue.size()
            self._presses.append((count, None if is_modifier else key))

    def _note_button(self, _: Any, button: int, action: int, modifiers: int) -> None:
        """Note the queue's length before press and release: earlier motion is answered first.

        A bar ignores motion that comes with the release. A double click may take longer if the
        events are old.
        """
        self._presses.append((self._context.input_events_queue.size(), self.MOUSE_BUTTON_KEY))
        if action == glfw.PRESS:
            io = imgui.get_io()
            longest = self.double_click_time + self._largest_age
            io.mouse_double_click_time = longest
            io.mouse_single_click_delay = longest + 0.1

    def turns(self) -> Iterator[None]:
        """Yield once for each `frame` of the GUI that the user's input needs."""
        io = imgui.get_io()
        queue = self._context.input_events_queue
        waiting = type(queue)()
        for event in queue:
            waiting.push_back(event)
        queue.clear()
        cuts = [(0, None), *self._presses, (waiting.size(), 0)]
        self._presses = []
        focus_turns = 3  # frames of the GUI until a newly opened window gets the focus
        for (start, pressed), (end, following) in pairwise(cuts):
            for index in range(start, end):
                queue.push_back(waiting[index])
            self._is_answering = True
            while queue.size():
                yield
            # A press may open an input line; later keys wait until it has the focus.
            is_settling = pressed is not None and following not in (None, self.MOUSE_BUTTON_KEY)
            for _ in range(focus_turns * is_settling):
                if not io.want_text_input:
                    yield
        self._is_answering = False

    def covers(self, area: tuple[float, float, float, float]) -> bool:
        """Whether a window of the last frame reaches into an area (left, top, width, height)."""
        left, top, width, height = area
        for window in imgui.get_current_context().windows:
            if window.active and not window.hidden:
                seen = window.outer_rect_clipped
                is_across = seen.min.x < left + width - 1.0 and seen.max.x > left + 1.0
                if is_across and seen.min.y < top + height - 1.0 and seen.max.y > top + 1.0:
                    return True
        return False

    @contextlib.contextmanager
    def frame(self, *, is_visible: bool = True) -> Iterator[None]:
        """Draw the imgui items of this block over the picture.

        is_visible: if False, input is answered, but nothing is drawn.
        """
        imgui.backends.opengl3_new_frame()
        queue = self._context.input_events_queue
        count = queue.size()
        imgui.backends.glfw_new_frame()
        # For a mouse that was not seen to enter the window, the backend adds its current place. An
        # earlier click would then be answered there.
        while self._is_answering and queue.size() > count:
            queue.pop_back()
        io = imgui.get_io()
        # The time of an event is the time of its reading, not of its answer.
        io.delta_time = max(self._last_reading - self._last_answered, 1e-6)
        self._last_answered = self._last_reading
        self.has_popup = self._context.open_popup_stack.size() > 0
        # In a popup, Tab and arrows move the focus; otherwise they have other functions.
        walks = imgui.ConfigFlags_.nav_enable_keyboard
        io.config_flags = io.config_flags | walks if self.has_popup else io.config_flags & ~walks
        imgui.new_frame()
        self.places.clear()
        try:
            yield
        finally:
            imgui.render()
            if is_visible:
                imgui.backends.opengl3_render_draw_data(imgui.get_draw_data())

    def with_keys(self, text: str) -> str:
        """Replace the labels of commands in brackets by the commands' keys."""
        return re.sub(r"\[(.+?)\]", lambda found: self.keys.get(found[1]) or found[0], text)

    def remember(self, name: str) -> None:
        """Store the place of the last drawn item under a name."""
        low = imgui.get_item_rect_min()
        high = imgui.get_item_rect_max()
        self.places[name] = (low.x, low.y, high.x, high.y)

    def close(self) -> None:
        """Release all resources of the GUI; the window stays."""
        imgui.backends.opengl3_shutdown()
        imgui.backends.glfw_shutdown()
        imgui.destroy_context(self._context)


def wait_for_event(seconds: float) -> None:
    """Sleep until input of the user, `seconds` at most, while the window has no GUI yet."""
    glfw.wait_events_timeout(seconds)


def wake_up() -> None:
    """End a wait for events, from any thread."""
    glfw.post_empty_event()


def on_drop(window: Any, open_files: Callable[[Sequence[str]], None]) -> None:
    """Call `open_files` with the paths of files that are dropped onto the window."""

    def call(_: Any, count: int, names: Any) -> None:
        """Receive a call of GLFW; glfw's own wrapper only accepts names in UTF-8."""
        open_files([os.fsdecode(names[number]) for number in range(count)])

    library: Any = glfw  # its type stubs lack these functions
    callback = library._GLFWdropfun(call)
    _drop_callbacks.append(callback)
    library._glfw.glfwSetDropCallback(window, callback)


@contextlib.contextmanager
def fixed_panel(
    name: str, place: tuple[float, float], size: tuple[float, float], *, resizes: bool = False
) -> Iterator[None]:
    """Draw the block in a panel at a fixed place; with `resizes` its edges can be dragged."""
    imgui.set_next_window_pos(place)
    imgui.set_next_window_size((max(size[0], 1.0), max(size[1], 1.0)))
    flags = imgui.WindowFlags_.no_title_bar | imgui.WindowFlags_.no_scroll_with_mouse
    flags |= imgui.WindowFlags_.no_collapse | imgui.WindowFlags_.no_move
    flags |= imgui.WindowFlags_.no_scrollbar if resizes else imgui.WindowFlags_.no_resize
    flags |= imgui.WindowFlags_.no_background  # the surface has this colour already
    imgui.begin(name, None, flags | imgui.WindowFlags_.no_bring_to_front_on_focus)
    try:
        yield
    finally:
        imgui.end()


def em(count: float = 1.0) -> float:
    """Return the height of `count` letters [window units], the unit of all sizes in [em]."""
    return count * int(FONT_SIZE * imgui.get_style().font_scale_main + 0.5)  # rounded as by imgui


def colour(rgb: tuple[float, float, float], opacity: float = 1.0) -> Any:
    """Return a colour in imgui's vector type."""
    return imgui.ImVec4(*rgb, opacity)


def ink_of(rgb: tuple[float, float, float], opacity: float = 1.0) -> int:
    """Return a colour as a number, for imgui's draw lists."""
    return int(imgui.get_color_u32(colour(rgb, opacity)))


def _set_colours(style: Any, theme: Theme) -> None:
    """Set calm colours for the panels, because the user looks at the face."""
    fresh = imgui.Style()
    for name in dir(fresh):  # reset every size: scaling multiplies the current sizes
        size = getattr(fresh, name)
        if isinstance(size, (float, imgui.ImVec2)) and not name.startswith("font"):
            setattr(style, name, size)
    (imgui.style_colors_dark if theme.is_dark else imgui.style_colors_light)(style)
    style.window_rounding = 0.0
    style.frame_rounding = style.grab_rounding = 3.0
    style.window_border_size = 0.0
    style.item_spacing = imgui.ImVec2(7.0, 4.0)
    which = imgui.Col_
    for indices, value in (
        ((which.text,), theme.text),
        ((which.window_bg, which.menu_bar_bg, which.title_bg, which.title_bg_active), theme.panel),
        ((which.popup_bg, which.tab), theme.panel),
        ((which.frame_bg, which.header, which.tab_hovered), theme.field),
        ((which.frame_bg_hovered, which.frame_bg_active, which.header_hovered), theme.raised),
        ((which.header_active, which.button, which.tab_selected), theme.raised),
        ((which.nav_cursor, which.check_mark), theme.accent),
        ((which.plot_lines, which.plot_histogram, which.tab_selected_overline), theme.accent),
    ):
        for index in indices:
            style.set_color_(index, colour(value))
    for index in (which.button_hovered, which.button_active, which.slider_grab_active):
        style.set_color_(index, colour(theme.accent, 0.55))
    style.set_color_(which.slider_grab, colour(theme.accent, 0.45))  # the number is drawn over it
    for index in (which.resize_grip, which.resize_grip_hovered, which.resize_grip_active):
        style.set_color_(index, colour(theme.panel, 0.0))  # the edge shows it, too
    style.set_color_(which.modal_window_dim_bg, colour((0.0, 0.0, 0.0), 0.3))
