"""A slider that also takes a typed number, and tells what was done with it."""

from __future__ import annotations

from typing import NamedTuple

from imgui_bundle import imgui

from ..gui import Gui, em, ink_of

# Knob and number of imgui's own sliders; bars have others.
HIDDEN = (imgui.Col_.slider_grab, imgui.Col_.slider_grab_active, imgui.Col_.text)


class SliderState(NamedTuple):
    """What happened to a slider in this frame."""

    value: float
    is_changed: bool
    is_done: bool  # let go, or typed: a change is complete
    is_hovered: bool


class Sliders:
    """All sliders of a window; at most one of them is a line to type in."""

    def __init__(self, gui: Gui) -> None:
        self._gui = gui
        self._typed: str | None = None
        self._is_new = False

    def draw(
        self,
        name: str,
        value: float,
        limits: tuple[float, float],
        *,
        width: float,
        neutral: float = 0.0,
        digits: int = 2,
        mark: str = "",
    ) -> SliderState:
        """Draw the slider `name`; a double or Ctrl click types a number, a right click resets.

        mark: what stands at its beginning.
        """
        imgui.set_next_item_width(width)
        if self._typed == name:
            return self._draw_line(name, value, limits)
        low, high = limits
        imgui.push_style_var(imgui.StyleVar_.grab_min_size, 1.0)
        for index in HIDDEN:
            imgui.push_style_color(index, 0)
        changed, now = imgui.slider_float(f"##{name}", value, low, high, f"%.{digits}f")
        imgui.pop_style_color(len(HIDDEN))
        imgui.pop_style_var()
        self._gui.remember(name)
        self._paint(now, limits, mark, digits)
        is_done = imgui.is_item_deactivated_after_edit()
        is_hovered = imgui.is_item_hovered()
        if is_hovered and imgui.is_mouse_double_clicked(0):
            self._typed, self._is_new = name, True
        if is_hovered and imgui.is_mouse_clicked(1):
            return SliderState(neutral, neutral != value, True, True)
        return SliderState(now, changed, is_done, is_hovered or imgui.is_item_active())

    def _paint(self, value: float, limits: tuple[float, float], mark: str, digits: int) -> None:
        """The slider drawn last as a bar that is filled from 0, with its number at the end."""
        theme, paper, padding = self._gui.theme, imgui.get_window_draw_list(), em(0.3)
        low, high = imgui.get_item_rect_min(), imgui.get_item_rect_max()
        least, most = limits
        ends = sorted((value, min(max(0.0, least), most)))
        first, last = (low.x + (high.x - low.x) * (end - least) / (most - least) for end in ends)
        fill = ink_of(theme.accent, 0.6 if first < last else 0.0)
        paper.add_rect_filled(
            (first, low.y), (last, high.y), fill, imgui.get_style().frame_rounding
        )
        number = f"{value:.{digits}f}" if value else "0"
        end = high.x - padding - imgui.calc_text_size(number).x
        ink = ink_of(theme.text if value else theme.muted)
        paper.push_clip_rect(low, high, True)
        if low.x + 2.0 * padding + imgui.calc_text_size(mark).x > end:
            mark = ""
        for text, x in ((number, end), (mark, low.x + padding)):
            paper.add_text((x, low.y + imgui.get_style().frame_padding.y), ink, text)
        paper.pop_clip_rect()

    def _draw_line(self, name: str, value: float, limits: tuple[float, float]) -> SliderState:
        if self._is_new:
            imgui.set_keyboard_focus_here()
        _, typed = imgui.input_float(
            f"##type {name}", value, 0.0, 0.0, "%.3f", imgui.InputTextFlags_.auto_select_all
        )
        self._gui.remember(name)
        is_over = imgui.is_item_deactivated() and not self._is_new
        is_done = imgui.is_item_deactivated_after_edit()
        self._is_new = False
        if is_over:
            self._typed = None
        now = min(max(typed, limits[0]), limits[1])
        return SliderState(now, now != value, is_done, True)
