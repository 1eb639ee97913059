"""A mesh that is marked, in the window: the picture, the questions, the mouse, commands."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt
from imgui_bundle import imgui

from risorius import assets, render
from risorius.assets.fitting.guess import FIRST, axes_turned
from risorius.sim.landmarks import MIRRORED

from ...passes.labels import CameraLabels
from ...refining.presets import STATIC
from ..context import ApplicationContext
from ..interface.commands import Command, MenuBar, command_button
from ..interface.gui import LEFT, Gui, colour, em, fixed_panel, ink_of
from ..interface.widgets import muted
from ..messages import Message, Messages, Task
from ..picture.mouse import CameraMouse
from ..picture.stage import Painter, Stage, View
from ..settings import Display, Settings
from .marking import GROUP_OF, GROUPS, Marking

DARK = (0.08, 0.08, 0.10)
WHITE = (1.0, 1.0, 1.0)
POINT_NAMES = {  # of the first points
    **{36: "Outer corner of the right eye", 45: "Outer corner of the left eye"},
    **{30: "Tip of the nose", 48: "Right corner of the mouth", 54: "Left corner of the mouth"},
}
SIDE_NAMES = {
    -1.0: "the person's right: on your left as the face looks at you",
    0.0: "in the middle of the face",
    1.0: "the person's left: on your right as the face looks at you",
}

Spot = tuple[float, float]  # [window units]


class MarkingView(View):
    """How the mesh is seen: as clay, by a camera that frames all of it."""

    def __init__(self, marking: Marking, settings: Settings, surface: render.WindowSurface) -> None:
        self._marking = marking
        self._settings = settings
        self._surface = surface
        self.area = (0.0, 0.0, 1.0, 1.0)
        self.pointed = {}
        self.fit_scene()

    def fit_scene(self) -> None:
        marking = self._marking
        self.camera = render.OrbitCamera.framing(marking.positions)
        if marking.is_upright:  # all of the face, however much there is of hair and shoulders
            self.camera.fit(marking.seen(marking.marks.places)[0], 0.14)

    @property
    def display(self) -> Display:
        return Display(skin="clay", refiner=STATIC)

    @property
    def state(self) -> object:
        return super().state, id(self._marking.positions)

    def places(self) -> dict[int, Spot]:
        """The places of the marks on the visible side, by number."""
        numbers = list(self._marking.marks.places)
        points, normals = self._marking.seen(numbers)
        spots = places_in(self.area, self.camera, points)
        to_eye = self.camera.eye - points
        toward = np.einsum("nki,ni->nk", normals, to_eye).max(axis=1)
        toward /= np.linalg.norm(to_eye, axis=1)
        least_facing_cosine = 0.15  # cosine to the line of sight beyond which a mark is seen
        faces = toward > least_facing_cosine
        return {n: spots[index] for index, n in enumerate(numbers) if faces[index]}


class MarkingPanel:
    """Draws the task, the buttons, and the points over the mesh."""

    def __init__(
        self,
        gui: Gui,
        messages: Messages,
        marking: Marking,
        menus: MenuBar,
        commands: Iterable[Command],
    ) -> None:
        """commands: those that get buttons."""
        self._gui = gui
        self._messages = messages
        self._marking = marking
        self._menus = menus
        self._commands = tuple(commands)
        head = assets.load("head")
        self._guide = head.vertices[head.landmarks][:, :2] * (1.0, -1.0)

    def draw(self, view: MarkingView) -> None:
        """Draw everything, and give the view its place."""
        display = imgui.get_io().display_size
        top = self._menus.draw()
        left = round(min(em(21.0), 0.4 * display.x))  # the panel's width
        view.area = (left, top, max(display.x - left, 1.0), max(display.y - top, 1.0))
        with fixed_panel("Controls", (0.0, top), (left, display.y - top)):
            imgui.push_text_wrap_pos(0.0)
            self._draw_task()
            self._draw_guide()
            self._draw_buttons()
            imgui.pop_text_wrap_pos()
        marks = self._marking.marks
        current = self._marking.current
        pen = imgui.get_background_draw_list()
        at = view.places()
        pen.push_clip_rect((left, top), (display.x, display.y))
        _draw_points(pen, at, current, joined=marks.is_complete)
        for number in marks.guessed & at.keys():
            pen.add_circle_filled(at[number], em(0.12), ink_of(WHITE))
        for number in at.keys() & {*GROUP_OF[current].numbers}:
            x = at[number][0] + em(0.45)
            y = at[number][1] - em(0.95)
            pen.add_text((x + em(0.07), y + em(0.07)), ink_of(DARK), str(number))
            pen.add_text((x, y), ink_of(WHITE), str(number))
        pen.pop_clip_rect()

    def _draw_task(self) -> None:
        marking = self._marking
        is_complete = self._marking.marks.is_complete
        number = marking.current
        muted(self._gui, marking.path.name)
        if number in FIRST and not is_complete:
            step = f"First points: {FIRST.index(number) + 1} of {len(FIRST)}"
            name = POINT_NAMES[number]
        else:
            step = GROUP_OF[number].title.capitalize()
            name = f"Point {number}"
        imgui.text_colored(colour(self._gui.theme.accent), step)
        imgui.text_wrapped(name)
        side = 0.0 if MIRRORED[number] == number else float(np.sign(self._guide[number, 0]))
        muted(self._gui, SIDE_NAMES[side])
        imgui.spacing()
        first_advice = (
            "Click the point on the skin that the guide shows. Where the head does not look at "
            "you, drag it with the mouse until it does, and press Turn until it stands upright. "
            "The wheel zooms, the middle button moves."
        )
        later_advice = (
            "Drag points that are not where they belong; a click on the skin moves this one. "
            "White inside: guessed, and not moved yet."
        )
        imgui.text_wrapped(later_advice if is_complete else first_advice)
        imgui.spacing()

    def _draw_guide(self) -> None:
        """Draw the current point among those of a face, its group as large as possible."""
        current = self._marking.current
        is_complete = self._marking.marks.is_complete
        low = imgui.get_cursor_screen_pos()
        size = (imgui.get_content_region_avail().x, em(11.0))
        imgui.dummy(size)
        numbers = list(GROUP_OF[current].numbers) if is_complete else range(len(self._guide))
        shown = self._guide[numbers]
        middle = 0.5 * (shown.max(axis=0) + shown.min(axis=0))
        spread = np.ptp(shown, axis=0)
        scale = 0.8 * float(np.min(np.array(size) / np.maximum(spread, 1e-9)))
        spots = np.array([low.x, low.y]) + 0.5 * np.array(size) + scale * (self._guide - middle)
        at = {n: (float(x), float(y)) for n, (x, y) in enumerate(spots) if n in numbers}
        _draw_points(imgui.get_window_draw_list(), at, current, joined=True)

    def _draw_buttons(self) -> None:
        """Draw a button for each command, two in a row."""
        spacing = imgui.get_style().item_spacing.x
        width = 0.5 * (imgui.get_content_region_avail().x - spacing)
        for index, command in enumerate(self._commands):
            if index % 2:
                imgui.same_line()
            command_button(self._gui, self._messages, command, width=width)


def _draw_points(
    pen: imgui.ImDrawList, at: Mapping[int, Spot], current: int, *, joined: bool
) -> None:
    """Draw points with a dark border, joined by the lines of groups, a ring around one."""
    for group in GROUPS if joined else ():
        for a, b in (pair for line in group.lines for pair in pairwise(line)):
            if a in at and b in at:
                pen.add_line(at[a], at[b], ink_of(group.colour, 0.75), em(0.1))
    for number, spot in at.items():
        radius = em(0.34 if number == current else 0.22)
        pen.add_circle_filled(spot, radius + em(0.08), ink_of(DARK))
        pen.add_circle_filled(spot, radius, ink_of(GROUP_OF[number].colour))
    if current in at:
        pen.add_circle(at[current], em(0.62), ink_of(WHITE), 0, em(0.12))


def places_in(
    area: tuple[float, float, float, float], camera: render.OrbitCamera, points: npt.ArrayLike
) -> list[Spot]:
    """Where a camera that fills an area of the window sees points (n, 3) [window units]."""
    left, top, width, height = area
    seen = CameraLabels.of(camera, (width, max(height, 1.0))).project(np.asarray(points))
    return [(left + x, top + y) for x, y in seen.tolist()]


class MarkingMouse(CameraMouse):
    """A click places the current mark, a drag moves one, or turns the camera."""

    def __init__(
        self, view: MarkingView, stage: Stage, marking: Marking, messages: Messages
    ) -> None:
        super().__init__(view, stage)
        self._seen = view
        self._marking = marking
        self._messages = messages

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
            self._put(io)
        super()._drag(io)

    def _release(self, io: Any) -> None:
        is_click = self._doing == "orbit" and imgui.is_mouse_released(LEFT)
        is_click = is_click and not self._has_moved(io)
        if is_click and not self._put(io):
            self._messages.say("No skin looks at you here, as in a mouth or eye; click beside it")
        elif is_click or self._doing == "mark":
            self._messages.carry_out(self._marking.note)
        self.forget()

    def _put(self, io: Any) -> bool:
        """Place the current mark under the mouse; whether there is skin on which it is seen."""
        marking = self._marking
        before = self._marking.marks
        point = self._skin_under(io)
        if point is None:
            return False
        marking.put(marking.current, point)
        is_seen = marking.current in self._seen.places()
        marking.marks = marking.marks if is_seen else before
        return is_seen

    def _mark_under(self, io: Any) -> int | None:
        # Of marks in one place, as on lips that touch, the current one is meant.
        off = {
            number: math.dist(spot, io.mouse_pos) - em(0.3) * (number == self._marking.current)
            for number, spot in self._seen.places().items()
        }
        nearest = min(off, key=lambda number: off[number], default=0)
        mark_reach = 0.8  # [em] around a mark in which the mouse takes it
        return nearest if off.get(nearest, math.inf) < em(mark_reach) else None


class MarkingMode:
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
        shared_commands = ("Quit", "Dark theme", "Larger text", "Smaller text", "Usual size")
        shared = [each for each in others if each.label in shared_commands]
        self.commands = (*own, *shared)
        menus = MenuBar(gui, messages, self.commands, lambda: app.session.work.unsaved)
        self.panel = MarkingPanel(gui, messages, marking, menus, own)
        self._placing = marking.placing

    def paint(self, elapsed: float) -> bool:
        """Draw the mesh if it has changed; from the front if it stands in another way now."""
        if self.marking.placing is not self._placing:
            self._placing = self.marking.placing
            self.view.fit_scene()
        return self.painter.paint(elapsed, has_moved=False, is_alive=False)

    def use(self) -> Message:
        """Save the landmarks, and show the head with them."""
        marking = self.marking
        if marking.file is None or marking.unsaved:
            return marking.save(self.use)
        return self._open_files([str(marking.path), str(marking.file)])

    def leave(self, then: Task = lambda: None) -> Message:
        """Go back to the face, and run `then`; if marks would be lost, ask first."""

        def go() -> Message:
            """Do so."""
            self._leave()
            return then()

        return self._question.before("Leave", go, other=self.marking)

    def _step(self, direction: int) -> None:
        """Go to another landmark; if its side is turned away, the camera goes there."""
        self.marking.go(direction)
        number = self.marking.current
        camera = self.view.camera
        if number not in self.view.places():
            side_view_yaw = 40.0  # [degrees] from which a landmark is seen that the front hides
            aside = 0.0 if MIRRORED[number] == number else side_view_yaw
            camera.yaw = float(np.copysign(aside, self.marking.seen([number])[0][0, 0]))
            camera.pitch = 0.0

    def _turn(self) -> None:
        """Make the side that is seen the front; if it is so already, turn it by a right angle."""
        seen = np.array(self.view.camera.axes())
        turn = max(axes_turned(), key=lambda turn: float((turn * seen).sum()))
        # Of the picture, about the line of sight.
        quarter_turn = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
        self.marking.turn(quarter_turn if np.array_equal(turn, np.eye(3)) else turn)

    def _commands(self) -> tuple[Command, ...]:
        """The commands of this mode alone."""
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
