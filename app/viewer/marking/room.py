"""Everything that is there while a mesh is marked, joined: what the window shows then."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial

import numpy as np

from risorius.assets.fitting.guess import axes_turned

from ..context import ApplicationContext
from ..interface.commands import Command, MenuBar
from ..messages import Message, Task
from ..picture.painter import Painter
from .marking import Marking
from .mouse import MarkingMouse
from .panel import MarkingPanel
from .picture import MarkingPicture, MarkingView, yaw_of

QUARTER = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])  # clockwise, as seen
SHARED = ("Quit", "Dark theme", "Larger text", "Smaller text", "Usual size", "Keys and mouse")


class Room:
    """A mesh that is marked, in the window."""

    def __init__(
        self,
        marking: Marking,
        app: ApplicationContext,
        others: Iterable[Command],
        open_files: Callable[[Sequence[str]], Message],
        leave: Callable[[], None],
    ) -> None:
        """others: the window's own commands. leave: goes back to the face."""
        self.marking, self._question = marking, app.question
        self._open_files, self._leave = open_files, leave
        gui, surface, messages = app.gui, app.surface, app.messages
        self.view = MarkingView(marking, app.settings, surface)
        self.picture = MarkingPicture(marking, surface)
        self.painter = Painter(self.picture, self.view, messages)
        self.mouse = MarkingMouse(self.view, surface, marking, messages)
        shared = [command for command in others if command.label in SHARED]
        self.commands = (*self._commands(), *shared)
        by_label = {command.label: command for command in self.commands}
        menus = MenuBar(gui, messages, self.commands, lambda: app.session.unsaved)
        self.panel = MarkingPanel(gui, messages, self.picture, menus, by_label)
        self._was_upright = marking.is_upright

    def paint(self, elapsed: float) -> bool:
        """Draw what has changed; turn to the face as soon as it is known where that is."""
        if self.marking.is_upright and not self._was_upright:
            self._was_upright = True
            self.view.fit_scene()
        return self.painter.paint(elapsed, has_moved=False, is_alive=False)

    def use(self) -> Message:
        """Save the landmarks, and show the head with them."""
        marking = self.marking
        if marking.file is None or marking.unsaved:
            return marking.save(self.use)
        return self._open_files([str(marking.path), str(marking.file)])

    def leave(self, then: Task = lambda: None) -> Message:
        """Back to the face, and on; if marks would be lost, ask first."""

        def go() -> Message:
            """Do so."""
            self._leave()
            return then()

        return self._question.before("Leave", go, other=self.marking)

    def _step(self, direction: int) -> None:
        """To another landmark, whose side may be turned away."""
        self.marking.go(direction)
        self.view.camera.yaw, self.view.camera.pitch = yaw_of(self.marking.current), 0.0

    def _straighten(self, roll: int = 0) -> None:
        """Let what is seen now be the front, upright; or turned by so many right angles to it."""
        seen = np.linalg.matrix_power(QUARTER, roll) @ np.array(self.view.camera.axes())
        self.marking.turn(max(axes_turned(), key=lambda turn: float((turn * seen).sum())))
        self.view.fit_scene()

    def _commands(self) -> tuple[Command, ...]:
        """All that a key or a menu does here."""
        marking, view = self.marking, self.view
        file, edit = partial(Command, "File"), partial(Command, "Edit")
        complete = partial(Command, can_run=lambda: marking.marks.is_complete)
        landmarks = partial(complete, "Landmarks")
        turned = partial(Command, "View", can_run=lambda: not marking.is_upright)
        history = marking.history
        return (
            file("Open landmarks ...", "Ctrl+O", marking.ask_open),
            file("Save landmarks", "Ctrl+S", marking.save),
            complete("File", "Use this head", "Ctrl+Enter", self.use),
            file("Leave", "Ctrl+W", self.leave),
            edit("Undo", "Ctrl+Z", marking.undo, can_run=lambda: history.can_undo),
            edit("Redo", "Ctrl+Y", marking.redo, None, lambda: history.can_redo, "Ctrl+Shift+Z"),
            turned("Upright", "U", self._straighten),
            turned("Turn 90 degrees", "T", partial(self._straighten, 1)),
            landmarks("Next point", "Right", partial(self._step, 1)),
            landmarks("Point before", "Left", partial(self._step, -1)),
            landmarks("Mirror this group", "M", marking.mirror),
            landmarks("Guess again", "G", marking.guess),
            Command("View", "Frame the face", "F", view.fit_scene),
        )
