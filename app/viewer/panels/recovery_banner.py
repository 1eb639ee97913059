"""One line above the face: what the window that was open before had not saved."""

from __future__ import annotations

import time
from functools import partial

from imgui_bundle import imgui

from ..gui import NOTE_FLAGS, Gui, em
from ..messages import Messages, Task
from ..question import Question
from ..recovery import Recovery
from ..session import Session
from ..view import View
from .widgets import button

BUTTON_WIDTH = 7.0  # [em]


class RecoveryBanner:
    """Offers what was left behind, until it is taken or thrown away."""

    def __init__(
        self, gui: Gui, recovery: Recovery, session: Session, question: Question, view: View
    ) -> None:
        self._gui, self._recovery, self._view = gui, recovery, view
        take = partial(recovery.take_found, session)
        self._choices: dict[str, Task] = {
            "Recover": partial(question.before, "Recover", take),  # work of now may be lost
            "Throw away": partial(recovery.drop_found, session),
        }

    def draw(self, messages: Messages) -> None:
        """Draw the line, if there is something to offer."""
        recovery = self._recovery
        if recovery.found is None:
            return
        when = time.strftime("%Y-%m-%d %H:%M", time.localtime(recovery.found_at))
        left, top, width, _ = self._view.area
        imgui.set_next_window_pos(
            imgui.ImVec2(left + 0.5 * width, top + em(0.8)), 0, imgui.ImVec2(0.5, 0.0)
        )
        room = max(width - em(1.6), em(BUTTON_WIDTH))
        imgui.set_next_window_size_constraints(imgui.ImVec2(0.0, 0.0), imgui.ImVec2(room, em(20)))
        imgui.begin("##offer", None, NOTE_FLAGS)
        imgui.push_text_wrap_pos(room - em(0.8))
        imgui.align_text_to_frame_padding()
        imgui.text_unformatted(f"Unsaved work of {when}: {recovery.found.words}")
        imgui.pop_text_wrap_pos()
        has_room = imgui.get_item_rect_size().x + em(2.0 * BUTTON_WIDTH + 3.0) < room
        for label, run in self._choices.items():
            if label != "Recover" or has_room:
                imgui.same_line()
            if button(self._gui, label, name=f"offer: {label}", width=em(BUTTON_WIDTH)):
                messages.attempt(run)
        imgui.end()
