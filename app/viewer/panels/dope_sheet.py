"""The keys in time: a ruler to scrub in, below it a row of keys for the poses and the tracks.

As in every dope sheet: a click selects a key and goes there, a drag moves what is selected, Shift
adds, a drag over nothing draws a box, the wheel zooms.
"""

from __future__ import annotations

import bisect
import itertools
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from imgui_bundle import imgui

from ...script import Pose, Script
from .. import key_commands, keys
from ..gui import em
from ..keys import KeyPlace
from ..lanes import TRACKS, Lane, described, lanes_shown
from ..time_view import TimeView
from . import key_marks
from .chrome import draw_actions
from .words import shortened

if TYPE_CHECKING:
    from ..window import Viewer

LANE, RULER = 1.35, 1.45  # [em] of a row's and the ruler's height
GUTTER, GUTTER_SHARE = 6.0, 0.2  # [em] for the rows' names, and of the width at most
MOST_LANES = 6  # that are seen at once; the rest is scrolled to
REACH = 0.5  # [em] beside a key that still mean it
CLICK = 4.0  # [window units] a press that moves less is a click, not a drag
ZOOM_PER_NOTCH = 0.8
SCROLL_PER_NOTCH = 0.12  # of the time that is shown
LEFT, RIGHT, MIDDLE = 0, 1, 2


@dataclass
class Drag:
    """What the mouse holds on to."""

    doing: str  # keys, box, scrub, end, pan
    began: tuple[float, float]  # [window units]
    script: Script  # as it was then
    selected: frozenset[KeyPlace]  # then
    grabbed: frozenset[KeyPlace] = frozenset()  # what the mouse is on
    button: int = LEFT
    has_moved: bool = False

    @property
    def time(self) -> float:
        """Of the key that was grabbed [s]."""
        return min(place.time for place in self.grabbed)


class DopeSheet:
    """Draws ruler and rows, and carries out what the mouse does in them."""

    def __init__(self, viewer: Viewer) -> None:
        self._viewer = viewer
        self.view = TimeView()
        self.selected: frozenset[KeyPlace] = frozenset()
        self._drag: Drag | None = None
        self._lanes: tuple[Lane, ...] = ()
        self._known: tuple[Script | None, bool] = None, False  # of which the rows are
        self._tops = [0.0]  # of each row, and of what would come below the last [window units]
        self._gutter = 0.0  # the width of their names [window units]
        self._naming: tuple[float, str] | None = None  # the pose that gets a name, and that
        self._wants_naming = self._wants_menu = False

    def height(self, room: float) -> float:
        """Of ruler and rows [window units], no more than there is room for."""
        self._refresh()
        wanted = sum(lane.height for lane in self._lanes[:MOST_LANES]) * em(LANE)
        return em(RULER) + max(min(wanted, room - em(RULER)), em(LANE))

    def where(self, place: KeyPlace) -> tuple[float, float]:
        """Where a key is drawn, in the first row that shows it [window units]."""
        row = next(row for row, lane in enumerate(self._lanes) if place in lane.places)
        return self.view.x(place.time), self._tops[row + 1] - 0.5 * em(LANE)

    def ask_name(self, pose: Pose) -> None:
        """Let the user write a name for a pose."""
        self._naming, self._wants_naming = (pose.time, pose.name or ""), True

    def _refresh(self) -> None:
        """Bring rows and selection up to date with the script."""
        script = self._viewer.session.script
        is_open = self._viewer.settings.folds.get(TRACKS, False)
        if self._known[0] is not script or self._known[1] != is_open:
            self._known = script, is_open
            self._lanes = lanes_shown(script, is_open=is_open)
            self.selected &= keys.places_of(script)

    def draw(self) -> None:
        """Draw everything, inside the strip's window."""
        self._refresh()
        viewer, io = self._viewer, imgui.get_io()
        place, room = imgui.get_cursor_screen_pos(), imgui.get_content_region_avail()
        self._gutter = min(em(GUTTER), GUTTER_SHARE * room.x)
        inset = em(0.7)
        self.view.place(
            place.x + self._gutter + inset, room.x - self._gutter - 2.0 * inset - em(0.6)
        )
        if self._drag is None:
            last = max((each.places[-1].time for each in self._lanes if each.places), default=0.0)
            self.view.fit(max(viewer.session.script.duration, last))
            if viewer.session.is_playing:
                self.view.follow(viewer.session.time)
        imgui.set_cursor_screen_pos(imgui.ImVec2(place.x + self._gutter, place.y))
        imgui.invisible_button("##time", imgui.ImVec2(room.x - self._gutter, em(RULER)))
        viewer.gui.remember("time")
        if imgui.is_item_hovered():
            self._press_in_ruler(io)
            self._turn_wheel(io)
        key_marks.draw_ruler(viewer, self.view, place.y, place.y + em(RULER))
        imgui.set_cursor_screen_pos(imgui.ImVec2(place.x, place.y + em(RULER)))
        self._draw_lanes(io)
        if self._drag is not None:
            self._follow(io, self._drag)
        self._draw_popups()

    def _draw_lanes(self, io: Any) -> None:
        flags = imgui.WindowFlags_.no_scroll_with_mouse | imgui.WindowFlags_.no_background
        least = max(imgui.get_content_region_avail().y, em(LANE))
        imgui.begin_child("keys", imgui.ImVec2(0.0, least), 0, flags)
        place, room = imgui.get_cursor_screen_pos(), imgui.get_content_region_avail()
        heights = [lane.height * em(LANE) for lane in self._lanes]
        self._tops = list(itertools.accumulate(heights, initial=place.y))
        size = imgui.ImVec2(room.x, self._tops[-1] - place.y)
        imgui.invisible_button("##keys", size)
        self._viewer.gui.remember("keys")
        is_hovered = imgui.is_item_hovered()
        for lane, (top, bottom) in zip(self._lanes, itertools.pairwise(self._tops), strict=True):
            corners = imgui.ImVec2(place.x, top), imgui.ImVec2(place.x + room.x, bottom)
            if imgui.is_rect_visible(*corners):
                key_marks.draw_lane(self._viewer, self.view, lane, self.selected, top, em(LANE))
                self._draw_label(lane, place.x, bottom - em(LANE))
        key_marks.draw_playhead(self._viewer, self.view, place.y, self._tops[-1])
        if self._drag is not None and self._drag.doing == "box" and self._drag.has_moved:
            key_marks.draw_box(self._viewer, self._drag.began, (io.mouse_pos.x, io.mouse_pos.y))
        if is_hovered and self._drag is None:
            self._hover(io, place.x)
        imgui.end_child()

    def _draw_label(self, lane: Lane, left: float, top: float) -> None:
        arrow = em(0.9) if lane.is_sum else 0.0
        is_open = bool(self._viewer.settings.folds.get(TRACKS))
        text = shortened(lane.label, self._gutter - arrow - em(0.3))
        key_marks.draw_label(self._viewer, text, left, top, em(LANE), arrow, is_open=is_open)

    # The mouse

    def _hover(self, io: Any, left: float) -> None:
        """The mouse is over the rows and holds nothing yet."""
        x, y = io.mouse_pos.x, io.mouse_pos.y
        lane = self._lane_at(y)
        if x < left + self._gutter:
            if lane is not None and lane.is_sum and imgui.is_mouse_clicked(LEFT):
                folds = self._viewer.settings.folds
                folds[TRACKS] = not folds.get(TRACKS, False)
            imgui.set_scroll_y(imgui.get_scroll_y() - em(LANE) * io.mouse_wheel)
            return
        under = lane.near(self.view.time(x), self.view.seconds(em(REACH))) if lane else frozenset()
        if under and not imgui.is_mouse_down(LEFT):
            imgui.set_tooltip(described(self._viewer.session.script, under))
        if imgui.is_mouse_clicked(LEFT):
            self._press(io, under)
        elif imgui.is_mouse_clicked(RIGHT):
            if under and not under <= self.selected:
                self.selected = under
            self._wants_menu = True
        self._turn_wheel(io)

    def _lane_at(self, y: float) -> Lane | None:
        row = self._row_at(y)
        return self._lanes[row] if 0 <= row < len(self._lanes) else None

    def _row_at(self, y: float) -> int:
        return bisect.bisect_right(self._tops, y) - 1

    def _press(self, io: Any, under: frozenset[KeyPlace]) -> None:
        began = (io.mouse_pos.x, io.mouse_pos.y)
        session = self._viewer.session
        if under and imgui.is_mouse_double_clicked(LEFT) and key_commands.can_rename(self._viewer):
            key_commands.rename(self._viewer)
            return
        if not under:
            kept = self.selected if io.key_shift else frozenset()
            self._drag = Drag("box", began, session.script, kept)
            return
        if io.key_shift:
            self.selected = (
                self.selected - under if under <= self.selected else self.selected | under
            )
        elif not under <= self.selected:
            self.selected = under
        self._drag = Drag("keys", began, session.script, self.selected, under)

    def _press_in_ruler(self, io: Any) -> None:
        session, end = self._viewer.session, self.view.x(self._viewer.session.script.duration)
        is_at_end = end < io.mouse_pos.x < end + em(key_marks.FLAG)
        if is_at_end:
            imgui.set_mouse_cursor(imgui.MouseCursor_.resize_ew)
            if self._drag is None:
                imgui.set_tooltip("drag the script's end")
        if self._drag is None and imgui.is_mouse_clicked(LEFT):
            began = (io.mouse_pos.x, io.mouse_pos.y)
            doing = "end" if is_at_end else "scrub"
            self._drag = Drag(doing, began, session.script, self.selected)

    def _turn_wheel(self, io: Any) -> None:
        """Zoom about the mouse; with Shift, or a sideways wheel, scroll; the middle button pans."""
        x = io.mouse_pos.x
        if self._drag is None and imgui.is_mouse_clicked(MIDDLE):
            script = self._viewer.session.script
            self._drag = Drag("pan", (x, 0.0), script, self.selected, button=MIDDLE)
        sideways = io.mouse_wheel_h or (io.mouse_wheel if io.key_shift else 0.0)
        if sideways:
            self.view.scroll(-SCROLL_PER_NOTCH * self.view.span * sideways)
        elif io.mouse_wheel:
            self.view.zoom(ZOOM_PER_NOTCH**io.mouse_wheel, x)

    def _follow(self, io: Any, drag: Drag) -> None:
        """Carry out what the mouse does until it lets go; Escape takes back what it did."""
        x, y = io.mouse_pos.x, io.mouse_pos.y
        distance = abs(x - drag.began[0]) + abs(y - drag.began[1])
        drag.has_moved = drag.has_moved or distance > CLICK
        act: dict[str, Callable[[], None]] = {
            "keys": lambda: self._move_keys(io, drag),
            "box": lambda: self._select_box(io, drag),
            "scrub": lambda: self._viewer.session.seek(self._snapped(self.view.time(x), io)),
            "end": lambda: self._viewer.session.edit(
                keys.lasting(drag.script, self.view.time(x)), is_done=False
            ),
            "pan": lambda: self.view.scroll(-self.view.seconds(io.mouse_delta.x)),
        }
        if drag.has_moved or drag.doing == "scrub":
            self._viewer.attempt(act[drag.doing])
        if imgui.is_key_pressed(imgui.Key.escape) and drag.doing in ("keys", "end"):
            self._drag = None
            self._viewer.attempt(lambda: self._viewer.session.edit(drag.script))
            self.selected = drag.selected
        elif not imgui.is_mouse_down(drag.button):
            self._drag = None
            self._release(io, drag)

    def _snapped(self, time: float, io: Any) -> float:
        """The time of the nearest frame; with Ctrl just that time [s]."""
        return time if io.key_ctrl else keys.on_frame(time)

    def _move_keys(self, io: Any, drag: Drag) -> None:
        target = drag.time + self.view.seconds(io.mouse_pos.x - drag.began[0])
        last = self.view.start + self.view.span  # further right it would be out of sight
        offset = self._snapped(min(max(target, 0.0), last), io) - drag.time
        script, places = keys.moved(drag.script, drag.selected, offset)
        self._viewer.session.edit(script, is_done=False)
        self.selected = places
        imgui.set_tooltip(f"{drag.time + offset:.2f} s")

    def _select_box(self, io: Any, drag: Drag) -> None:
        times = sorted(self.view.time(x) for x in (drag.began[0], io.mouse_pos.x))
        rows = sorted(self._row_at(y) for y in (drag.began[1], io.mouse_pos.y))
        inside = self._lanes[max(rows[0], 0) : max(rows[1] + 1, 0)]
        self.selected = drag.selected.union(*(lane.between(*times) for lane in inside))

    def _release(self, io: Any, drag: Drag) -> None:
        session = self._viewer.session
        if drag.doing == "box" and not drag.has_moved:
            self.selected = drag.selected
        elif drag.doing == "keys" and not drag.has_moved:
            if not io.key_shift:
                self.selected = drag.grabbed
                session.is_playing = False
                session.seek(drag.time)
        if drag.doing == "keys" and drag.has_moved:
            lost = len(keys.places_of(drag.script)) - len(keys.places_of(session.script))
            if lost > 0:
                words = key_commands.counted(lost)
                self._viewer.messages.say(f"{words} replaced; Ctrl+Z brings back")
        if drag.doing != "pan":
            session.note()

    # What comes up

    def _draw_popups(self) -> None:
        viewer = self._viewer
        if self._wants_menu:
            imgui.open_popup("key menu")
        if self._wants_naming:
            imgui.open_popup("pose name")
        if imgui.begin_popup("key menu"):
            draw_actions(viewer, viewer.actions, "Keys")
            imgui.end_popup()
        if imgui.begin_popup("pose name"):
            self._draw_naming()
            imgui.end_popup()
        self._wants_menu = self._wants_naming = False

    def _draw_naming(self) -> None:
        """A line for a pose's name."""
        if self._naming is None:
            return
        time, name = self._naming
        imgui.text(f"Name of the pose at {time:.2f} s")
        if self._wants_naming:
            imgui.set_keyboard_focus_here()
        imgui.set_next_item_width(em(14.0))
        flags = imgui.InputTextFlags_.enter_returns_true | imgui.InputTextFlags_.auto_select_all
        is_entered, name = imgui.input_text_with_hint(
            "##name", "none: no picture on a sheet", name, flags
        )
        self._viewer.gui.remember("pose name")
        self._naming = time, name
        session = self._viewer.session
        if is_entered:
            self._viewer.attempt(lambda: session.edit(keys.renamed(session.script, time, name)))
        if is_entered or imgui.is_key_pressed(imgui.Key.escape):
            self._naming = None
            imgui.close_current_popup()
