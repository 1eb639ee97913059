"""How ruler, rows and keys of the timeline look; what they do is in dope_sheet.py."""

from __future__ import annotations

from typing import Any

import numpy as np
from imgui_bundle import imgui

from ...script import Channel, Floats
from ..gui import Theme, colour, em
from ..places import Places
from ..time_axis import TimeAxis
from ..tracks import Track
from .widgets import shortened

LABEL_ROOM = 4.2  # [em] between two labels of the ruler
FLAG = 0.7  # [em] of the handle at the script's end
KEY = 0.36  # [em] from a key's middle to its corners
LEAST_NAME = 2.4  # [em] of a pose's name: less would be no name
CLOSEST = 2.0  # [window units] keys nearer than that are drawn as one
MOST_COVERED = 0.5  # of a row by keys that are drawn one by one

Point = tuple[float, float]


def _ink(rgb: tuple[float, float, float], opacity: float = 1.0) -> int:
    return int(imgui.get_color_u32(colour(rgb, opacity)))


def _text_ink() -> int:
    return int(imgui.get_color_u32(imgui.Col_.text))


def draw_ruler(
    theme: Theme, axis: TimeAxis, time: float, duration: float, edges: tuple[float, float]
) -> None:
    """Ticks with seconds, the script's end, and at the time shown what is dragged to scrub.

    time, duration: [s]. edges: the upper and the lower one [window units].
    """
    lines, (top, bottom) = imgui.get_window_draw_list(), edges
    ink = _ink(theme.muted)
    for tick in axis.ticks(em(LABEL_ROOM)):
        x = round(axis.x(tick.time)) + 0.5
        height = em(0.45) if tick.has_label else em(0.22)
        lines.add_line((x, bottom - height), (x, bottom), ink)
        if tick.has_label:
            lines.add_text((x + em(0.2), top), ink, label_of(tick.time))
    end = axis.x(duration)
    if end <= axis.x(axis.end):
        tip = end + em(FLAG), bottom - 0.5 * em(FLAG)
        lines.add_triangle_filled((end, bottom - em(FLAG)), tip, (end, bottom), ink)
    draw_playhead(theme, axis, time, edges)
    if axis.start <= time <= axis.end:
        x, half = axis.x(time), em(0.4)
        tip = x, top + 1.3 * half
        lines.add_triangle_filled((x - half, top), (x + half, top), tip, _ink(theme.accent))


def label_of(time: float) -> str:
    """Seconds as short as they can be told, minutes where there are some."""
    if time < 60.0:
        return f"{time:.3g} s" if time == 0.0 else f"{time:.3g}"
    minutes, seconds = divmod(round(time, 2), 60.0)
    fraction = f"{seconds % 1.0:.2f}"[1:].rstrip("0").rstrip(".")
    return f"{minutes:.0f}:{seconds // 1.0:02.0f}{fraction}"


def draw_playhead(theme: Theme, axis: TimeAxis, time: float, edges: tuple[float, float]) -> None:
    """The line at the time shown [s], from one edge to the other [window units]."""
    if axis.start <= time <= axis.end:
        x = round(axis.x(time)) + 0.5
        width = max(em(0.09), 1.0)
        lines = imgui.get_window_draw_list()
        lines.add_line((x, edges[0]), (x, edges[1]), _ink(theme.accent), width)


def draw_unkeyed(theme: Theme, axis: TimeAxis, time: float, y: float) -> None:
    """A hollow key at a time [s], where one would be set for what differs from the script."""
    lines, size, x = imgui.get_window_draw_list(), em(1.2 * KEY), axis.x(time)
    corners = (x - size, y), (x, y - size), (x + size, y), (x, y + size)
    lines.add_quad_filled(*corners, _ink(theme.panel))
    lines.add_quad(*corners, _ink(theme.accent), em(0.12))


def draw_label(
    theme: Theme, text: str, corner: Point, height: float, arrow: float, *, is_open: bool
) -> None:
    """The name of a row from its upper left corner on, with an arrow where it folds."""
    lines, ink, (left, top) = imgui.get_window_draw_list(), _ink(theme.muted), corner
    if arrow:
        x, y, size = left + 0.4 * arrow, top + 0.5 * height, 0.28 * arrow
        back, tip = 0.6 * size, size
        if is_open:
            lines.add_triangle_filled((x - tip, y - back), (x + tip, y - back), (x, y + tip), ink)
        else:
            lines.add_triangle_filled((x - back, y - tip), (x + tip, y), (x - back, y + tip), ink)
    lines.add_text((left + arrow, top + 0.5 * (height - imgui.get_font_size())), ink, text)


class TrackPainter:
    """Draws tracks along an axis, with the selected keys of a script that lasts so long."""

    def __init__(self, theme: Theme, axis: TimeAxis, selected: Places, duration: float) -> None:
        """duration: of the script [s]."""
        self._theme, self._axis, self._selected = theme, axis, selected
        self._lines = imgui.get_window_draw_list()
        self._low, self._high = axis.x(axis.start) - em(0.5), axis.x(axis.end) + em(0.5)
        margin = axis.seconds(em(0.5))
        count = max(round((self._high - self._low) / CLOSEST), 2)
        self._edges = np.linspace(axis.start - margin, axis.end + margin, count + 1)  # of columns
        self._halves = axis.x(np.linspace(self._edges[0], self._edges[-1], 4 * count + 1)[1::2])
        self._script_end = min(max(axis.x(duration), self._low), self._high)

    def draw(self, track: Track, top: float, unit: float) -> bool:
        """A row of `unit` times its height: its ground, where nothing moves, keys, names.

        Returns whether the keys that are visible are too dense to be drawn one by one.
        """
        lines, theme, axis = self._lines, self._theme, self._axis
        bottom, low, high = top + track.height * unit, self._low, self._high
        middle = bottom - 0.5 * unit
        first, last = (low, top + 1.0), (high, bottom - 1.0)
        lines.add_rect_filled(first, last, _ink(theme.field, 0.45), em(0.2))
        lines.add_rect_filled(first, (self._script_end, last[1]), _ink(theme.field), em(0.2))
        for begin, finish in track.held:
            if finish > axis.start and begin < axis.end:
                ends = (max(axis.x(begin), low), middle), (min(axis.x(finish), high), middle)
                lines.add_line(*ends, _ink(theme.muted, 0.45), em(0.22))
        if track.channel is not None:
            self._draw_curve(track.channel, bottom - 0.15 * unit, bottom - 0.85 * unit)
        self._draw_names(track, top)
        return self._draw_keys(track, middle, unit)

    def _draw_curve(self, channel: Channel, low: float, high: float) -> None:
        """The values of a track over time, between two heights [window units]."""
        lowest, highest = channel.extremes(self._edges)
        least, most = min(channel.values.min(), 0.0), max(channel.values.max(), 1.0)
        is_falling = np.gradient(lowest + highest) < 0.0
        first, second = np.where(is_falling, (highest, lowest), (lowest, highest))
        values = np.stack([first, second], axis=1).ravel()  # a point for each half of a column
        heights = low + (high - low) * (values - least) / (most - least)
        line: Any = np.stack([self._halves, heights], axis=1).tolist()
        self._lines.add_polyline(line, _ink(self._theme.muted), 1.0, 0)

    def _draw_keys(self, track: Track, middle: float, unit: float) -> bool:
        """The visible keys, selected ones on top: one by one, or if they are dense as bars.

        In rows with a curve, which tells more, bars show what is selected only.
        """
        size = em(KEY if track.is_whole else 0.8 * KEY)
        ink = _text_ink() if track.is_whole else _ink(self._theme.muted)
        names = track.places.times
        marks, chosen = (
            self._axis.x(places.latest_in(self._edges, names))
            for places in (track.places, self._selected)
        )
        is_dense = len(marks) * 2.0 * size > MOST_COVERED * (self._high - self._low)
        if not is_dense:
            self._draw_diamonds(marks, middle, size, ink)
            self._draw_diamonds(chosen, middle, 1.2 * size, _ink(self._theme.accent))
        elif track.channel is None:
            self._draw_bars(marks, size, (middle - 0.5 * size, middle + 0.5 * size), ink)
            bar = middle - 0.6 * size, middle + 0.6 * size
            self._draw_bars(chosen, size, bar, _ink(self._theme.accent))
        else:
            row = middle - 0.5 * unit + 1.0, middle + 0.5 * unit - 1.0
            self._draw_bars(chosen, size, row, _ink(self._theme.accent, 0.35))
        return is_dense

    def _draw_diamonds(self, marks: Floats, middle: float, reach: float, fill: int) -> None:
        """A diamond for each mark."""
        for x in marks.tolist():
            left, right = (x - reach, middle), (x + reach, middle)
            top, bottom = (x, middle - reach), (x, middle + reach)
            self._lines.add_quad_filled(left, top, right, bottom, fill)

    def _draw_bars(self, marks: Floats, reach: float, edges: Point, fill: int) -> None:
        """A bar for all marks of which each is near the next, between an upper and a lower edge."""
        if not len(marks):
            return
        ends = np.flatnonzero(np.diff(marks) > 4.0 * reach)
        lasts = marks[np.append(ends, -1)].tolist()
        for first, last in zip(marks[np.append(0, ends + 1)].tolist(), lasts, strict=True):
            left, right = max(first - reach, self._low), min(last + reach, self._high)
            self._lines.add_rect_filled((left, edges[0]), (right, edges[1]), fill, 0.5 * reach)

    def _draw_names(self, track: Track, top: float) -> None:
        """The names of poses above them, as much of each as there is room for before the next."""
        axis, ink = self._axis, _ink(self._theme.muted)
        ends = [axis.x(time) - em(0.6) for time, _ in track.names[1:]] + [self._high]
        for (time, name), end in zip(track.names, ends, strict=False):
            if axis.start <= time <= axis.end:
                x = axis.x(time) - em(KEY)
                room = min(end, self._high) - x
                if room >= min(em(LEAST_NAME), imgui.calc_text_size(name).x):
                    self._lines.add_text((x, top), ink, shortened(name, room))


def draw_box(theme: Theme, first: Point, last: Point) -> None:
    """What a drag over nothing encloses."""
    lines, accent = imgui.get_window_draw_list(), theme.accent
    low = (min(first[0], last[0]), min(first[1], last[1]))
    high = (max(first[0], last[0]), max(first[1], last[1]))
    lines.add_rect_filled(low, high, _ink(accent, 0.15))
    lines.add_rect(low, high, _ink(accent, 0.8))
