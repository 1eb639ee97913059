"""Words that fit: cut to the room there is, and a hint in full where the mouse rests."""

from __future__ import annotations

from imgui_bundle import imgui

from ..gui import em


def shortened(text: str, room: float, *, keeps_end: bool = False) -> str:
    """The text, or as much of its beginning (or end) as fits into the room [window units]."""
    cut = text
    while len(cut) > 1 and imgui.calc_text_size(cut).x > room:
        cut = f"..{cut.lstrip('.')[1:]}" if keeps_end else f"{cut.rstrip('.')[:-1]}.."
    return cut


def hint(text: str) -> None:
    """Tell more about the item drawn last, while the mouse is on it."""
    if text and imgui.is_item_hovered(imgui.HoveredFlags_.allow_when_disabled):
        imgui.begin_tooltip()
        imgui.push_text_wrap_pos(em(24))
        imgui.text_unformatted(text)
        imgui.pop_text_wrap_pos()
        imgui.end_tooltip()
