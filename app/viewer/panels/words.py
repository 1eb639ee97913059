"""Words that fit: cut or wrapped to the room there is; a hint in full where the mouse is."""

from __future__ import annotations

from imgui_bundle import imgui

from ..gui import em


def shortened(text: str, room: float, *, keeps_end: bool = False) -> str:
    """The text, or as much of its beginning (or end) as fits into the room [window units]."""
    cut = text
    for lost in range(1, len(text) + 1):
        if imgui.calc_text_size(cut).x <= room:
            return cut
        cut = f"..{text[lost:]}" if keeps_end else f"{text[:-lost]}.."
    return ""


def hint(text: str) -> None:
    """Tell more about the item drawn last, while the mouse is on it."""
    if text and imgui.is_item_hovered(imgui.HoveredFlags_.allow_when_disabled):
        imgui.begin_tooltip()
        imgui.push_text_wrap_pos(em(24))
        imgui.text_unformatted(text)
        imgui.pop_text_wrap_pos()
        imgui.end_tooltip()


def stay_in_line(width: float) -> None:
    """Go on beside the item drawn last, if the next one has room there."""
    spacing = imgui.get_style().item_spacing.x
    right = imgui.get_cursor_screen_pos().x + imgui.get_content_region_avail().x
    if imgui.get_item_rect_max().x + spacing + width <= right:
        imgui.same_line()
