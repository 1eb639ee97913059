"""The sound in time, a row of its own between the ruler and the keys."""

from __future__ import annotations

from imgui_bundle import imgui

from ...sound.peaks import Peaks
from ..interface.gui import Gui, em, ink_of
from ..session.soundtrack import Soundtrack
from . import key_marks
from .time_axis import TimeAxis

HEIGHT = 2.6  # [em]
LEAST = 0.5  # [window units] from the middle: silence is a thin line


class Waveform:
    """Draws the sound of the script; of no height where there is none."""

    def __init__(self, gui: Gui, soundtrack: Soundtrack, axis: TimeAxis) -> None:
        self._gui, self._soundtrack, self._axis = gui, soundtrack, axis
        self._known: tuple[object, Peaks | None] = None, None

    @property
    def height(self) -> float:
        """Of the row [window units]."""
        return em(HEIGHT) if self._soundtrack.sound is not None else 0.0

    @property
    def duration(self) -> float:
        """Of the sound [s]."""
        sound = self._soundtrack.sound
        return sound.duration if sound is not None else 0.0

    def draw(self, time: float, duration: float, corner: key_marks.Point) -> None:
        """Draw it from its upper left corner on; what comes after the script's end is faint.

        time, duration: that is shown, and of the script [s].
        """
        peaks, axis, theme = self._peaks(), self._axis, self._gui.theme
        if peaks is None:
            return
        lines, (left, top) = imgui.get_window_draw_list(), corner
        bottom = top + self.height - 1.0
        first, last = round(axis.x(axis.start)), round(axis.x(axis.end))
        lines.add_rect_filled(
            (first - em(0.5), top + 1.0), (last + em(0.5), bottom), ink_of(theme.field), em(0.2)
        )
        key_marks.draw_label("Sound", (left, top + 0.5 * (self.height - em())), ink_of(theme.muted))
        low, high = peaks.between(axis.time(first), axis.time(last), max(last - first, 1))
        middle, reach = 0.5 * (top + bottom), 0.5 * (bottom - top) - em(0.2)
        inside, outside = ink_of(theme.muted), ink_of(theme.muted, 0.35)
        ends = axis.x(duration)
        uppers = (middle - LEAST - reach * high).tolist()
        lowers = (middle + LEAST - reach * low).tolist()
        for x, (upper, lower) in enumerate(zip(uppers, lowers, strict=True), start=first):
            lines.add_rect_filled((x, upper), (x + 1.0, lower), inside if x < ends else outside)
        key_marks.draw_playhead(theme, axis, time, (top, bottom + 1.0))

    def _peaks(self) -> Peaks | None:
        sound = self._soundtrack.sound
        if self._known[0] is not sound:
            self._known = sound, Peaks(sound) if sound is not None else None
        return self._known[1]
