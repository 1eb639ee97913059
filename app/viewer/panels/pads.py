"""Small fields in which eyes, jaw and head are moved two ways at once."""

from __future__ import annotations

from imgui_bundle import imgui

from ...controls.vocabulary import Pad, pads
from ..gui import LEFT, RIGHT, Gui, em, ink_of
from ..session import Session
from .widgets import hint

HEIGHT, DOT = 4.6, 0.32  # [em] of a field, and half of the dot in it


class Pads:
    """Draws those for which the scene has controls."""

    def __init__(self, gui: Gui, session: Session) -> None:
        self._gui, self._session = gui, session
        self._is_reset = False  # by the press that goes on

    def draw(self) -> None:
        """All of them beside each other."""
        known, spacing = self._session.controls.limits.keys(), imgui.get_style().item_spacing.x
        shown = [pad for pad in pads() if {pad.across, pad.along} <= known]
        room = imgui.get_content_region_avail().x + spacing
        for index, pad in enumerate(shown):
            if index:
                imgui.same_line()
            self._draw_pad(pad, max(room / len(shown) - spacing, 1.0))

    def _draw_pad(self, pad: Pad, width: float) -> None:
        imgui.invisible_button(f"pad {pad.title}", (width, em(HEIGHT)))
        self._gui.remember(f"pad {pad.title}")
        low, high = imgui.get_item_rect_min(), imgui.get_item_rect_max()
        mouse = imgui.get_mouse_pos()
        is_held, is_back = imgui.is_item_active(), imgui.is_item_clicked(RIGHT)
        if imgui.is_item_clicked(LEFT):
            self._is_reset = imgui.get_mouse_clicked_count(LEFT) > 1
        if is_back or (is_held and self._is_reset):
            self._move(pad, 0.0, 0.0)
        elif is_held:
            down = min(max((mouse.y - low.y) / (high.y - low.y), 0.0), 1.0)
            across = 2.0 * (mouse.x - low.x) / (high.x - low.x) - 1.0
            self._move(pad, across, pad.top + down * (pad.bottom - pad.top))
        else:
            hint(f"{pad.title}: {pad.meaning}\na double click takes it back")
        if is_back or imgui.is_item_deactivated():
            self._session.note()
        self._paint(pad, low, high)

    def _move(self, pad: Pad, across: float, along: float) -> None:
        self._session.set(pad.across, across)
        self._session.set(pad.along, along)

    def _paint(self, pad: Pad, low: imgui.ImVec2, high: imgui.ImVec2) -> None:
        theme, paper, current = self._gui.theme, imgui.get_window_draw_list(), self._session.current
        is_lit, margin = imgui.is_item_hovered() or imgui.is_item_active(), em(DOT)
        across, along = current[pad.across], current[pad.along]
        ink = theme.accent if across or along else theme.muted
        inks = ((theme.raised if is_lit else theme.field, 1.0), (theme.muted, 0.35), (ink, 1.0))
        back, faint, full = (ink_of(*shade) for shade in inks)

        def place(across: float, along: float) -> tuple[float, float]:
            down = (along - pad.top) / (pad.bottom - pad.top)
            x = low.x + margin + (0.5 + 0.5 * across) * (high.x - low.x - 2.0 * margin)
            return x, low.y + margin + down * (high.y - low.y - 2.0 * margin)

        rest, now = place(0.0, 0.0), place(across, along)
        paper.add_rect_filled(low, high, back, imgui.get_style().frame_rounding)
        paper.add_line((rest[0], low.y), (rest[0], high.y), faint)
        paper.add_line((low.x, rest[1]), (high.x, rest[1]), faint)
        paper.add_text((low.x + margin, high.y - em(1.2)), full, pad.title)
        paper.add_line(rest, now, full, em(0.12))
        paper.add_circle_filled(now, margin, full)
