"""Everything that is there while a mesh is marked, joined: what the window shows then."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from risorius import render

from ..command import Command
from ..export import Exporter
from ..gui import Gui
from ..messages import Message, Messages, Task
from ..painter import Painter
from ..panel_state import PanelState
from ..panels.menu_bar import MenuBar
from ..question import Question
from ..session import Session
from ..settings import Settings
from .marking import Marking
from .mouse import MarkingMouse
from .panel import MarkingPanel
from .picture import MarkingPicture, MarkingView


@dataclass(frozen=True)
class Lent:
    """What the window lends to a room."""

    surface: render.WindowSurface
    gui: Gui
    settings: Settings
    session: Session
    messages: Messages
    question: Question
    exporter: Exporter
    panels: PanelState


class Room:
    """A mesh that is marked, in the window."""

    def __init__(
        self,
        marking: Marking,
        lent: Lent,
        *,
        use: Callable[[Path, Path], Message],
        leave: Task,
        close: Task,
    ) -> None:
        """use: called with mesh and landmark file. leave, close: this room, the window."""
        self.marking = marking
        self._use, self._leave, self._question = use, leave, lent.question
        lent.question.other = marking
        self.view = MarkingView(marking, lent.settings, lent.surface)
        self.picture = MarkingPicture(marking, lent.surface)
        self.painter = Painter(self.picture, self.view, lent.exporter, lent.messages)
        self.mouse = MarkingMouse(self.view, lent.surface, marking, lent.messages)
        self.commands = self._commands(lent.settings, lent.panels, close)
        menus = MenuBar(lent.gui, lent.session, lent.messages, self.commands)
        self.panel = MarkingPanel(lent.gui, lent.messages, self.picture, self.mouse, menus)
        self.panel.commands = {command.label: command for command in self.commands}
        self._was_upright = marking.is_upright

    def paint(self, elapsed: float) -> bool:
        """Draw what has changed; turn to the face as soon as it is known where that is."""
        if self.marking.is_upright and not self._was_upright:
            self._was_upright = True
            self.view.fit_scene()
        return self.painter.paint(elapsed, has_moved=False, is_alive=False)

    def close(self) -> None:
        """Let go of what is on the GPU."""
        self._question.other = None
        self.picture.close()

    def use(self) -> Message:
        """Save the landmarks, and show the head with them."""
        marking = self.marking

        def go_on() -> Message:
            """Fit it, now that there is a file."""
            assert marking.file is not None
            return self._use(marking.path, marking.file)

        return go_on() if marking.file and not marking.unsaved else marking.save(go_on)

    def leave(self, then: Task | None = None) -> Message:
        """Back to the face, or to what comes `then`; if marks would be lost, ask first."""
        return self._question.before("Leave", then or self._leave, is_of_other=True)

    def _step(self, direction: int) -> None:
        self.marking.go(direction)
        self.view.look_at(self.marking.current)

    def _turn(self, axis: int) -> None:
        """Turn the mesh about the axis of the mesh that is nearest to one of the picture's."""
        direction = self.view.camera.axes()[axis]
        nearest = int(np.abs(direction).argmax())
        self.marking.turn(np.sign(direction[nearest]) * np.eye(3)[nearest])
        self.view.fit_scene()

    def _commands(self, settings: Settings, panels: PanelState, close: Task) -> tuple[Command, ...]:
        """All that a key or a menu does here."""
        marking, view = self.marking, self.view
        file, edit = partial(Command, "File"), partial(Command, "Edit")
        guessed = partial(Command, "Landmarks", can_run=lambda: marking.can_guess)
        look = partial(Command, "View")
        return (
            file("Open landmarks ...", "Ctrl+O", marking.ask_open),
            file("Save landmarks", "Ctrl+S", marking.save),
            file("Save landmarks as ...", "Ctrl+Shift+S", marking.save_as),
            file(
                "Use this head", "Ctrl+Enter", self.use, can_run=lambda: marking.marks.is_complete
            ),
            file("Leave", "Ctrl+W", self.leave),
            file("Quit", "Ctrl+Q", close),
            edit("Undo", "Ctrl+Z", marking.undo, can_run=lambda: marking.can_undo),
            edit("Redo", "Ctrl+Shift+Z", marking.redo, can_run=lambda: marking.can_redo),
            guessed("Next point", "Tab", partial(self._step, 1), other_key="Right"),
            guessed("Point before", "Shift+Tab", partial(self._step, -1), other_key="Left"),
            guessed("Mirror this group", "M", marking.mirror),
            guessed("Mirror the whole side", "Shift+M", partial(marking.mirror, whole=True)),
            guessed("Guess again", "G", marking.guess),
            look("Frame the face", "F", view.fit_scene),
            look("Tip the mesh", "T", partial(self._turn, 0)),
            look("Roll the mesh", "R", partial(self._turn, 2)),
            look("Dark theme", "F2", settings.toggle_theme, lambda: settings.theme == "dark"),
            look("Larger words", "Ctrl+Equal", partial(settings.enlarge, 1.1)),
            look("Smaller words", "Ctrl+Minus", partial(settings.enlarge, 1.0 / 1.1)),
            Command("Help", "Keys and mouse", "F1", panels.toggle_help),
        )
