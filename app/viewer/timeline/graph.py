"""Keys as curves: the value of each control over time, as the script plays it.

A curve belongs to a track, or to one control of the poses; a drag of its key up or down changes
this control in the pose. The segment that ends at a selected key has two handles, which are the
control points of a Bezier curve; they can be dragged up and down. dope_sheet.py carries out the
actions of the mouse.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np
from imgui_bundle import imgui

from ...script.easings import free_easing
from ...script.key_sets import NO_KEYS, KeyId, KeySet, is_any_of
from ...script.keyframes import EQUAL_TOLERANCE
from ..interface.gui import Gui, em, ink_of
from .key_marks import WindowPoint, draw_line
from .keys import KeySelection, Track
from .time_axis import TimeAxis

VALUE_STEPS = tuple(digit * 10.0**power for power in range(-4, 6) for digit in (1.0, 2.0, 5.0))


class Hit(NamedTuple):
    """The curve under a point of the graph, and the key there, if there is one."""

    curve: Track
    value: float
    key: KeySet = NO_KEYS


class Handle(NamedTuple):
    """A Bezier control point of the segment that ends at `key`; it sets the slope at one end."""

    key: KeySet
    number: int  # 0: at the start of the segment, 1: at its end
    slopes: tuple[float, float]  # at both ends, relative to the mean slope
    ends: tuple[float, float]  # the values at this end and at the other end of the segment
    place: WindowPoint
    root: WindowPoint  # place of this end


class Graph:
    """Draws curves over a time axis and a value axis, and finds keys and curves by place."""

    MOUSE_REACH = 0.55  # [em] from a key or curve within which the mouse is on it
    KEY_RADIUS = 0.27  # [em] from a key's middle to its corners

    def __init__(self, gui: Gui, selection: KeySelection, axis: TimeAxis) -> None:
        self._gui = gui
        self._selection = selection
        self._axis = axis
        self.curves: list[Track] = []
        self.held: Hit | None = None  # the curve or key that the mouse was pressed on
        self.handle: Handle | None = None  # the handle that the mouse was pressed on
        self._low = 0.0  # lowest visible value
        self._high = 1.0  # highest visible value
        self._bottom = 0.0  # y of the lowest value [window units]
        self.slope = -1.0  # change of y for a value of 1 [window units]

    def display(self, rows: Iterable[Track]) -> None:
        """Display the curves of these rows; those with selected keys are in front."""
        self.curves = sorted((row for row in rows if row.control), key=self._is_selected)

    def colour(self, curve: Track, opacity: float = 1.0) -> int:
        """Return the colour of a curve; steps of the golden ratio separate neighbours."""
        light = (0.55, 0.95) if self._gui.theme.is_dark else (0.9, 0.6)
        hue = (0.58 + 0.618034 * curve.number) % 1.0
        return ink_of(imgui.color_convert_hsv_to_rgb(hue, *light), opacity)

    def _is_selected(self, curve: Track) -> bool:
        return curve.track in self._selection.keys.times

    def y(self, value: Any) -> Any:
        """Return the y of a value, or of each value of an array [window units]."""
        return self._bottom + self.slope * (value - self._low)

    # Places of keys and curves

    def at(self, x: float, y: float) -> Hit | None:
        """Return the key at a place, or else the curve; dense keys count only if selected."""
        axis = self._axis
        reach = em(self.MOUSE_REACH)
        hits = list[tuple[float, Hit]]()
        for curve in self.curves[::-1]:
            channel = curve.channel
            value = curve.channel.value(axis.time(x))
            hits.append((reach + abs(self.y(value) - y), Hit(curve, value)))
            ends = np.searchsorted(channel.times, (axis.time(x - reach), axis.time(x + reach)))
            times = channel.times[slice(*ends)]
            values = channel.values[slice(*ends)]
            away = np.hypot(axis.x(times) - x, self.y(values) - y)
            if len(away) and away.min() < reach:
                number = int(away.argmin())
                key = KeySet.from_keys(KeyId(curve.track, float(times[number])))
                if not self._is_dense(curve) or key <= self._selection.keys:
                    hits.append((away[number], Hit(curve, float(values[number]), key)))
        distance, hit = min(hits, key=lambda each: each[0], default=(0.0, None))
        return hit if distance < 2.0 * reach else None

    def handles(self) -> Iterator[Handle]:
        """Yield the handles of segments that end at selected keys, where there is room."""
        axis = self._axis
        for curve in self.curves:
            channel = curve.channel
            chosen = self._selection.keys.times.get(curve.track, channel.times[:0])
            if not len(chosen) or self._is_dense(curve):
                continue
            begin, end = np.searchsorted(channel.times, (axis.start, axis.end))
            visible = np.arange(max(begin, 1), min(end + 1, len(channel)))
            for number in visible[is_any_of(channel.times[visible], chosen)].tolist():
                easing = channel.easing(number)
                slopes = easing.slopes
                times, values = (
                    part[number - 1 : number + 1] for part in (channel.times, channel.values)
                )
                (x, right) = axis.x(times).tolist()
                (y, there) = self.y(values).tolist()
                reach = em(self.MOUSE_REACH)
                if easing.is_held or right - x < 3.0 * reach or abs(there - y) < reach:
                    continue  # no easing, or no room
                key = KeySet.from_keys(KeyId(curve.track, float(times[1])))
                across = (right - x) / 3.0
                rise = (there - y) / 3.0
                first = x + across, y + slopes[0] * rise
                last = right - across, there - slopes[1] * rise
                low, high = values.tolist()
                yield Handle(key, 0, slopes, (low, high), first, (x, y))
                yield Handle(key, 1, slopes, (high, low), last, (right, there))

    def handle_at(self, x: float, y: float) -> Handle | None:
        """Return the handle at a place, or None."""
        away = [
            (float(np.hypot(handle.place[0] - x, handle.place[1] - y)), handle)
            for handle in self.handles()
        ]
        distance, handle = min(away, key=lambda each: each[0], default=(0.0, None))
        return handle if distance < em(self.MOUSE_REACH) else None

    def bent(self, handle: Handle, y: float) -> str:
        """Return the easing of a segment whose handle was dragged to this y [window units]."""
        slopes = list(handle.slopes)
        (own, other) = map(self.y, handle.ends)
        slopes[handle.number] = 3.0 * (y - own) / (other - own)
        return free_easing(*slopes)

    def inside(self, first: WindowPoint, last: WindowPoint) -> KeySet:
        """Return the keys in a box."""
        (begin, end), (top, bottom) = (sorted(each) for each in zip(first, last, strict=True))
        found = NO_KEYS
        for curve in self.curves:
            heights = self.y(curve.channel.values)
            times = curve.channel.times[(heights >= top) & (heights <= bottom)]
            found |= KeySet({curve.track: times})
        return found.between(self._axis.time(begin), self._axis.time(end))

    def _is_dense(self, curve: Track) -> bool:
        """Whether the visible keys of a curve are too dense to distinguish."""
        axis = self._axis
        times = curve.channel.times
        count = np.diff(np.searchsorted(times, (axis.start, axis.end)))[0]
        return bool(1.5 * em(self.KEY_RADIUS) * count > axis.x(axis.end) - axis.x(axis.start))

    # Drawing

    def draw(self, edges: WindowPoint, duration: float, *, is_held: bool) -> None:
        """Draw the graph between an upper and a lower edge [window units].

        duration: duration of the script [s]. is_held: whether the mouse holds a curve, so that the
        value axis stays.
        """
        axis = self._axis
        lines = imgui.get_window_draw_list()
        if not is_held:
            self._fit(edges)
        left = axis.x(axis.start) - em(0.5)
        right = axis.x(axis.end) + em(0.5)
        self._draw_ground((left, edges[0]), (right, edges[1]), axis.x(duration))
        self._draw_values(left, right)
        lines.push_clip_rect((left, edges[0]), (right, edges[1]), True)
        most_points = 4000  # of all curves together
        columns = round(min(0.5 * (right - left), most_points / (len(self.curves) + 1)))
        for curve in self.curves:
            is_front = self._is_selected(curve) or not self._is_selected(self.curves[-1])
            ink = self.colour(curve, 1.0 if is_front else 0.3)
            times, values = curve.channel.outline(axis.start, axis.end, max(columns, 8))
            draw_line(axis.x(times), self.y(values), ink, em(0.12))
            self._draw_keys(curve, ink)
        self._draw_handles()
        lines.pop_clip_rect()

    def _fit(self, edges: WindowPoint) -> None:
        """Fit the value axis between the edges, so that all values are visible."""
        ends = [0.0, 1.0, *(end for curve in self.curves for end in curve.channel.ends)]
        self._low = min(ends)
        self._high = max(ends)
        padding = 0.8  # [em] between the highest value and the edge
        self._bottom = edges[1] - em(padding)
        height = max(self._bottom - edges[0] - em(padding), 1.0)
        self.slope = -height / (self._high - self._low)

    def _draw_ground(self, low: WindowPoint, high: WindowPoint, script_end: float) -> None:
        """Draw the background between two corners, stronger up to the script's end."""
        theme = self._gui.theme
        lines = imgui.get_window_draw_list()
        end = min(max(script_end, low[0]), high[0])
        lines.add_rect_filled(low, high, ink_of(theme.field, 0.45))
        lines.add_rect_filled(low, (end, high[1]), ink_of(theme.field))

    def _draw_values(self, left: float, right: float) -> None:
        """Draw lines at round values, with numbers at their left."""
        theme = self._gui.theme
        lines = imgui.get_window_draw_list()
        label_room = 1.6  # [em] between two labels of values
        wide = (each for each in VALUE_STEPS if -each * self.slope >= em(label_room))
        step = next(wide, VALUE_STEPS[-1])
        first = int(np.ceil(self._low / step - EQUAL_TOLERANCE))
        last = int(self._high / step + EQUAL_TOLERANCE)
        for number in range(first, last + 1):
            y = round(self.y(number * step)) + 0.5
            label = f"{number * step:g}"
            lines.add_line((left, y), (right, y), ink_of(theme.muted, 0.2 if number else 0.5))
            place = left - em(0.3) - imgui.calc_text_size(label).x, y - 0.5 * em()
            lines.add_text(place, ink_of(theme.muted), label)

    def _draw_handles(self) -> None:
        """Draw the handles, each with a line to its end of the segment."""
        accent = ink_of(self._gui.theme.accent)
        lines = imgui.get_window_draw_list()
        for handle in self.handles():
            lines.add_line(handle.root, handle.place, accent)
            lines.add_circle_filled(handle.place, em(0.8 * self.KEY_RADIUS), accent)

    def _draw_keys(self, curve: Track, ink: int) -> None:
        """Draw the visible keys, and the segments that end at selected keys."""
        axis = self._axis
        channel = curve.channel
        accent = ink_of(self._gui.theme.accent)
        begin, end = np.searchsorted(channel.times, (axis.start, axis.end))
        visible = slice(begin, end + 1)
        lines = imgui.get_window_draw_list()
        times = channel.times[visible]
        selected = self._selection.keys.times.get(curve.track, times[:0])
        are_chosen = is_any_of(times, selected)
        is_dense = self._is_dense(curve)
        chosen = times[are_chosen]
        befores = channel.times[np.maximum(np.searchsorted(channel.times, chosen) - 1, 0)]
        if is_dense:  # all segments as one line
            befores = befores[:1]
            chosen = chosen[-1:]
        for before, time in zip(befores.tolist(), chosen.tolist(), strict=True):
            points, values = channel.outline(max(before, axis.start), time, 400 if is_dense else 50)
            draw_line(axis.x(points), self.y(values), accent, em(0.16))
        if is_dense:
            return
        xs = axis.x(times).tolist()
        ys = self.y(channel.values[visible]).tolist()
        for x, y, is_chosen in zip(xs, ys, are_chosen.tolist(), strict=True):
            reach, fill = (1.4 * self.KEY_RADIUS, accent) if is_chosen else (self.KEY_RADIUS, ink)
            lines.add_ngon_filled((x, y), em(reach), fill, 4)
