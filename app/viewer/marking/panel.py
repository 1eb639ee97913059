"""The panel of the marking, with task, guide and buttons, and the marks over the mesh."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import pairwise

import numpy as np
from imgui_bundle import imgui

from risorius import assets
from risorius.assets.fitting.guess import FIRST_LANDMARKS
from risorius.sim.landmarks import MIRRORED_LANDMARKS

from ..interface.commands import Command, MenuBar, command_button
from ..interface.gui import Gui, colour, em, fixed_panel, ink_of
from ..interface.widgets import muted
from ..messages import Messages
from .marking import GROUP_OF, MARKING_GROUPS, Marking
from .picture import MarkingView, ScreenPoint

DARK_INK = (0.08, 0.08, 0.10)
WHITE_INK = (1.0, 1.0, 1.0)
POINT_NAMES = {  # names of the first points
    **{36: "Outer corner of the right eye", 45: "Outer corner of the left eye"},
    **{30: "Tip of the nose", 48: "Right corner of the mouth", 54: "Left corner of the mouth"},
    **{19: "Middle of the right brow"},
}
SIDE_NAMES = {
    -1.0: "the person's right: on your left as the face looks at you",
    0.0: "in the middle of the face",
    1.0: "the person's left: on your right as the face looks at you",
}


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
        """commands: the commands that get buttons."""
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
            pen.add_circle_filled(at[number], em(0.12), ink_of(WHITE_INK))
        for number in at.keys() & {*GROUP_OF[current].numbers}:
            x = at[number][0] + em(0.45)
            y = at[number][1] - em(0.95)
            pen.add_text((x + em(0.07), y + em(0.07)), ink_of(DARK_INK), str(number))
            pen.add_text((x, y), ink_of(WHITE_INK), str(number))
        pen.pop_clip_rect()

    def _draw_task(self) -> None:
        marking = self._marking
        is_complete = self._marking.marks.is_complete
        number = marking.current
        muted(self._gui, marking.path.name)
        if number in FIRST_LANDMARKS and not is_complete:
            step = f"First points: {FIRST_LANDMARKS.index(number) + 1} of {len(FIRST_LANDMARKS)}"
            name = POINT_NAMES[number]
        else:
            step = GROUP_OF[number].title.capitalize()
            name = f"Point {number}"
        imgui.text_colored(colour(self._gui.theme.accent), step)
        imgui.text_wrapped(name)
        side = (
            0.0 if MIRRORED_LANDMARKS[number] == number else float(np.sign(self._guide[number, 0]))
        )
        muted(self._gui, SIDE_NAMES[side])
        imgui.spacing()
        first_advice = (
            "Click the point on the skin that the guide shows. Where the head does not look at "
            "you, drag it with the mouse until it does, and press Turn until it stands upright. "
            "The wheel zooms, the middle button moves."
        )
        later_advice = (
            "Drag wrong points to their place; a click on the skin moves this one. "
            "White inside: guessed, and not moved yet."
        )
        imgui.text_wrapped(later_advice if is_complete else first_advice)
        imgui.spacing()

    def _draw_guide(self) -> None:
        """Draw a diagram of all points, or of one group at the end, with the current point."""
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
        points = np.array([low.x, low.y]) + 0.5 * np.array(size) + scale * (self._guide - middle)
        at = {n: (float(x), float(y)) for n, (x, y) in enumerate(points) if n in numbers}
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
    pen: imgui.ImDrawList, at: Mapping[int, ScreenPoint], current: int, *, joined: bool
) -> None:
    """Draw points with a dark border, the lines of groups, and a ring around the current point."""
    for group in MARKING_GROUPS if joined else ():
        for a, b in (pair for line in group.lines for pair in pairwise(line)):
            if a in at and b in at:
                pen.add_line(at[a], at[b], ink_of(group.colour, 0.75), em(0.1))
    for number, point in at.items():
        radius = em(0.34 if number == current else 0.22)
        pen.add_circle_filled(point, radius + em(0.08), ink_of(DARK_INK))
        pen.add_circle_filled(point, radius, ink_of(GROUP_OF[number].colour))
    if current in at:
        pen.add_circle(at[current], em(0.62), ink_of(WHITE_INK), 0, em(0.12))
