"""The part of the script that the timeline displays; it converts between times and x."""

from __future__ import annotations

from typing import TypeVar

from risorius.geometry.arrays import Floats64

from ...script.keyframes import FRAME_TIME

SHORT_STEPS = (FRAME_TIME, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 30.0)  # [s] between ticks
TICK_STEPS = (*SHORT_STEPS, 60.0, 300.0, 600.0, 3600.0, 86_400.0)

Number = TypeVar("Number", float, Floats64)


class TimeAxis:
    """The visible part: `span` seconds of the script from `start` on; by default all."""

    LEAST_SPAN = 8.0 * FRAME_TIME  # [s] at the closest zoom

    def __init__(self) -> None:
        self.start = 0.0
        self.span = 1.0
        self.is_whole = True
        self._left = 0.0
        self._width = 1.0

    def show_whole_script(self) -> None:
        """Show the whole script."""
        self.is_whole = True

    def place(self, left: float, width: float) -> None:
        """Set the place of the axis [window units]."""
        self._left = left
        self._width = max(width, 1.0)

    def fit(self, end: float) -> None:
        """Keep the visible part inside a script that ends at `end` [s]."""
        margin_factor = 1.06  # room after the script's end, to drag keys there
        whole = max(end * margin_factor, self.LEAST_SPAN)
        self.is_whole = self.is_whole or self.span >= whole
        if self.is_whole:
            self.start = 0.0
            self.span = whole
        self.start = min(max(self.start, 0.0), whole - self.span)

    @property
    def end(self) -> float:
        """The last time that is visible [s]."""
        return self.start + self.span

    def x(self, time: Number) -> Number:
        """Return the x of a time, or of each time of an array [window units]."""
        return self._left + self._width * (time - self.start) / self.span

    def time(self, x: float) -> float:
        """Return the time at x [s], 0 or more."""
        return max(self.start + self.seconds(x - self._left), 0.0)

    def seconds(self, distance: float) -> float:
        """Convert a distance [window units] to a duration [s]."""
        return distance / self._width * self.span

    def zoom(self, factor: float, x: float) -> None:
        """Show `factor` times as much time; the time at `x` keeps its place."""
        fixed = self.time(x)
        self.span = max(self.span * factor, self.LEAST_SPAN)
        self.is_whole = False
        self.start = fixed - self.seconds(x - self._left)

    def scroll(self, seconds: float) -> None:
        """Show a part that begins `seconds` later."""
        self.start += seconds

    def follow(self, time: float) -> None:
        """Scroll by a page if a time is not visible."""
        if not self.start <= time <= self.end:
            self.start = time - 0.1 * self.span

    def ticks(self, label_width: float) -> list[tuple[float, bool]]:
        """Return the times of visible ticks [s], and whether each has room for a label."""
        wide = (step for step in TICK_STEPS[1:] if step >= self.seconds(label_width))
        labelled = next(wide, TICK_STEPS[-1])
        least_tick_ratio = 0.12  # distance of ticks, relative to a label's width
        least = self.seconds(least_tick_ratio * label_width)
        parts = ((step, labelled / step) for step in TICK_STEPS if least <= step < labelled)
        finer = [
            step for step, count in parts if abs(count - round(count)) < 1e-6
        ]  # divides evenly
        marked = finer[0] if finer else labelled
        count = round(labelled / marked)
        first, last = (int(time / marked) for time in (self.start, self.end))
        return [
            (number * marked, number % count == 0)
            for number in range(first, last + 1)
            if number * marked >= self.start
        ]
