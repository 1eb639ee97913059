"""The keys in time: a ruler to scrub in, below it a row of keys for the poses and the tracks.

As in every dope sheet: a click selects a key and goes there, a drag moves what is selected, Shift
adds, a drag over nothing draws a box, the wheel zooms. Where keys are too dense to be told apart,
only those that are selected are dragged, and a drag over others draws a box.
"""

from __future__ import annotations

import bisect
import itertools
from dataclasses import dataclass
from typing import Any

from imgui_bundle import imgui

from ...errors import counted
from ...script import Script
from .. import keyframes
from ..gui import LEFT, MIDDLE, RIGHT, Gui, em
from ..key_selection import KeySelection
from ..messages import Message, Messages, Task
from ..places import NOWHERE, KeyPlace, Places
from ..session import Session
from ..settings import Settings
from ..time_axis import TimeAxis
from ..tracks import TRACKS, Track, described, visible_tracks
from . import key_marks
from .menu_bar import MenuBar
from .waveform import Waveform
from .widgets import shortened

ROW, RULER = 1.35, 1.45  # [em] of a row's and the ruler's height
GUTTER, GUTTER_SHARE = 6.0, 0.2  # [em] for the rows' names, and of the width at most
MOST_ROWS = 6  # that are seen at once; the rest is scrolled to
REACH = 0.5  # [em] beside a key that still mean it
CLICK = 4.0  # [window units] a press that moves less is a click, not a drag
ZOOM_PER_NOTCH = 0.8
SCROLL_PER_NOTCH = 0.12  # of the visible time


@dataclass
class Drag:
    """What the mouse holds on to."""

    doing: str  # keys, box, scrub, end, pan
    began: tuple[float, float]  # [window units]
    script: Script  # as it was then
    selected: Places  # then
    has_moved: bool = False

    @property
    def button(self) -> int:
        """Of the mouse, which is held down."""
        return MIDDLE if self.doing == "pan" else LEFT


class DopeSheet:
    """Draws ruler and rows, and carries out what the mouse does in them."""

    def __init__(
        self,
        gui: Gui,
        session: Session,
        settings: Settings,
        messages: Messages,
        selection: KeySelection,
        axis: TimeAxis,
        menus: MenuBar,
        waveform: Waveform,
    ) -> None:
        self._gui, self._session, self._settings = gui, session, settings
        self._messages, self._menus = messages, menus
        self._selection, self._axis, self._waveform = selection, axis, waveform
        self._drag: Drag | None = None
        self._grabbed = NOWHERE  # the keys at one time that the mouse was pressed on
        self._tracks: tuple[Track, ...] = ()
        self._known: tuple[Script | None, bool] = None, False  # of which the tracks are
        self._are_dense: dict[str, bool] = {}  # by label: keys cannot be told apart
        self._tops = [0.0]  # of each row, and of what would come below the last [window units]
        self._gutter = 0.0  # the width of their names [window units]
        self._name_line = PoseNameLine(gui, session, messages, selection)
        self._wants_menu = False

    @property
    def _is_open(self) -> bool:
        """Whether each track has a row of its own."""
        return self._settings.folds.get(TRACKS, False)

    def height(self, room: float) -> float:
        """Of ruler and rows [window units], no more than there is room for."""
        self._refresh()
        wanted = sum(track.height for track in self._tracks[:MOST_ROWS]) * em(ROW)
        above = em(RULER) + self._waveform.height
        return above + max(min(wanted, room - above), em(ROW))

    def where(self, place: KeyPlace) -> tuple[float, float]:
        """Where a key is drawn, in the first row that has it [window units]."""
        row = next(row for row, track in enumerate(self._tracks) if place in track.places)
        return self._axis.x(place.time), self._tops[row + 1] - 0.5 * em(ROW)

    def _refresh(self) -> None:
        """Bring rows and selection up to date with the script."""
        script, is_open = self._session.script, self._is_open
        if self._known[0] is not script or self._known[1] != is_open:
            self._known = script, is_open
            self._tracks = visible_tracks(script, is_open=is_open)
            self._selection.places &= keyframes.places_of(script)

    def draw(self) -> None:
        """Draw everything, inside the timeline's window."""
        self._refresh()
        session, axis, io = self._session, self._axis, imgui.get_io()
        place, room = imgui.get_cursor_screen_pos(), imgui.get_content_region_avail()
        self._gutter = min(em(GUTTER), GUTTER_SHARE * room.x)
        inset = em(0.7)
        axis.place(place.x + self._gutter + inset, room.x - self._gutter - 2.0 * inset - em(0.6))
        duration = session.script.duration
        if self._drag is None:
            ends = (track.end for track in self._tracks)
            axis.fit(max(duration, session.time, self._waveform.duration, *ends))
            if session.is_playing:
                axis.follow(session.time)
        imgui.set_cursor_screen_pos((place.x + self._gutter, place.y))
        imgui.invisible_button("##time", (room.x - self._gutter, em(RULER) + self._waveform.height))
        self._gui.remember("time")
        if imgui.is_item_hovered():
            self._press_in_ruler(io)
            self._turn_wheel(io)
        edges = place.y, place.y + em(RULER)
        key_marks.draw_ruler(self._gui.theme, axis, session.time, duration, edges)
        self._waveform.draw(session.time, duration, (place.x, edges[1]))
        imgui.set_cursor_screen_pos((place.x, edges[1] + self._waveform.height))
        self._draw_rows(io)
        if self._drag is not None:
            self._follow(io, self._drag)
        if self._wants_menu:
            imgui.open_popup("key menu")
            self._wants_menu = False
        if imgui.begin_popup("key menu"):
            self._menus.draw_menu("Keys")
            imgui.end_popup()
        self._name_line.draw()
        if any(map(imgui.is_mouse_clicked, (LEFT, MIDDLE, RIGHT))):
            flags = imgui.HoveredFlags_.child_windows
            flags |= imgui.HoveredFlags_.allow_when_blocked_by_active_item
            self._selection.is_touched = imgui.is_window_hovered(flags)
        elif io.want_text_input and not imgui.is_any_mouse_down():
            self._selection.is_touched = False

    def _draw_rows(self, io: Any) -> None:
        flags = imgui.WindowFlags_.no_scroll_with_mouse | imgui.WindowFlags_.no_background
        least = max(imgui.get_content_region_avail().y, em(ROW))
        imgui.begin_child("keys", (0.0, least), 0, flags)
        place, room = imgui.get_cursor_screen_pos(), imgui.get_content_region_avail()
        heights = [track.height * em(ROW) for track in self._tracks]
        self._tops = list(itertools.accumulate(heights, initial=place.y))
        size = (room.x, self._tops[-1] - place.y)
        imgui.invisible_button("##keys", size)
        self._gui.remember("keys")
        is_hovered = imgui.is_item_hovered()
        theme, session = self._gui.theme, self._session
        painter = key_marks.TrackPainter(
            theme, self._axis, self._selection.places, session.script.duration
        )
        for track, (top, bottom) in zip(self._tracks, itertools.pairwise(self._tops), strict=True):
            corners = (place.x, top), (place.x + room.x, bottom)
            if imgui.is_rect_visible(*corners):
                self._are_dense[track.label] = painter.draw(track, top, em(ROW))
                arrow = em(0.9) if track.is_sum else 0.0
                label = shortened(track.label, self._gutter - arrow - em(0.3))
                corner = place.x, bottom - em(ROW)
                key_marks.draw_label(theme, label, corner, em(ROW), arrow, is_open=self._is_open)
        key_marks.draw_playhead(theme, self._axis, session.time, (place.y, self._tops[-1]))
        if session.differing:
            key_marks.draw_unkeyed(theme, self._axis, session.time, self._tops[1] - 0.5 * em(ROW))
        if self._drag is not None and self._drag.doing == "box" and self._drag.has_moved:
            key_marks.draw_box(theme, self._drag.began, (io.mouse_pos.x, io.mouse_pos.y))
        if is_hovered and self._drag is None:
            self._hover(io, place.x)
        imgui.end_child()

    # The mouse

    def _hover(self, io: Any, left: float) -> None:
        """The mouse is over the rows and holds nothing yet."""
        selection, axis, (x, y) = self._selection, self._axis, io.mouse_pos
        track = self._track_at(y)
        if x < left + self._gutter:
            if track is not None and track.is_sum and imgui.is_mouse_clicked(LEFT):
                self._settings.folds[TRACKS] = not self._is_open
            imgui.set_scroll_y(imgui.get_scroll_y() - em(ROW) * io.mouse_wheel)
            return
        under = track.places.near(axis.time(x), axis.seconds(em(REACH))) if track else NOWHERE
        if under and not imgui.is_mouse_down(LEFT):
            imgui.set_tooltip(described(self._session.script, under))
        if imgui.is_mouse_clicked(LEFT):
            self._press(io, under, is_dense=track is not None and self._are_dense[track.label])
        elif imgui.is_mouse_clicked(RIGHT):
            if under and not under <= selection.places:
                selection.places = under
            self._wants_menu = True
        self._turn_wheel(io)

    def _track_at(self, y: float) -> Track | None:
        row = self._row_at(y)
        return self._tracks[row] if 0 <= row < len(self._tracks) else None

    def _row_at(self, y: float) -> int:
        return bisect.bisect_right(self._tops, y) - 1

    def _begin(self, doing: str, io: Any, selected: Places | None = None) -> None:
        """Hold on to something; selected: from now on, where that is not what is selected."""
        began = (io.mouse_pos.x, io.mouse_pos.y)
        places = self._selection.places if selected is None else selected
        self._drag = Drag(doing, began, self._session.script, places)

    def _press(self, io: Any, under: Places, *, is_dense: bool) -> None:
        selection = self._selection
        if under and imgui.is_mouse_double_clicked(LEFT) and selection.can_rename:
            selection.rename()
        elif not under or (is_dense and not under <= selection.places):
            self._grabbed = under
            self._begin("box", io, selection.places if io.key_shift else NOWHERE)
        else:
            if io.key_shift and under <= selection.places:
                selection.places -= under
            elif io.key_shift:
                selection.places |= under
            elif not under <= selection.places:
                selection.places = under
            self._begin("keys", io)
            self._grabbed = under

    def _press_in_ruler(self, io: Any) -> None:
        end = self._axis.x(self._session.script.duration)
        is_at_end = end < io.mouse_pos.x < end + em(key_marks.FLAG)
        if is_at_end:
            imgui.set_mouse_cursor(imgui.MouseCursor_.resize_ew)
            if self._drag is None:
                imgui.set_tooltip("drag the script's end")
        if self._drag is None and imgui.is_mouse_clicked(LEFT):
            self._begin("end" if is_at_end else "scrub", io)

    def _turn_wheel(self, io: Any) -> None:
        """Zoom about the mouse; with Shift, or a sideways wheel, scroll; the middle button pans."""
        if self._drag is None and imgui.is_mouse_clicked(MIDDLE):
            self._begin("pan", io)
        sideways = io.mouse_wheel_h or (io.mouse_wheel if io.key_shift else 0.0)
        if sideways:
            self._axis.scroll(-SCROLL_PER_NOTCH * self._axis.span * sideways)
        elif io.mouse_wheel:
            self._axis.zoom(ZOOM_PER_NOTCH**io.mouse_wheel, io.mouse_pos.x)

    def _follow(self, io: Any, drag: Drag) -> None:
        """Carry out what the mouse does until it lets go; Escape takes back what it did."""
        x, y = io.mouse_pos
        axis, session = self._axis, self._session
        distance = abs(x - drag.began[0]) + abs(y - drag.began[1])
        drag.has_moved = drag.has_moved or distance > CLICK
        act: dict[str, Task] = {
            "keys": lambda: self._move_keys(io, drag),
            "box": lambda: self._select_box(io, drag),
            "scrub": lambda: session.seek(self._snapped(axis.time(x), io)),
            "end": lambda: session.edit(
                keyframes.lasting(drag.script, axis.time(x)), is_done=False
            ),
            "pan": lambda: axis.scroll(-axis.seconds(io.mouse_delta.x)),
        }
        if drag.has_moved or drag.doing in ("scrub", "pan"):
            self._messages.attempt(act[drag.doing])
        if imgui.is_key_pressed(imgui.Key.escape) and drag.doing in ("keys", "end"):
            self._drag = None
            self._messages.attempt(lambda: session.edit(drag.script, is_done=False))
            self._selection.places = drag.selected
        elif not imgui.is_mouse_down(drag.button):
            self._drag = None
            self._messages.attempt(lambda: self._release(io, drag))

    def _snapped(self, time: float, io: Any) -> float:
        """The time of the nearest frame; with Ctrl just that time [s]."""
        return time if io.key_ctrl else keyframes.on_frame(time)

    def _move_keys(self, io: Any, drag: Drag) -> None:
        time = self._grabbed.first
        target = time + self._axis.seconds(io.mouse_pos.x - drag.began[0])
        target = min(max(target, 0.0), self._axis.end)  # further right it would not be seen
        offset = self._snapped(target, io) - time
        script, places = keyframes.moved(drag.script, drag.selected, offset)
        self._session.edit(script, is_done=False)
        self._selection.places = places
        imgui.set_tooltip(f"{time + offset:.2f} s")

    def _select_box(self, io: Any, drag: Drag) -> None:
        times = sorted(self._axis.time(x) for x in (drag.began[0], io.mouse_pos.x))
        rows = sorted(self._row_at(y) for y in (drag.began[1], io.mouse_pos.y))
        inside = self._tracks[max(rows[0], 0) : max(rows[1] + 1, 0)]
        places = drag.selected
        for track in inside:
            places |= track.places.between(*times)
        self._selection.places = places

    def _release(self, io: Any, drag: Drag) -> Message:
        """The mouse has let go; what there is to say about it."""
        session, line = self._session, None
        if drag.doing == "keys" and drag.has_moved:
            lost = len(keyframes.places_of(drag.script)) - len(keyframes.places_of(session.script))
            line = f"{counted(lost, 'key')} replaced; Ctrl+Z brings back" if lost > 0 else None
        elif drag.doing in ("keys", "box") and not drag.has_moved:
            if drag.doing == "box":
                self._selection.places = drag.selected | self._grabbed
            if self._grabbed and not io.key_shift:
                self._selection.places = self._grabbed
                session.is_playing = False
                line = session.seek(self._grabbed.first)
        if drag.doing in ("keys", "end") and drag.has_moved:
            keys = counted(len(drag.selected), "key")
            session.note(f"Move {keys if drag.doing == 'keys' else 'the end'}")
        return line


class PoseNameLine:
    """A line for a pose's name, which comes up when one is asked for."""

    def __init__(
        self, gui: Gui, session: Session, messages: Messages, selection: KeySelection
    ) -> None:
        self._gui, self._session, self._messages = gui, session, messages
        self._selection = selection
        self._time, self._name = 0.0, ""  # [s] of the pose, and what is written so far

    def draw(self) -> None:
        """Draw it, if it is open or wanted."""
        pose, self._selection.pose_to_name = self._selection.pose_to_name, None
        if pose is not None:
            self._time, self._name = pose.time, pose.name or ""
            imgui.open_popup("pose name")
        if not imgui.begin_popup("pose name"):
            return
        imgui.text(f"Name of the pose at {self._time:.2f} s")
        if pose is not None:
            imgui.set_keyboard_focus_here()
        imgui.set_next_item_width(em(14.0))
        flags = imgui.InputTextFlags_.enter_returns_true | imgui.InputTextFlags_.auto_select_all
        is_entered, self._name = imgui.input_text_with_hint(
            "##name", "none: no picture on a sheet", self._name, flags
        )
        self._gui.remember("pose name")
        if is_entered:
            script = keyframes.renamed(self._session.script, self._time, self._name)
            self._messages.attempt(lambda: self._session.edit(script, "Name a pose"))
        if is_entered or imgui.is_key_pressed(imgui.Key.escape):
            imgui.close_current_popup()
        imgui.end_popup()
