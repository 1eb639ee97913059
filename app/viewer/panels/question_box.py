"""What the question before work is lost looks like."""

from __future__ import annotations

from functools import partial

from imgui_bundle import imgui

from ..gui import Gui
from ..messages import Message, Task
from ..question import Question
from ..script_commands import ScriptCommands
from ..session import Session
from .widgets import button

TITLE = "Unsaved work"


def draw_question(
    gui: Gui, question: Question, session: Session, scripts: ScriptCommands
) -> Message:
    """Draw the question, if there is one, and go on with what was answered."""
    task, verb = question.task, question.verb
    if task is None:
        return None
    if not imgui.is_popup_open(TITLE):
        imgui.open_popup(TITLE)
    is_open, _ = imgui.begin_popup_modal(TITLE, None, imgui.WindowFlags_.always_auto_resize)
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
    choices = (
        *choices,
        (f"{verb} without saving", True, task),
        ("Back", True, lambda: None),
    )
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
