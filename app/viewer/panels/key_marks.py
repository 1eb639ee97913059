"""How ruler, rows and keys of the timeline look; what they do is in dope_sheet.py."""

from __future__ import annotations

from collections.abc import Collection

from imgui_bundle import imgui

from ..gui import Theme, colour, em
from ..keyframes import KeyPlace
from ..time_axis import TimeAxis
from ..tracks import Track
from .widgets import shortened

LABEL_ROOM = 4.2  # [em] between two labels of the ruler
FLAG = 0.7  # [em] of the handle at the script's end
KEY = 0.36  # [em] from a key's middle to its corners
LEAST_NAME = 2.4  # [em] of a pose's name: less would be no name
CLOSEST = 2.0  # [window units] keys nearer than that are drawn as one

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
    minutes, seconds = divmod(round(time, 3), 60.0)
    return f"{minutes:.0f}:{seconds:02.0f}"


def draw_playhead(theme: Theme, axis: TimeAxis, time: float, edges: tuple[float, float]) -> None:
    """The line at the time shown [s], from one edge to the other [window units]."""
    if axis.start <= time <= axis.end:
        x = round(axis.x(time)) + 0.5
        width = max(em(0.09), 1.0)
        lines = imgui.get_window_draw_list()
        lines.add_line((x, edges[0]), (x, edges[1]), _ink(theme.accent), width)


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

    def __init__(
        self, theme: Theme, axis: TimeAxis, selected: Collection[KeyPlace], duration: float
    ) -> None:
        """duration: of the script [s]."""
        self._theme, self._axis, self._selected = theme, axis, selected
        self._lines = imgui.get_window_draw_list()
        self._low, self._high = axis.x(axis.start) - em(0.5), axis.x(axis.end) + em(0.5)
        self._script_end = min(max(axis.x(duration), self._low), self._high)

    def draw(self, track: Track, top: float, unit: float) -> None:
        """A row of `unit` times its height: its ground, where nothing moves, keys, names."""
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
        self._draw_keys(track, middle)
        self._draw_names(track, top)

    def _draw_keys(self, track: Track, middle: float) -> None:
        """The visible keys, selected ones last and on top."""
        axis, lines = self._axis, self._lines
        size = em(KEY if track.is_whole else 0.8 * KEY)
        ink = _text_ink() if track.is_whole else _ink(self._theme.muted)
        margin = axis.seconds(size)
        plain: dict[int, float] = {}  # where they are, by what is drawn as one
        chosen: dict[int, float] = {}
        for key in track.between(axis.start - margin, axis.end + margin):
            x = axis.x(key.time)
            (chosen if self._selected and key in self._selected else plain)[int(x / CLOSEST)] = x
        for marks, fill, reach in (
            (plain, ink, size),
            (chosen, _ink(self._theme.accent), 1.2 * size),
        ):
            for x in marks.values():
                left, right = (x - reach, middle), (x + reach, middle)
                lines.add_quad_filled(left, (x, middle - reach), right, (x, middle + reach), fill)

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
