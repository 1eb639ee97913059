"""What stands around a mesh that is marked: what is asked, what can be done, the points over it."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

from imgui_bundle import imgui

from risorius.assets.fitting.guess import FIRST

from ..interface.commands import Command, MenuBar
from ..interface.gui import PANEL, Gui, colour, em, fixed_panel, ink_of
from ..interface.widgets import button, muted
from ..messages import Messages
from .marks import GROUP_OF, GROUPS, Colour, name_of, side_of
from .picture import MarkingPicture, MarkingView, Spot, are_facing, places_in

WIDTH, SHARE = 21.0, 0.4  # [em] of the panel, and at most of the window
GUIDE_SHARE = 0.34  # of the window's height, at most
LARGE = 1.2  # letters of what is asked, as parts of the others
DARK, WHITE = (0.08, 0.08, 0.10), (1.0, 1.0, 1.0)
# Buttons in rows, by the labels of their commands.
FIRST_ROWS = (("Upright", "Turn 90 degrees"), ("Undo", "Redo"))
ROWS = (
    ("Point before", "Next point"),
    ("Undo", "Redo", "Guess again"),
    ("Mirror this group",),
)
LAST_ROWS = (("Use this head",), ("Save landmarks", "Leave"))
BEGIN = (
    "Click the point on the skin that the guide shows. Where the head does not look at you, drag "
    "it with the mouse and press Upright, or Turn 90 degrees. The wheel zooms."
)
GO_ON = (
    "Drag points that are not where they belong; a click on the skin moves this one. White inside: "
    "guessed, and not moved yet."
)


class MarkingPanel:
    """Draws all of it."""

    def __init__(
        self,
        gui: Gui,
        messages: Messages,
        picture: MarkingPicture,
        menus: MenuBar,
        commands: Mapping[str, Command],
    ) -> None:
        """commands: by their labels."""
        self._gui, self._messages, self._marking = gui, messages, picture.marking
        self._picture, self._menus, self._commands = picture, menus, commands

    def draw(self, view: MarkingView) -> None:
        """Draw everything, and give the view its place."""
        display = imgui.get_io().display_size
        top = self._menus.draw()
        left = round(min(em(WIDTH), SHARE * display.x))
        below = round(top + min(0.9 * left, GUIDE_SHARE * display.y))
        view.guide_area = (0.0, top, left, below - top)
        view.area = (left, top, max(display.x - left, 1.0), max(display.y - top, 1.0))
        with fixed_panel(PANEL, (0.0, below), (left, display.y - below)):
            imgui.push_text_wrap_pos(0.0)
            self._draw_task()
            for row in (*(ROWS if self._marking.marks.is_complete else FIRST_ROWS), *LAST_ROWS):
                self._draw_row(row)
            imgui.pop_text_wrap_pos()
        self._draw_marks(view)
        self._draw_guide(view)

    def _draw_task(self) -> None:
        marking, is_complete = self._marking, self._marking.marks.is_complete
        number, title = marking.current, GROUP_OF[marking.current].title
        step = f"{title}: point {number}"
        if not is_complete and number in FIRST:
            step = f"First points: {FIRST.index(number) + 1} of {len(FIRST)}"
        muted(self._gui, marking.path.name)
        imgui.text_colored(colour(self._gui.theme.accent), step)
        imgui.push_font(None, LARGE * imgui.get_style().font_size_base)
        name = name_of(number)
        imgui.text_wrapped(f"{name[0].upper()}{name[1:]}")
        imgui.pop_font()
        muted(self._gui, side_of(number) or "in the middle of the face")
        imgui.spacing()
        imgui.text_wrapped(GO_ON if is_complete else BEGIN)
        imgui.spacing()

    def _draw_row(self, labels: tuple[str, ...]) -> None:
        room = imgui.get_content_region_avail().x
        spacing = imgui.get_style().item_spacing.x
        width = (room - spacing * (len(labels) - 1)) / len(labels)
        for label in labels:
            command = self._commands[label]
            imgui.begin_disabled(not command.can_run())
            ink = colour(self._gui.theme.accent, 0.6) if label == "Use this head" else None
            if button(self._gui, label, width=width, meaning=command.displayed_keys, highlight=ink):
                self._messages.attempt(command.run)
            imgui.end_disabled()
            if label != labels[-1]:
                imgui.same_line()

    def _draw_marks(self, view: MarkingView) -> None:
        """The points on the side that is seen, joined by lines; numbers in the current group."""
        marking, pen = self._marking, imgui.get_background_draw_list()
        numbers = list(marking.marks.places)
        points, normals = marking.seen(numbers)
        spots = places_in(view.area, view.camera, points)
        are_seen = are_facing(view.camera, points, normals)
        at = {n: spot for n, spot, seen in zip(numbers, spots, are_seen, strict=True) if seen}
        left, top, width, height = view.area
        pen.push_clip_rect((left, top), (left + width, top + height))
        if marking.marks.is_complete:
            _join(pen, at)
        for number, (x, y) in at.items():
            is_current = number == marking.current
            _dot(pen, (x, y), em(0.34 if is_current else 0.24), GROUP_OF[number].colour)
            if number in marking.marks.guessed:
                pen.add_circle_filled((x, y), em(0.12), ink_of(WHITE))
            if is_current:
                pen.add_circle((x, y), em(0.62), ink_of(WHITE), 0, em(0.12))
            if GROUP_OF[number] is GROUP_OF[marking.current]:
                _word(pen, (x + em(0.45), y - em(0.95)), str(number))
        pen.pop_clip_rect()

    def _draw_guide(self, view: MarkingView) -> None:
        """The points of the guide that belong to the current one, and that itself."""
        pen, current = imgui.get_background_draw_list(), self._marking.current
        is_complete = self._marking.marks.is_complete
        left, top, width, height = view.guide_area
        spots = places_in(view.guide_area, self._picture.guide_camera(), self._picture.guide_points)
        seen = self._picture.guide_seen()
        others = GROUP_OF[current].numbers if is_complete else FIRST
        at = {number: spots[number] for number in others if seen[number] or number == current}
        pen.push_clip_rect((left, top), (left + width, top + height))
        if is_complete:
            _join(pen, at)
        for number, spot in at.items():
            _dot(pen, spot, em(0.2), GROUP_OF[number].colour)
        pen.add_circle(spots[current], em(0.75), ink_of(WHITE), 0, em(0.2))
        _dot(pen, spots[current], em(0.38), GROUP_OF[current].colour)
        pen.pop_clip_rect()
        _word(pen, (left + em(0.6), top + em(0.4)), "Guide: where it belongs")


def _join(pen: imgui.ImDrawList, at: Mapping[int, Spot]) -> None:
    """The lines of groups, as far as their points are there."""
    for group in GROUPS:
        for line in group.lines:
            for a, b in pairwise(line):
                if a in at and b in at:
                    pen.add_line(at[a], at[b], ink_of(group.colour, 0.75), em(0.1))


def _dot(pen: imgui.ImDrawList, place: Spot, radius: float, ink: Colour) -> None:
    """A point with a dark border."""
    pen.add_circle_filled(place, radius + em(0.08), ink_of(DARK))
    pen.add_circle_filled(place, radius, ink_of(ink))


def _word(pen: imgui.ImDrawList, place: Spot, text: str) -> None:
    """White letters on any ground."""
    x, y = place
    pen.add_text((x + em(0.07), y + em(0.07)), ink_of(DARK), text)
    pen.add_text(place, ink_of(WHITE), text)
