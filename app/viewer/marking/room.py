"""Everything that is there while a mesh is marked, joined; the mouse on it, and its commands."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import Any

import numpy as np
from imgui_bundle import imgui

from risorius import render
from risorius.assets.fitting.guess import axes_turned
from risorius.sim.landmarks import MIRRORED

from ..context import ApplicationContext
from ..interface.commands import Command, MenuBar
from ..interface.gui import LEFT, em
from ..messages import Message, Messages, Task
from ..picture.mouse import CameraMouse
from ..picture.painter import Painter
from ..picture.skin import Ray, skin_under
from ..picture.stage import Stage
from .marking import Marking
from .view import MarkingPanel, MarkingView, MeshScene

SHARED = ("Quit", "Dark theme", "Larger text", "Smaller text", "Usual size", "Keys and mouse")
REACH = 0.8  # [em] around a mark in which the mouse takes it
ASIDE = 40.0  # [degrees] from which a landmark is seen that the front hides
QUARTER = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])  # of a turn in the picture


class MarkingMouse(CameraMouse):
    """A click places the current mark, a drag moves one, or turns the camera."""

    def __init__(
        self, view: MarkingView, surface: render.WindowSurface, marking: Marking, messages: Messages
    ) -> None:
        super().__init__(view, surface)
        self._seen, self._marking, self._messages = view, marking, messages

    def _hover(self, io: Any) -> None:
        if self._mark_under(io) is not None:
            imgui.set_mouse_cursor(imgui.MouseCursor_.hand)

    def _take(self, io: Any) -> str:
        pointed = self._mark_under(io)
        if pointed is None:
            return "orbit"
        self._marking.current = pointed
        return "mark"

    def _drag(self, io: Any) -> None:
        if not self._has_moved(io):
            return
        if self._doing == "mark":
            point = self._skin(io)
            if point is not None:
                self._marking.put(self._marking.current, point)
        super()._drag(io)

    def _release(self, io: Any) -> None:
        if self._doing == "mark":
            self._messages.attempt(self._marking.note)
        elif self._doing == "orbit" and imgui.is_mouse_released(LEFT) and not self._has_moved(io):
            point = self._skin(io)
            if point is None:
                self._messages.say("There is no skin here; click on the mesh")
            else:
                self._marking.put(self._marking.current, point)
                self._messages.attempt(self._marking.note)
        self.forget()

    def _skin(self, io: Any) -> Any:
        """The point of the mesh under the mouse, or None."""
        ray = Ray.through(self._view.camera, self._view.viewport, self._place(io))
        marking = self._marking
        return skin_under(ray, marking.positions, marking.faces, from_outside=False)

    def _mark_under(self, io: Any) -> int | None:
        # Of marks in one place, as on lips that touch, the current one is meant.
        off = {
            number: math.dist(spot, io.mouse_pos) - em(0.3) * (number == self._marking.current)
            for number, spot in self._seen.places().items()
        }
        nearest = min(off, key=lambda number: off[number], default=0)
        return nearest if off.get(nearest, math.inf) < em(REACH) else None


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
        stage = Stage(surface, MeshScene(marking), self.view.display, app.times)
        self.painter = Painter(stage, self.view, messages)
        self.mouse = MarkingMouse(self.view, surface, marking, messages)
        own, shared = self._commands(), [each for each in others if each.label in SHARED]
        self.commands = (*own, *shared)
        menus = MenuBar(gui, messages, self.commands, lambda: app.session.unsaved)
        self.panel = MarkingPanel(gui, messages, marking, menus, own)
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
        """To another landmark; if its side is turned away, the camera goes there."""
        self.marking.go(direction)
        number, camera = self.marking.current, self.view.camera
        if number not in self.view.places():
            aside = 0.0 if MIRRORED[number] == number else ASIDE
            camera.yaw = float(np.copysign(aside, self.marking.seen([number])[0][0, 0]))
            camera.pitch = 0.0

    def _straighten(self, roll: int = 0) -> None:
        """Let what is seen now be the front, upright; or turned by so many right angles to it."""
        seen = np.linalg.matrix_power(QUARTER, roll) @ np.array(self.view.camera.axes())
        self.marking.turn(max(axes_turned(), key=lambda turn: float((turn * seen).sum())))
        self.view.fit_scene()

    def _commands(self) -> tuple[Command, ...]:
        """All that a key or a menu does here alone."""
        marking, view = self.marking, self.view
        file, edit = partial(Command, "File"), partial(Command, "Edit")
        complete = partial(Command, can_run=lambda: marking.marks.is_complete)
        landmarks = partial(complete, "Landmarks")
        turned = partial(Command, "View", can_run=lambda: not marking.is_upright)
        history = marking.history
        return (
            complete("File", "Use this head", "Ctrl+Enter", self.use),
            file("Save landmarks", "Ctrl+S", marking.save),
            file("Open landmarks ...", "Ctrl+O", marking.ask_open),
            file("Leave", "Ctrl+W", self.leave),
            edit("Undo", "Ctrl+Z", marking.undo, can_run=lambda: history.can_undo),
            edit("Redo", "Ctrl+Y", marking.redo, None, lambda: history.can_redo, "Ctrl+Shift+Z"),
            turned("Upright", "U", self._straighten),
            turned("Turn 90 degrees", "T", partial(self._straighten, 1)),
            landmarks("Point before", "Left", partial(self._step, -1)),
            landmarks("Next point", "Right", partial(self._step, 1)),
            landmarks("Guess again", "G", marking.guess),
            Command("View", "Frame the face", "F", view.fit_scene),
        )
