"""Draws ruler, rows and keys of the timeline; dope_sheet.py carries out the mouse's actions."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
from imgui_bundle import imgui

from risorius.geometry.arrays import Floats64

from ...script.key_sets import KeySet
from ...sound.decoding import Peaks
from ..interface.gui import Gui, Theme, em, ink_of
from ..interface.widgets import shortened
from ..session.soundtrack import Soundtrack
from .keys import Track
from .time_axis import TimeAxis

FLAG_SIZE = 0.7  # [em] of the handle at the script's end

WindowPoint = tuple[float, float]


def draw_ruler(
    theme: Theme, axis: TimeAxis, time: float, duration: float, edges: tuple[float, float]
) -> None:
    """Draw ticks with seconds, the script's end, and a handle for scrubbing at the current time.

    time, duration: [s]. edges: the upper and the lower edge [window units].
    """
    lines = imgui.get_window_draw_list()
    (top, bottom) = edges
    ink = ink_of(theme.muted)
    label_room = 4.2  # [em] between two labels of the ruler
    for at, has_label in axis.ticks(em(label_room)):
        x = round(axis.x(at)) + 0.5
        height = em(0.45) if has_label else em(0.22)
        lines.add_line((x, bottom - height), (x, bottom), ink)
        if has_label:
            label = number_of(at)
            lines.add_text((x - 0.5 * imgui.calc_text_size(label).x, top), ink, label)
    end = axis.x(duration)
    if end <= axis.x(axis.end):
        tip = end + em(FLAG_SIZE), bottom - 0.5 * em(FLAG_SIZE)
        lines.add_triangle_filled((end, bottom - em(FLAG_SIZE)), tip, (end, bottom), ink)
    if axis.start <= time <= axis.end:  # the handle is below the numbers
        x = axis.x(time)
        half = em(0.4)
        left = (x - half, bottom - 1.3 * half)
        right = (x + half, bottom - 1.3 * half)
        lines.add_triangle_filled(left, right, (x, bottom), ink_of(theme.accent))


def number_of(time: float) -> str:
    """Return the shortest text for seconds, with minutes if there are any."""
    if time < 60.0:
        return f"{time:.3g} s" if time == 0.0 else f"{time:.3g}"
    minutes, seconds = divmod(round(time, 2), 60.0)
    fraction = f"{seconds % 1.0:.2f}"[1:].rstrip("0").rstrip(".")
    return f"{minutes:.0f}:{seconds // 1.0:02.0f}{fraction}"


def draw_playhead(theme: Theme, axis: TimeAxis, time: float, edges: tuple[float, float]) -> None:
    """Draw the line at the current time [s], from one edge to the other [window units]."""
    if axis.start <= time <= axis.end:
        x = round(axis.x(time)) + 0.5
        ink = ink_of(theme.accent)
        width = max(em(0.09), 1.0)
        imgui.get_window_draw_list().add_line((x, edges[0]), (x, edges[1]), ink, width)


def draw_label(
    text: str, corner: WindowPoint, ink: int, arrow: float = 0.0, *, is_open: bool = False
) -> None:
    """Draw the name of a row at its upper left corner, with an arrow if it folds."""
    lines = imgui.get_window_draw_list()
    (left, top) = corner
    if arrow:
        direction = imgui.Dir.down if is_open else imgui.Dir.right
        imgui.internal.render_arrow(lines, (left, top + em(0.15)), ink, direction, 0.7)
    lines.add_text((left + arrow, top), ink, text)


class TrackPainter:
    """Draws rows of keys along an axis, with the selected keys highlighted."""

    KEY_RADIUS = 0.36  # [em] from a key's middle to its corners

    def __init__(self, theme: Theme, axis: TimeAxis, selected: KeySet, duration: float) -> None:
        """duration: duration of the script [s]."""
        self._theme = theme
        self._axis = axis
        self._selected = selected
        self._lines = imgui.get_window_draw_list()
        self._low = axis.x(axis.start) - em(0.5)
        self._high = axis.x(axis.end) + em(0.5)
        margin = axis.seconds(em(0.5))
        least_key_distance = 2.0  # [window units]: nearer keys are drawn as one
        count = max(round((self._high - self._low) / least_key_distance), 2)
        # Edges of columns [s].
        self._edges = np.linspace(axis.start - margin, axis.end + margin, count + 1)
        self._script_end = min(max(axis.x(duration), self._low), self._high)

    def draw(self, track: Track, top: float, unit: float) -> bool:
        """Draw the background, keys and names of a row; `unit` is the height of an ordinary row.

        Returns whether the visible keys are too dense to be drawn one by one.
        """
        lines = self._lines
        theme = self._theme
        axis = self._axis
        bottom = top + track.height * unit
        low = self._low
        high = self._high
        middle = bottom - 0.5 * unit
        first = (low, top + 1.0)
        last = (high, bottom - 1.0)
        lines.add_rect_filled(first, last, ink_of(theme.field, 0.45), em(0.2))
        lines.add_rect_filled(first, (self._script_end, last[1]), ink_of(theme.field), em(0.2))
        if len(track.channel):
            edges = self._edges
            (least, most) = track.channel.ends
            times, values = track.channel.outline(edges[0], edges[-1], len(edges))
            least = min(least, 0.0)
            most = max(most, 1.0)
            heights = bottom - unit * (0.15 + 0.7 * (values - least) / (most - least))
            draw_line(axis.x(times), heights, ink_of(theme.muted))
        self._draw_names(track, top)
        return self._draw_keys(track, middle)

    def _draw_keys(self, track: Track, middle: float) -> bool:
        """Draw the visible keys, selected keys on top; return whether the keys are too dense."""
        size = em(self.KEY_RADIUS if track.is_whole else 0.8 * self.KEY_RADIUS)
        ink = imgui.get_color_u32(imgui.Col_.text) if track.is_whole else ink_of(self._theme.muted)
        names = track.keys.times
        marks, chosen = (
            self._axis.x(keys.latest_in(self._edges, names))
            for keys in (track.keys, self._selected)
        )
        most_covered_fraction = 0.5  # of the row's width: with more, keys are too dense
        is_dense = len(marks) * 2.0 * size > most_covered_fraction * (self._high - self._low)
        seen = marks[:0] if is_dense and len(track.channel) else marks
        accent = ink_of(self._theme.accent)
        for xs, reach, fill in ((seen, size, ink), (chosen, 1.2 * size, accent)):
            for x in xs.tolist():
                self._lines.add_ngon_filled((x, middle), reach, fill, 4)
        return is_dense

    def _draw_names(self, track: Track, top: float) -> None:
        """Draw the names of poses above their keys; a name ends at the next visible name."""
        axis = self._axis
        ink = ink_of(self._theme.muted)
        end = self._high
        least_name_width = 2.4  # [em]: a narrower name is unreadable
        for time, name in reversed(track.names):
            if axis.start <= time <= axis.end:
                x = axis.x(time) - em(self.KEY_RADIUS)
                room = end - x
                if room >= min(em(least_name_width), imgui.calc_text_size(name).x):
                    self._lines.add_text((x, top), ink, shortened(name, room))
                    end = axis.x(time) - em(0.6)


def draw_line(xs: Floats64, ys: Floats64, ink: int, width: float = 1.0) -> None:
    """Draw a line through points."""
    points: Any = np.stack([xs, ys], axis=1).tolist()
    imgui.get_window_draw_list().add_polyline(points, ink, width, 0)


def draw_box(theme: Theme, first: WindowPoint, last: WindowPoint) -> None:
    """Draw the box of a drag over an empty place."""
    lines = imgui.get_window_draw_list()
    lines.add_rect_filled(first, last, ink_of(theme.accent, 0.15))
    lines.add_rect(first, last, ink_of(theme.accent, 0.8))


peaks_of = functools.lru_cache(maxsize=1)(Peaks)


class Waveform:
    """Draws the waveform of the script's sound; without a sound its height is 0."""

    def __init__(self, gui: Gui, soundtrack: Soundtrack, axis: TimeAxis) -> None:
        self._gui = gui
        self._soundtrack = soundtrack
        self._axis = axis

    @property
    def height(self) -> float:
        """The height of the row [window units]."""
        return em(2.6) if self._soundtrack.sound is not None else 0.0

    @property
    def duration(self) -> float:
        """The duration of the sound [s]."""
        sound = self._soundtrack.sound
        return sound.duration if sound is not None else 0.0

    def draw(self, time: float, duration: float, corner: WindowPoint) -> None:
        """Draw the waveform from its upper left corner; it is faint after the script's end.

        time: the current time [s]. duration: duration of the script [s].
        """
        sound = self._soundtrack.sound
        axis = self._axis
        theme = self._gui.theme
        if sound is None:
            return
        lines = imgui.get_window_draw_list()
        (left, top) = corner
        bottom = top + self.height - 1.0
        first = round(axis.x(axis.start))
        last = round(axis.x(axis.end))
        lines.add_rect_filled(
            (first - em(0.5), top + 1.0), (last + em(0.5), bottom), ink_of(theme.field), em(0.2)
        )
        draw_label("Sound", (left, top + 0.5 * (self.height - em())), ink_of(theme.muted))
        low, high = peaks_of(sound).between(axis.time(first), axis.time(last), max(last - first, 1))
        middle = 0.5 * (top + bottom)
        reach = 0.5 * (bottom - top) - em(0.2)
        inside = ink_of(theme.muted)
        outside = ink_of(theme.muted, 0.35)
        ends = axis.x(duration)
        least_amplitude = 0.5  # [window units]: silence is a thin line
        uppers = (middle - least_amplitude - reach * high).tolist()
        lowers = (middle + least_amplitude - reach * low).tolist()
        for x, (upper, lower) in enumerate(zip(uppers, lowers, strict=True), start=first):
            lines.add_rect_filled((x, upper), (x + 1.0, lower), inside if x < ends else outside)
        draw_playhead(theme, axis, time, (top, bottom + 1.0))
