"""Commands for scripts: begin, open, record, save; and the question before work is lost."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Protocol

from imgui_bundle import imgui

from ...errors import UserError
from ...performances import read_performance
from ...script import Script
from ...script.script_file import is_pose
from ...sound.decoding import with_sound
from ...text import as_text
from ..interface.gui import Gui
from ..interface.widgets import button, dialog
from ..messages import Message, Task
from ..session.session import Session
from .file_dialogs import SCRIPT_SUFFIX, FileDialogs

SOUND_SUFFIXES = (
    *(".wav", ".mp3", ".m4a", ".aac", ".flac", ".ogg", ".opus", ".aif", ".aiff", ".wma"),
    *(".mov", ".mp4", ".mkv", ".webm"),  # films with sound, such as a phone's
)


class Unsaved(Protocol):
    """Unsaved work outside the session, such as landmarks."""

    @property
    def unsaved(self) -> str:
        """The work that would be lost, in words; "" for nothing."""

    def save(self, then: Task) -> Message:
        """Save the work, then run `then`."""


class Question:
    """The question before unsaved work is lost: save it, discard it, or cancel."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self.task: Task | None = None  # the task that waits for the answer
        self.verb = ""  # the verb for the task, such as "Close"
        self.other: Unsaved | None = None  # the unsaved work, unless it is the session's

    @property
    def is_open(self) -> bool:
        """Whether the question is open."""
        return self.task is not None

    @property
    def unsaved(self) -> str:
        """The work that would be lost, in words; "" for nothing."""
        return (self.other or self._session.work).unsaved

    def before(self, verb: str, task: Task, other: Unsaved | None = None) -> Message:
        """Run `task`; if work is unsaved, first ask whether to save or discard it."""
        self.other = other
        if not self.unsaved:
            return task()
        self.task = task
        self.verb = verb
        return None


class ScriptCommands:
    """Opens and saves the session's script and pose, with dialogs where the user must choose.

    A command's `then` is a task to run after saving; it does not run if nothing was saved.
    """

    def __init__(
        self,
        session: Session,
        files: FileDialogs,
        question: Question,
        note_recent: Callable[..., object],
    ) -> None:
        """note_recent: a function for files that were opened together, or for a saved file."""
        self._session = session
        self._files = files
        self._question = question
        self.note_recent = note_recent

    def new(self) -> Message:
        """Begin with an empty script; ask first if the script or a recording would be lost."""

        def begin() -> Message:
            """Begin an empty script."""
            self._session.work.begin_script()
            return "A new script of this face; [Set key] keys the controls that you move"

        session = self._session
        if not (session.is_recording or session.work.script_is_unsaved):
            return begin()
        return self._question.before("Begin", begin)

    def ask_open(self) -> None:
        """Ask for a script, a pose or a recording, and show it."""
        title = "Open script, pose or recording"
        recording_suffixes = (".csv", ".json", ".tsv", ".txt")  # the content decides
        ends = (SCRIPT_SUFFIX, *recording_suffixes)
        self._files.open(title, self.open, saving=False, suffixes=ends)

    def open(self, path: Path, remark: str = "") -> Message:
        """Show the script, pose or recording of a file; if work would be lost, ask first.

        remark: text to add to the message about the opened file.
        """
        session = self._session
        limits = session.controls.limits if session.scene.name == "face" else None
        script, report = read_performance(path, limits=limits)
        self._check(script)

        def show() -> Message:
            """Show the content of the file."""
            session.work.open(script)
            self.note_recent(path)
            return f"{report.in_brief if report else f'{path.name}: opened'}{remark}"

        if is_pose(script) and not self._session.work.has_unsaved_pose:
            return show()  # opening a pose loses no unsaved script
        return self._question.before("Open", show)

    def _check(self, script: Script) -> None:
        """Raise UserError with the reason if this window cannot open a script or pose."""
        here = self._session.script.scene
        if script.scene != here:
            raise UserError(
                f"{script.source}: is for the scene '{script.scene}', and this window shows "
                f"'{here}': `risorius view --scene {script.scene} --script {script.source}`"
            )
        script.check(self._session.controls.limits)

    def save(self, then: Task = lambda: None) -> Message:
        """Write the script to its own file; ask for a file if there is none."""
        file = self._session.file
        if file.path is not None and not file.objection:
            return self._write(file.path, then)
        self.save_as(then)
        if file.path is None:
            return None
        return f"{file.path.name}: {file.objection}; replace it, or choose another name"

    def save_as(self, then: Task = lambda: None) -> None:
        """Ask for a name, and write the script."""
        path = self._session.file.path
        script = self._session.script
        name = "script.toml"
        if script.is_converted:
            name = f"{Path(script.source).stem}{SCRIPT_SUFFIX}"
        self._files.open(
            "Save script",
            lambda chosen: self._write(chosen, then),
            saving=True,
            proposed=str(path.absolute()) if path is not None else name,
        )

    def _write(self, path: Path, then: Task) -> Message:
        self._session.work.save_script(path)
        self.note_recent(path)
        apart = self._session.work.has_unsaved_pose
        rest = "; the pose is not part of it: K makes it a key" if apart else ""
        return then() or f"{path}: script written{rest}"

    def save_pose(self, then: Task = lambda: None) -> None:
        """Ask for a name, and write the pose."""

        def write(path: Path) -> Message:
            """Write the pose to a file."""
            self._session.work.save_pose(path)
            self.note_recent(path)
            return then() or f"{path}: pose written"

        self._files.open("Save pose", write, saving=True, proposed="pose.toml")

    def ask_sound(self) -> None:
        """Ask for a sound file, and add it to the script."""
        self._files.open("Open sound", self.set_sound, saving=False, suffixes=SOUND_SUFFIXES)

    def set_sound(self, path: Path) -> Message:
        """Add a sound file to the script; raises UserError if the file has no sound."""
        self._session.edit(with_sound(self._session.script, path))
        self.note_recent(path)
        return f"{path.name}: opened; Space plays it with the script"

    @property
    def has_sound(self) -> bool:
        """Whether the script has a sound."""
        return self._session.script.sound is not None

    def remove_sound(self) -> None:
        """Remove the script's sound."""
        self._session.edit(replace(self._session.script, sound=None))

    def toggle_recording(self) -> Message:
        """Begin to record the sliders into the script, or end the recording."""
        line = self._session.toggle_recording()
        return line if self._session.is_recording else f"{line}; [Save script] saves it"

    def save_recording(self, then: Task) -> Message:
        """End the recording, and save it."""
        line = self.toggle_recording()
        return self.save(then) or line


def draw_question(
    gui: Gui, question: Question, session: Session, scripts: ScriptCommands
) -> Message:
    """Draw the question, if there is one, and carry out the answer."""
    task = question.task
    verb = question.verb
    other = question.other
    if task is None:
        return None
    again = partial(question.before, verb, task, other)  # asks about further unsaved work
    choices: dict[str, Task] = {}
    if other is not None:
        choices["Save landmarks"] = partial(other.save, again)
    elif session.is_recording:
        choices["Save recording ..."] = partial(scripts.save_recording, again)
    elif session.work.script_is_unsaved:
        label = "Save script" if session.file.path else "Save script ..."
        choices[label] = partial(scripts.save, again)
    if other is None and session.work.has_unsaved_pose:
        choices["Save pose ..."] = partial(scripts.save_pose, again)
    choices |= {f"{verb} without saving": task, "Back": lambda: None}
    answer: Task | None = None
    with dialog("Unsaved work") as is_open:
        if not is_open:
            return None
        imgui.text(as_text(f"Not saved: {question.unsaved or 'nothing any more'}."))
        for label, run in choices.items():
            is_clicked = button(gui, label, name=f"question: {label}")
            imgui.same_line()
            if is_clicked or (label == "Back" and imgui.is_key_pressed(imgui.Key.escape)):
                answer = run
        if answer is None:
            return None
        imgui.close_current_popup()
    question.task = None
    return answer()
