"""The mode that marks a mesh in place of the face: its picture, panel, mouse and commands."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from risorius.assets.fitting.guess import axes_turned
from risorius.sim.landmarks import MIRRORED_LANDMARKS

from ..context import ApplicationContext
from ..documents.file_drop import LANDMARKS_SUFFIX
from ..interface.commands import Command, MenuBar
from ..messages import Message, Task
from ..picture.stage import Painter, Stage
from .marking import Marking
from .panel import MarkingPanel
from .picture import MarkingMouse, MarkingView


class MarkingMode:
    """The mode of the window in which a mesh is marked; see `Mode`."""

    draws_over_picture = True  # the panel draws marks there
    is_at_rest = True
    is_idling = False
    has_news = False

    def __init__(
        self,
        marking: Marking,
        app: ApplicationContext,
        others: Iterable[Command],
        open_files: Callable[[Sequence[str]], Message],
        leave: Callable[[], None],
    ) -> None:
        """others: the face's commands; some belong to both modes. leave: returns to the face."""
        self.marking = marking
        self._question = app.question
        self._open_files = open_files
        self._leave = leave
        gui = app.gui
        surface = app.surface
        messages = app.messages
        self.view = MarkingView(marking, app.settings, surface)
        stage = Stage(surface, marking.seen_mesh, self.view.display, app.times)
        self.painter = Painter(stage, self.view, messages)
        self.mouse = MarkingMouse(self.view, stage, marking, messages)
        own = self._commands()
        sizes = ("Larger text", "Smaller text", "Default size")
        shared_commands = ("Quit", "Dark theme", *sizes, "Manual")
        shared = [each for each in others if each.label in shared_commands]
        self.commands = (*own, *shared)
        menus = MenuBar(gui, messages, self.commands, lambda: app.session.work.unsaved)
        self._panel = MarkingPanel(gui, messages, marking, menus, own)
        self._placing = marking.placing

    @property
    def name(self) -> str:
        """The name of the mesh's file."""
        return self.marking.path.name

    @property
    def unsaved(self) -> str:
        """The unsaved landmarks, in words; "" for none."""
        return self.marking.unsaved

    def paint(self, elapsed: float) -> bool:
        """Draw the mesh if it has changed; after a turn, show it from the front."""
        if self.marking.placing is not self._placing:
            self._placing = self.marking.placing
            self.view.fit_scene()
        return self.painter.paint(elapsed, has_moved=False, is_alive=False)

    def draw_panels(self) -> None:
        """Draw the panel and the marks, and give the picture its place."""
        self._panel.draw(self.view)

    def rest(self) -> None:
        """Do nothing: no sound plays during the marking."""

    def drop(self, paths: Sequence[str]) -> Message:
        """Open landmarks of a file; for other files, leave the marking first."""
        if [Path(path).suffix for path in paths] == [LANDMARKS_SUFFIX]:
            return self.marking.open(Path(paths[0]))
        return self.leave(partial(self._open_files, paths))

    def use(self) -> Message:
        """Save the landmarks, and show the head with them."""
        marking = self.marking
        if marking.file is None or marking.unsaved:
            return marking.save(self.use)
        return self._open_files([str(marking.path), str(marking.file)])

    def leave(self, then: Task = lambda: None) -> Message:
        """Return to the face, and run `then`; if marks would be lost, ask first."""

        def go() -> Message:
            """Show the face, then run `then`."""
            self._leave()
            return then()

        return self._question.before("Leave", go, other=self.marking)

    def _step(self, direction: int) -> None:
        """Go to another landmark; if it is hidden, turn the camera to its side."""
        self.marking.step(direction)
        number = self.marking.current
        camera = self.view.camera
        if number not in self.view.places():
            side_view_yaw = 40.0  # [degrees], for a landmark that the front view hides
            aside = 0.0 if MIRRORED_LANDMARKS[number] == number else side_view_yaw
            camera.yaw = float(np.copysign(aside, self.marking.seen([number])[0][0, 0]))
            camera.pitch = 0.0

    def _turn(self) -> None:
        """Make the visible side the front; if it is the front already, turn it by a right angle."""
        seen = np.array(self.view.camera.axes())
        to_front = max(axes_turned(), key=lambda axes: float((axes * seen).sum()))
        is_front = np.array_equal(to_front, np.eye(3))
        # A right angle about the line of sight.
        quarter_turn = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
        self.marking.turn(quarter_turn if is_front else to_front)

    def _commands(self) -> tuple[Command, ...]:
        """Return the commands that only this mode has."""
        marking = self.marking
        view = self.view
        file = partial(Command, "File")
        edit = partial(Command, "Edit")
        complete = partial(Command, can_run=lambda: marking.marks.is_complete)
        landmarks = partial(complete, "Landmarks")
        history = marking.history
        redo = partial(edit, can_run=lambda: history.can_redo)
        return (
            complete("File", "Use this head", "Ctrl+Enter", self.use),
            file("Save landmarks", "Ctrl+S", marking.save),
            file("Open landmarks ...", "Ctrl+O", marking.ask_open),
            file("Leave", "Ctrl+W", self.leave),
            edit("Undo", "Ctrl+Z", marking.undo, can_run=lambda: history.can_undo),
            redo("Redo", "Ctrl+Y, Ctrl+Shift+Z", partial(marking.undo, -1)),
            Command("View", "Turn", "T", self._turn, can_run=lambda: not marking.is_upright),
            landmarks("Point before", "Left", partial(self._step, -1)),
            landmarks("Next point", "Right", partial(self._step, 1)),
            landmarks("Guess again", "G", marking.guess),
            Command("View", "Frame the face", "F", view.fit_scene),
        )
