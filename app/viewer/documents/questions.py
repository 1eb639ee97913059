"""What is asked about unsaved work: before it is lost, and where another window left some."""

from __future__ import annotations

import time
from functools import partial

from imgui_bundle import imgui

from ..interface.gui import NOTE_FLAGS, Gui, em
from ..interface.widgets import button
from ..messages import Message, Task
from ..picture.view import View
from ..session.recovery import Recovery
from ..session.session import Session
from .scripts import Question, ScriptCommands

UNSAVED = "Unsaved work"


def draw_question(
    gui: Gui, question: Question, session: Session, scripts: ScriptCommands
) -> Message:
    """Draw the question, if there is one, and go on with what was answered."""
    task, verb = question.task, question.verb
    if task is None:
        return None
    if not imgui.is_popup_open(UNSAVED):
        imgui.open_popup(UNSAVED)
    is_open, _ = imgui.begin_popup_modal(UNSAVED, None, imgui.WindowFlags_.always_auto_resize)
    if not is_open:
        return None
    imgui.text(f"Not saved: {question.unsaved or 'nothing any more'}.")
    again = partial(question.before, verb, task, question.other)  # there may be more to save
    choices: tuple[tuple[str, bool, Task], ...]
    if question.other is not None:
        choices = (("Save landmarks", True, partial(question.other.save, again)),)
    else:
        choices = (
            ("Save recording ...", session.is_recording, partial(scripts.save_recording, again)),
            (
                "Save script" if session.file.path else "Save script ...",
                session.script_is_unsaved and not session.is_recording,
                partial(scripts.save, again),
            ),
            ("Save pose ...", session.has_unsaved_pose, partial(scripts.save_pose, again)),
        )
    choices = *choices, (f"{verb} without saving", True, task), ("Back", True, lambda: None)
    answer: Task | None = None
    for label, is_possible, run in choices:
        if not is_possible:
            continue
        is_clicked = button(gui, label, name=f"question: {label}")
        imgui.same_line()
        if is_clicked or (label == "Back" and imgui.is_key_pressed(imgui.Key.escape)):
            answer = run
    if answer is not None:
        question.task = None
        imgui.close_current_popup()
    imgui.end_popup()
    return answer() if answer is not None else None


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
