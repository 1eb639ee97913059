"""The keys over time: a ruler for scrubbing, and below it rows of keys, or values as curves.

The mouse works as in any dope sheet. A click selects a key and goes to its time, and Shift adds to
the selection. A drag moves the selected keys, or draws a box from an empty place. The wheel zooms.
Where keys are too dense to distinguish, only selected keys can be dragged.
"""

from __future__ import annotations

import bisect
import itertools
from dataclasses import dataclass
from typing import Any

from imgui_bundle import imgui

from ...script import Script, keyframes
from ...script.key_sets import NO_KEYS, KeySet
from ...text import counted
from ..context import ApplicationContext
from ..interface.commands import MenuBar
from ..interface.gui import LEFT_BUTTON, MIDDLE_BUTTON, RIGHT_BUTTON, em, ink_of
from ..interface.widgets import shortened
from ..messages import Message, Task
from . import key_marks
from .graph import Graph
from .key_marks import Waveform
from .keys import KeySelection, Track, all_tracks
from .time_axis import TimeAxis


@dataclass
class Drag:
    """The state of a drag, from press to release."""

    doing: str  # kind of drag: keys, box, scrub, end, pan, slope
    began: tuple[float, float]  # [window units]
    script: Script  # the script at the press
    selected: KeySet  # selected keys at the press
    has_moved: bool = False


class DopeSheet:
    """Draws ruler and rows, and executes the mouse's actions in them."""

    ROW_HEIGHT = 1.35  # [em]
    RULER_HEIGHT = 1.45  # [em]
    CLICK_DISTANCE = 4.0  # [window units]: a press with less motion is a click

    def __init__(
        self,
        app: ApplicationContext,
        selection: KeySelection,
        axis: TimeAxis,
        menus: MenuBar,
        waveform: Waveform,
    ) -> None:
        self._gui = app.gui
        self._session = app.session
        self.settings = app.settings
        self._messages = app.messages
        self._menus = menus
        self.selection = selection
        self.axis = axis
        self._waveform = waveform
        self.graph = Graph(app.gui, selection, axis)
        self._drag: Drag | None = None
        self._grabbed = NO_KEYS  # the keys under a press, all at one time
        self._all: tuple[Track, ...] = ()
        self.rows: tuple[Track, ...] = ()  # the visible rows among all
        self._known: Script | None = None  # the script of these rows
        self._are_dense: dict[str, bool] = {}  # by name: whether keys are too dense to distinguish
        self._is_held = False  # whether the mouse holds the ruler or keys, which must not move
        self._shown_rows = 0.0  # height of rows without scrolling, in rows
        self._bottom = 0.0  # bottom of the whole sheet [window units]
        self._tops = [0.0]  # tops of rows, and of one after the last [window units]
        self._gutter = 0.0  # width of row names [window units]
        self._wants_menu = False

    def _is_open(self, name: str) -> bool:
        """Whether the rows folded into this row are displayed; at first only one of many groups."""
        most_curves = 24  # if there are more, most groups are folded by default
        is_few = len(self._session.script.tracks) <= most_curves or name == self._all[1].name
        return self.settings.folds.get(name, is_few if ":" in name else self.settings.shows_curves)

    def height(self, room: float) -> float:
        """Return the height of ruler and rows [window units], limited by `room`."""
        self._refresh()
        most_rows = 6  # the user scrolls to other rows
        if not self._is_held:
            self._shown_rows = sum(track.height for track in self.rows[:most_rows])
        rows = em(self.ROW_HEIGHT) * self._shown_rows
        graph_height = 14.0  # [em] by default
        wanted = em(graph_height) if self.settings.shows_curves else rows
        above = em(self.RULER_HEIGHT) + self._waveform.height
        return above + max(min(wanted, room - above), em(self.ROW_HEIGHT))

    def _refresh(self) -> None:
        """Update rows and selection from script and settings."""
        script = self._session.script
        if self._known is not script:
            self._known = script
            self._all = all_tracks(script, self._session.controls.groups)
            self.selection.keys &= keyframes.all_keys(script)
        self.rows = tuple(track for track in self._all if all(map(self._is_open, track.parents)))
        self.graph.display(self.rows)

    def draw(self, height: float) -> None:
        """Draw everything inside the timeline's window. height: [window units]."""
        self._refresh()
        session = self._session
        axis = self.axis
        io = imgui.get_io()
        place = imgui.get_cursor_screen_pos()
        room = imgui.get_content_region_avail()
        self._bottom = place.y + height
        self._gutter = min(em(9.5), 0.2 * room.x)  # names of rows
        inset = em(0.7)
        values = em(2.2) if self.settings.shows_curves else 0.0  # labels of values
        left = self._gutter + inset + values
        axis.place(place.x + left, room.x - left - inset - em(0.6))
        duration = session.script.duration
        if self._drag is None:
            lasts = (times[-1] for row in self.rows for times in row.keys.times.values())
            axis.fit(float(max([duration, session.time, self._waveform.duration, *lasts])))
            if session.is_playing:
                axis.follow(session.time)
        imgui.set_cursor_screen_pos((place.x + self._gutter, place.y))
        scrubbed = em(self.RULER_HEIGHT) + self._waveform.height
        imgui.invisible_button("##time", (room.x - self._gutter, scrubbed))
        self._gui.remember("time")
        self._is_held = imgui.is_item_hovered() or self._drag is not None
        if imgui.is_item_hovered():
            self._press_in_ruler(io)
            self._turn_wheel(io)
        edges = place.y, place.y + em(self.RULER_HEIGHT)
        key_marks.draw_ruler(self._gui.theme, axis, session.time, duration, edges)
        self._waveform.draw(session.time, duration, (place.x, edges[1]))
        imgui.set_cursor_screen_pos((place.x, edges[1] + self._waveform.height))
        self._draw_rows(io)
        if self.settings.shows_curves:
            self._draw_graph(io, place.x)
        if self._drag is not None:
            self._follow(io, self._drag)
        if self._wants_menu:
            imgui.open_popup("key menu")
            self._wants_menu = False
        if imgui.begin_popup("key menu"):
            self._menus.draw_menu("Keys")
            imgui.end_popup()

    def _draw_rows(self, io: Any) -> None:
        """Draw the rows, or only the names of curves."""
        flags = imgui.WindowFlags_.no_scroll_with_mouse | imgui.WindowFlags_.no_background
        least = max(self._bottom - imgui.get_cursor_screen_pos().y, em(self.ROW_HEIGHT))
        has_keys = not self.settings.shows_curves
        imgui.begin_child("keys", (0.0 if has_keys else self._gutter, least), 0, flags)
        place = imgui.get_cursor_screen_pos()
        room = imgui.get_content_region_avail()
        heights = [em(self.ROW_HEIGHT) * (track.height if has_keys else 1.0) for track in self.rows]
        self._tops = list(itertools.accumulate(heights, initial=place.y))
        imgui.invisible_button("##keys", (room.x, self._tops[-1] - place.y))
        self._gui.remember("keys")
        is_hovered = imgui.is_item_hovered()
        theme = self._gui.theme
        duration = self._session.script.duration
        painter = key_marks.TrackPainter(theme, self.axis, self.selection.keys, duration)
        for track, (top, bottom) in zip(self.rows, itertools.pairwise(self._tops), strict=True):
            if imgui.is_rect_visible((place.x, top), (place.x + room.x, bottom)):
                if has_keys:
                    self._are_dense[track.name] = painter.draw(track, top, em(self.ROW_HEIGHT))
                self._draw_name(track, (place.x, bottom - em(self.ROW_HEIGHT)), room.x)
        if has_keys:
            self._draw_over(io, (place.y, self._tops[-1]))
        if is_hovered and self._drag is None:
            self._hover(io, place.x)
        imgui.end_child()

    def _draw_name(self, track: Track, corner: key_marks.WindowPoint, room: float) -> None:
        arrow = em(0.9) if track.is_sum else 0.0
        indent = em(0.5) * len(track.parents)
        x = corner[0] + indent
        y = corner[1] + 0.5 * (em(self.ROW_HEIGHT) - em())
        self._gui.places[f"row {track.name}"] = x, y, x + em(4.0), y + em()
        room = min(room, self._gutter) - indent - arrow - em(0.3)
        label = shortened(track.label, room, keeps_end=not track.is_sum)  # keeps the side's name
        is_curve = self.settings.shows_curves and track.control
        muted = self._gui.theme.muted
        ink = self.graph.colour(track) if is_curve else ink_of(muted)
        key_marks.draw_label(label, (x, y), ink, arrow, is_open=self._is_open(track.name))

    def _draw_over(self, io: Any, edges: tuple[float, float]) -> None:
        key_marks.draw_playhead(self._gui.theme, self.axis, self._session.time, edges)
        if self._drag is not None and self._drag.doing == "box" and self._drag.has_moved:
            key_marks.draw_box(self._gui.theme, self._drag.began, io.mouse_pos)

    def _draw_graph(self, io: Any, left: float) -> None:
        imgui.same_line(0.0, 0.0)
        top = imgui.get_cursor_screen_pos().y
        width = imgui.get_content_region_avail().x
        edges = top, top + max(self._bottom - top, em(self.ROW_HEIGHT))
        imgui.invisible_button("##graph", (max(width, 1.0), edges[1] - top))
        if imgui.is_item_hovered() and self._drag is None:
            self._hover(io, left)
        is_held = self._drag is not None and self._drag.doing == "keys"
        self.graph.draw(edges, self._session.script.duration, is_held=is_held)
        self._draw_over(io, edges)

    # The mouse

    def _hover(self, io: Any, left: float) -> None:
        """Respond to the mouse over rows or curves while no button is pressed."""
        selection = self.selection
        axis = self.axis
        (x, y) = io.mouse_pos
        row = self._row_at(y)
        hit = None
        under = NO_KEYS
        graph = self.graph
        track = self.rows[row] if 0 <= row < len(self.rows) else None
        if x < left + self._gutter:
            if track is not None:
                imgui.set_tooltip(track.label)
                if imgui.is_mouse_clicked(LEFT_BUTTON) and track.is_sum:
                    self.settings.folds[track.name] = not self._is_open(track.name)
                elif imgui.is_mouse_clicked(LEFT_BUTTON):
                    selection.keys = track.keys
            imgui.set_scroll_y(imgui.get_scroll_y() - em(self.ROW_HEIGHT) * io.mouse_wheel)
            return
        key_reach = 0.5  # [em] from a key within which the mouse is on it
        if self.settings.shows_curves:
            graph.handle = graph.handle_at(x, y)
            hit = None if graph.handle else graph.at(x, y)
            under = hit.key if hit else NO_KEYS
        elif track is not None:
            under = track.keys.nearest(axis.time(x), axis.seconds(em(key_reach)))
        if (under or hit) and not imgui.is_mouse_down(LEFT_BUTTON):
            value = f"{hit.curve.label} {hit.value:.2f}" if hit else ""
            imgui.set_tooltip(f"{under.first:.2f} s  {value}".rstrip() if under else value)
        if self.settings.shows_curves and graph.handle is not None:
            imgui.set_mouse_cursor(imgui.MouseCursor_.resize_ns)
            if imgui.is_mouse_clicked(LEFT_BUTTON):
                self._begin("slope", io)
        elif imgui.is_mouse_clicked(LEFT_BUTTON):
            graph.held = hit
            is_dense = hit is None and track is not None and self._are_dense.get(track.name, False)
            self._press(io, under, is_dense=is_dense)
        elif imgui.is_mouse_clicked(RIGHT_BUTTON):
            if under and not under <= selection.keys:
                selection.keys = under
            self._wants_menu = True
        self._turn_wheel(io)

    def _row_at(self, y: float) -> int:
        return bisect.bisect_right(self._tops, y) - 1

    def _begin(self, doing: str, io: Any, selected: KeySet | None = None) -> None:
        """Begin a drag. selected: the keys to select from now on, None to keep the selection."""
        keys = self.selection.keys if selected is None else selected
        self._drag = Drag(doing, (*io.mouse_pos,), self._session.script, keys)

    def _press(self, io: Any, under: KeySet, *, is_dense: bool) -> None:
        selection = self.selection
        if not under or (is_dense and not under <= selection.keys):
            self._grabbed = under
            self._begin("box", io, selection.keys if io.key_shift else NO_KEYS)
        else:
            keys = selection.keys
            if io.key_shift:
                selection.keys = keys - under if under <= keys else keys | under
            elif not under <= keys:
                selection.keys = under
            self._begin("keys", io)
            self._grabbed = under

    def _press_in_ruler(self, io: Any) -> None:
        end = self.axis.x(self._session.script.duration)
        is_at_end = end < io.mouse_pos.x < end + em(key_marks.FLAG_SIZE)
        if is_at_end:
            imgui.set_mouse_cursor(imgui.MouseCursor_.resize_ew)
            if self._drag is None:
                imgui.set_tooltip("drag the script's end")
        if self._drag is None and imgui.is_mouse_clicked(LEFT_BUTTON):
            self._begin("end" if is_at_end else "scrub", io)

    def _turn_wheel(self, io: Any) -> None:
        """Zoom about the mouse, scroll by Shift or a sideways wheel, pan by the middle button."""
        if self._drag is None and imgui.is_mouse_clicked(MIDDLE_BUTTON):
            self._begin("pan", io)
        sideways = io.mouse_wheel_h or (io.mouse_wheel if io.key_shift else 0.0)
        zoom_per_notch = 0.8
        if sideways:
            scroll_per_notch = 0.12  # share of the visible time
            self.axis.scroll(-scroll_per_notch * self.axis.span * sideways)
        elif io.mouse_wheel:
            self.axis.zoom(zoom_per_notch**io.mouse_wheel, io.mouse_pos.x)

    def _follow(self, io: Any, drag: Drag) -> None:
        """Continue the drag until the button is released; Escape undoes the drag."""
        (x, y) = io.mouse_pos
        axis = self.axis
        session = self._session
        distance = abs(x - drag.began[0]) + abs(y - drag.began[1])
        drag.has_moved = drag.has_moved or distance > self.CLICK_DISTANCE
        act: dict[str, Task] = {
            "keys": lambda: self._move_keys(io, drag),
            "box": lambda: self._select_box(io, drag),
            "scrub": lambda: session.seek(self._snapped(axis.time(x), io)),
            "end": lambda: session.edit(
                keyframes.with_duration(drag.script, axis.time(x)), is_done=False
            ),
            "pan": lambda: axis.scroll(-axis.seconds(io.mouse_delta.x)),
            "slope": lambda: self._bend(y, drag),
        }
        if drag.has_moved or drag.doing in ("scrub", "pan"):
            self._messages.attempt(act[drag.doing])
        if imgui.is_key_pressed(imgui.Key.escape) and drag.doing in ("keys", "end", "slope"):
            self._drag = None
            self._messages.attempt(lambda: session.edit(drag.script, is_done=False))
            self.selection.keys = drag.selected
        elif not imgui.is_mouse_down(MIDDLE_BUTTON if drag.doing == "pan" else LEFT_BUTTON):
            self._drag = None
            self._messages.attempt(lambda: self._release(io, drag))

    def _snapped(self, time: float, io: Any) -> float:
        """Return the time of the nearest frame, or with Ctrl the exact time [s]."""
        return time if io.key_ctrl else keyframes.on_frame(time)

    def _move_keys(self, io: Any, drag: Drag) -> None:
        right = io.mouse_pos.x - drag.began[0]
        down = io.mouse_pos.y - drag.began[1]
        if not io.key_ctrl:  # ignores small motion along either axis
            right, down = (0.0 if abs(way) < self.CLICK_DISTANCE else way for way in (right, down))
        time = self._grabbed.first
        target = time + self.axis.seconds(right)
        target = min(max(target, 0.0), self.axis.end)  # later times are invisible
        offset = self._snapped(target, io) - time if right else 0.0
        script, keys = keyframes.moved(drag.script, drag.selected, offset)
        line = f"{time + offset:.2f} s"
        held = self.graph.held
        if held is not None:
            amount = down / self.graph.slope
            if amount and not io.key_ctrl:
                amount = round(held.value + amount, 2) - held.value
            limits = self._session.controls.limits
            posed = {held.curve.control}
            script = keyframes.raised(script, keys, amount, limits, posed)
            line += f", {held.curve.label} {held.value + amount:.2f}"
        self._session.edit(script, is_done=False)
        self.selection.keys = keys
        imgui.set_tooltip(line)

    def _bend(self, y: float, drag: Drag) -> None:
        assert self.graph.handle is not None
        easing = self.graph.bent(self.graph.handle, y)
        script = keyframes.eased(drag.script, self.graph.handle.key, easing)
        self._session.edit(script, is_done=False)
        imgui.set_tooltip(f"slopes {easing}")

    def _select_box(self, io: Any, drag: Drag) -> None:
        corner = (io.mouse_pos.x, io.mouse_pos.y)
        inside = NO_KEYS
        if self.settings.shows_curves:
            inside = self.graph.inside(drag.began, corner)
        else:
            times = sorted(self.axis.time(x) for x in (drag.began[0], corner[0]))
            rows = sorted(self._row_at(y) for y in (drag.began[1], corner[1]))
            for track in self.rows[max(rows[0], 0) : max(rows[1] + 1, 0)]:
                inside |= track.keys.between(*times)
        self.selection.keys = drag.selected | inside

    def _release(self, io: Any, drag: Drag) -> Message:
        """End the drag at the release; return a message about the change."""
        session = self._session
        line = None
        if drag.doing == "keys" and drag.has_moved:
            lost = len(keyframes.all_keys(drag.script)) - len(keyframes.all_keys(session.script))
            line = f"{counted(lost, 'key')} replaced; [Undo] restores them" if lost > 0 else None
        elif drag.doing in ("keys", "box") and not drag.has_moved:
            if drag.doing == "box":
                self.selection.keys = drag.selected | self._grabbed
            if self._grabbed and not io.key_shift:
                self.selection.keys = self._grabbed
                session.is_playing = False
                line = session.seek(self._grabbed.first)
        if drag.doing in ("keys", "end", "slope") and drag.has_moved:
            session.note()
        return line
