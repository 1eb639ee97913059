"""What is asked in a box: what to do with unsaved work before it is lost, the name of a pose."""

from __future__ import annotations

from functools import partial

from imgui_bundle import imgui

from ...script import keyframes
from ..gui import Gui, em
from ..key_selection import KeySelection
from ..messages import Message, Messages, Task
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


class PoseNameLine:
    """A line for a pose's name, which comes up when one is asked for."""

    def __init__(
        self, gui: Gui, session: Session, messages: Messages, selection: KeySelection
    ) -> None:
        self._gui, self._session, self._messages = gui, session, messages
        self.selection = selection
        self._time, self._name = 0.0, ""  # [s] of the pose, and what is written so far

    def draw(self) -> None:
        """Draw it, if it is open or wanted."""
        pose, self.selection.pose_to_name = self.selection.pose_to_name, None
        if pose is not None:
            self._time, self._name = pose.time, pose.name or ""
            imgui.open_popup("pose name")
        if not imgui.begin_popup("pose name"):
            return
        imgui.text(f"Name of the pose at {self._time:.2f} s")
        if pose is not None:
            imgui.set_keyboard_focus_here()
        imgui.set_next_item_width(em(14.0))
        flags = imgui.InputTextFlags_.enter_returns_true | imgui.InputTextFlags_.auto_select_all
        is_entered, self._name = imgui.input_text_with_hint(
            "##name", "none: no picture on a sheet", self._name, flags
        )
        self._gui.remember("pose name")
        if is_entered:
            script = keyframes.renamed(self._session.script, self._time, self._name)
            self._messages.attempt(lambda: self._session.edit(script, "Name a pose"))
        if is_entered or imgui.is_key_pressed(imgui.Key.escape):
            imgui.close_current_popup()
        imgui.end_popup()
