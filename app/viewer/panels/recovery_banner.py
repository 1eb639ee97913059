"""One line above the face: what the window that was open before had not saved."""

from __future__ import annotations

import time
from functools import partial

from imgui_bundle import imgui

from ..gui import NOTE_FLAGS, Gui, em
from ..messages import Message
from ..question import Question
from ..recovery import Recovery
from ..session import Session
from ..view import View
from .widgets import button

BUTTON_WIDTH = 7.0  # [em]


def draw_recovery(
    gui: Gui, recovery: Recovery, session: Session, question: Question, view: View
) -> Message:
    """Offer what was left behind, until it is taken or thrown away."""
    if recovery.found is None:
        return None
    when = time.strftime("%Y-%m-%d %H:%M", time.localtime(recovery.found_at))
    left, top, width, _ = view.area
    imgui.set_next_window_pos((left + 0.5 * width, top + em(0.8)), 0, (0.5, 0.0))
    room = max(width - em(1.6), em(BUTTON_WIDTH))
    imgui.set_next_window_size_constraints((0.0, 0.0), (room, em(20)))
    imgui.begin("##offer", None, NOTE_FLAGS)
    imgui.push_text_wrap_pos(room - em(0.8))
    imgui.align_text_to_frame_padding()
    imgui.text_unformatted(f"Unsaved work of {when}: {recovery.found.summary}")
    imgui.pop_text_wrap_pos()
    if imgui.get_item_rect_size().x + em(2.0 * BUTTON_WIDTH + 3.0) < room:
        imgui.same_line()
    is_accepted = button(gui, "Recover", name="offer: Recover", width=em(BUTTON_WIDTH))
    imgui.same_line()
    is_discarded = button(gui, "Throw away", name="offer: Throw away", width=em(BUTTON_WIDTH))
    imgui.end()
    if is_accepted:  # unless work of this window would be lost
        return question.before("Recover", partial(recovery.accept_found, session))
    if is_discarded:
        recovery.discard_found(session)
    return None
