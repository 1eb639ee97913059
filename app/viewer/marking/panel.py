"""What stands around a mesh that is marked: what is asked, what can be done, the points over it."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

from imgui_bundle import imgui

from risorius.assets.fitting.guess import FIRST

from ..command import Command
from ..gui import Gui, colour, em, fixed_panel
from ..messages import Messages
from ..panels.menu_bar import MenuBar
from ..panels.widgets import button, muted, stay_in_line
from .marks import GROUP_OF, GROUPS, ORDER, Colour, name_of, side_of
from .mouse import MarkingMouse
from .picture import FloatArray, MarkingPicture, MarkingView, places_in

Spot = tuple[float, float]  # [window units]
WIDTH, SHARE = 21.0, 0.4  # [em] of the panel, and at most of the window
GUIDE_SHARE = 0.34  # of the window's height, at most
LARGE = 1.2  # letters of what is asked, as parts of the others
DARK, WHITE = (0.08, 0.08, 0.10), (1.0, 1.0, 1.0)
FAINT = 0.22  # opacity of what is on the side that is turned away
# Buttons in rows, by the labels of their commands.
ROWS = (
    ("Point before", "Next point"),
    ("Undo", "Redo", "Guess again"),
    ("Mirror this group", "Mirror the whole side"),
)
TURNS = ("Tip the mesh", "Roll the mesh")


class MarkingPanel:
    """Draws all of it."""

    def __init__(
        self,
        gui: Gui,
        messages: Messages,
        picture: MarkingPicture,
        mouse: MarkingMouse,
        menus: MenuBar,
    ) -> None:
        self._gui, self._messages, self._marking = gui, messages, picture.marking
        self._picture, self._mouse, self._menus = picture, mouse, menus
        self.commands: Mapping[str, Command] = {}  # by their labels

    def draw(self, view: MarkingView) -> None:
        """Draw everything, and give the view its place."""
        display = imgui.get_io().display_size
        top = self._menus.draw()
        left = round(min(em(WIDTH), SHARE * display.x))
        below = round(top + min(0.9 * left, GUIDE_SHARE * display.y))
        view.guide_area = (0.0, top, left, below - top)
        view.area = (left, top, max(display.x - left, 1.0), max(display.y - top, 1.0))
        with fixed_panel("Marking", (0.0, below), (left, display.y - below)):
            imgui.push_text_wrap_pos(0.0)
            self._draw_task()
            self._draw_buttons()
            self._draw_groups()
            imgui.pop_text_wrap_pos()
        self._draw_marks(view)
        self._draw_guide(view)

    def _draw_task(self) -> None:
        marking, theme = self._marking, self._gui.theme
        muted(self._gui, marking.path.name)
        if not marking.can_guess:
            step = f"First points: {FIRST.index(marking.current) + 1} of {len(FIRST)}"
        else:
            step = f"{GROUP_OF[marking.current].title}: point {marking.current}"
        imgui.text_colored(colour(theme.accent), step)
        imgui.push_font(None, LARGE * imgui.get_style().font_size_base)
        name = name_of(marking.current)
        imgui.text_wrapped(f"{name[0].upper()}{name[1:]}")
        imgui.pop_font()
        muted(self._gui, side_of(marking.current) or "in the middle of the face")
        imgui.spacing()
        if marking.can_guess:
            imgui.text_wrapped(
                "Drag points that are not where they belong; a click on the skin moves this one. "
                "White inside: guessed, and not moved yet."
            )
        else:
            imgui.text_wrapped(
                "Turn the head until it looks at you: drag it with the mouse; tip or roll a mesh "
                "that lies on its back or side. The wheel zooms. Then click the point on the skin "
                "that the guide shows."
            )
        imgui.spacing()

    def _draw_buttons(self) -> None:
        rows = ROWS if self._marking.can_guess else (TURNS, ROWS[1])
        for row in rows:
            self._draw_row(row)
        imgui.spacing()
        self._draw_row(("Use this head",), highlight=self._gui.theme.accent)
        self._draw_row(("Save landmarks", "Leave"))
        imgui.spacing()

    def _draw_row(self, labels: tuple[str, ...], highlight: Colour | None = None) -> None:
        room = imgui.get_content_region_avail().x
        spacing = imgui.get_style().item_spacing.x
        width = (room - spacing * (len(labels) - 1)) / len(labels)
        for place, label in enumerate(labels):
            command = self.commands[label]
            if place:
                stay_in_line(0.0)
            imgui.begin_disabled(not command.can_run())
            ink = colour(highlight, 0.6) if highlight is not None else None
            if button(self._gui, label, width=width, meaning=command.key, highlight=ink):
                self._messages.attempt(command.run)
            imgui.end_disabled()

    def _draw_groups(self) -> None:
        """The groups, each in its colour, with how many of it somebody has placed."""
        marking = self._marking
        if not marking.can_guess:
            return
        muted(self._gui, "placed by hand")
        if not imgui.begin_table("groups", 2):
            return
        for group in GROUPS:
            imgui.table_next_column()
            count = sum(number in marking.marks.by_hand for number in group.numbers)
            is_current = marking.current in group.numbers
            label = f"        {group.title}  {count}/{len(group.numbers)}###{group.title}"
            at = imgui.get_cursor_screen_pos()
            if imgui.selectable(label, is_current)[0]:
                marking.current = group.numbers[0]
            self._gui.remember(f"group {group.title}")
            middle = (at.x + em(0.6), at.y + 0.5 * imgui.get_text_line_height())
            _dot(imgui.get_window_draw_list(), middle, em(0.32), group.colour)
        imgui.end_table()

    def _draw_marks(self, view: MarkingView) -> None:
        """The points over the mesh, joined by lines; numbers for those of the current group."""
        marking, pen = self._marking, imgui.get_background_draw_list()
        numbers = [number for number in ORDER if number in marking.marks.places]
        points, normals = marking.seen(numbers)
        at = dict(zip(numbers, _spots(view.on_screen(points)), strict=True))
        seen = dict(zip(numbers, view.are_seen(points, normals), strict=True))
        left, top, width, height = view.area
        pen.push_clip_rect((left, top), (left + width, top + height))
        if marking.marks.is_complete:
            _join(pen, at, seen)
        for number in numbers:
            is_current = number == marking.current and marking.can_guess
            is_big = is_current or number == self._mouse.pointed
            opacity = 1.0 if seen[number] else FAINT
            is_guessed = number in marking.marks.guessed
            ink = GROUP_OF[number].colour
            _dot(pen, at[number], em(0.34 if is_big else 0.24), ink, opacity, is_hollow=is_guessed)
            if is_current:
                pen.add_circle(at[number], em(0.62), _ink(WHITE, opacity), 0, em(0.12))
            shows_number = GROUP_OF[number] is GROUP_OF[marking.current] or is_big
            if shows_number and seen[number]:
                x, y = at[number]
                _word(pen, (x + em(0.45), y - em(0.95)), str(number))
        pen.pop_clip_rect()
        self._gui.places["marks"] = (left, top, left + width, top + height)

    def _draw_guide(self, view: MarkingView) -> None:
        """The points of the guide that belong to the current one, and that itself."""
        pen, marking = imgui.get_background_draw_list(), self._marking
        left, top, width, height = area = view.guide_area
        points = self._picture.guide_points
        at = _spots(places_in(area, self._picture.guide_camera(), points))
        current = marking.current
        others = GROUP_OF[current].numbers if marking.can_guess else FIRST
        seen = self._picture.guide_seen()
        others = tuple(number for number in others if seen[number] or number == current)
        pen.push_clip_rect((left, top), (left + width, top + height))
        if marking.can_guess:
            _join(pen, {n: at[n] for n in others}, dict.fromkeys(others, True))
        for number in others:
            _dot(pen, at[number], em(0.2), GROUP_OF[number].colour)
        pen.add_circle(at[current], em(0.75), _ink(WHITE), 0, em(0.2))
        _dot(pen, at[current], em(0.38), GROUP_OF[current].colour)
        pen.pop_clip_rect()
        _word(pen, (left + em(0.6), top + em(0.4)), "guide: where it belongs")


def _spots(places: FloatArray) -> list[Spot]:
    return [(x, y) for x, y in places.tolist()]


def _join(pen: imgui.ImDrawList, at: Mapping[int, Spot], seen: Mapping[int, bool]) -> None:
    """The lines of groups, as far as their points are there."""
    for group in GROUPS:
        for line in group.lines:
            for a, b in pairwise(line):
                if a in at and b in at:
                    opacity = 0.75 if seen[a] and seen[b] else 0.5 * FAINT
                    pen.add_line(at[a], at[b], _ink(group.colour, opacity), em(0.1))


def _dot(
    pen: imgui.ImDrawList,
    place: Spot,
    radius: float,
    ink: Colour,
    opacity: float = 1.0,
    *,
    is_hollow: bool = False,
) -> None:
    """A point with a dark border; a hollow one is a guess."""
    pen.add_circle_filled(place, radius + em(0.08), _ink(DARK, opacity))
    pen.add_circle_filled(place, radius, _ink(ink, opacity))
    if is_hollow:
        pen.add_circle_filled(place, 0.5 * radius, _ink(WHITE, opacity))


def _word(pen: imgui.ImDrawList, place: Spot, text: str) -> None:
    """White letters on any ground."""
    x, y = place
    pen.add_text((x + em(0.07), y + em(0.07)), _ink(DARK), text)
    pen.add_text(place, _ink(WHITE), text)


def _ink(rgb: Colour, opacity: float = 1.0) -> int:
    return int(imgui.get_color_u32(colour(rgb, opacity)))
