"""A slider that also takes a typed number, and tells what was done with it."""

from __future__ import annotations

from typing import NamedTuple

from imgui_bundle import imgui

from ..gui import Gui


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
    ) -> SliderState:
        """Draw the slider `name`; a double or Ctrl click types a number, a right click resets."""
        imgui.set_next_item_width(width)
        if self._typed == name:
            return self._draw_line(name, value, limits)
        low, high = limits
        changed, now = imgui.slider_float(f"##{name}", value, low, high, f"%.{digits}f")
        self._gui.remember(name)
        is_done = imgui.is_item_deactivated_after_edit()
        is_hovered = imgui.is_item_hovered()
        if is_hovered and imgui.is_mouse_double_clicked(0):
            self._typed, self._is_new = name, True
        if is_hovered and imgui.is_mouse_clicked(1):
            return SliderState(neutral, neutral != value, True, True)
        return SliderState(now, changed, is_done, is_hovered or imgui.is_item_active())

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
