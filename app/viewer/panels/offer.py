"""One line above the face: what the window that was open before had not saved."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from imgui_bundle import imgui

from .. import commands
from ..gui import em

if TYPE_CHECKING:
    from ..window import Viewer

BUTTON_WIDTH = 7.0  # [em]


def draw_offer(viewer: Viewer) -> None:
    """Offer what was left behind, until it is taken or thrown away."""
    recovery = viewer.recovery
    if recovery.found is None:
        return
    when = time.strftime("%Y-%m-%d %H:%M", time.localtime(recovery.found_at))
    left, top, width, _ = viewer.picture_area
    imgui.set_next_window_pos(
        imgui.ImVec2(left + 0.5 * width, top + em(0.8)), 0, imgui.ImVec2(0.5, 0.0)
    )
    room = max(width - em(1.6), em(BUTTON_WIDTH))
    imgui.set_next_window_size_constraints(imgui.ImVec2(0.0, 0.0), imgui.ImVec2(room, em(20)))
    flags = imgui.WindowFlags_.always_auto_resize | imgui.WindowFlags_.no_decoration
    imgui.begin("##offer", None, flags | imgui.WindowFlags_.no_focus_on_appearing)
    imgui.push_text_wrap_pos(room - em(0.8))
    imgui.align_text_to_frame_padding()
    imgui.text_unformatted(f"Unsaved work of {when}: {recovery.found.words}")
    imgui.pop_text_wrap_pos()
    for label, run in (
        ("Recover", lambda: commands.recover(viewer)),
        ("Throw away", lambda: recovery.drop_found(viewer.session)),
    ):
        if label != "Recover":
            imgui.same_line()
        elif imgui.get_item_rect_size().x + em(2.0 * BUTTON_WIDTH + 3.0) < room:
            imgui.same_line()
        is_clicked = imgui.button(label, imgui.ImVec2(em(BUTTON_WIDTH), 0.0))
        viewer.gui.remember(f"offer: {label}")
        if is_clicked:
            viewer.attempt(run)
    imgui.end()
