"""How ruler, rows and keys of the timeline look; what they do is in dope_sheet.py."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from imgui_bundle import imgui

from ..gui import colour, em
from ..keys import KeyPlace
from ..lanes import Lane
from ..time_view import TimeView
from .words import shortened

if TYPE_CHECKING:
    from ..window import Viewer

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


def draw_ruler(viewer: Viewer, view: TimeView, top: float, bottom: float) -> None:
    """Ticks with seconds, the script's end, and what is dragged to scrub."""
    lines, theme = imgui.get_window_draw_list(), viewer.gui.theme
    ink = _ink(theme.muted)
    for tick in view.ticks(em(LABEL_ROOM)):
        x = round(view.x(tick.time)) + 0.5
        height = em(0.45) if tick.has_label else em(0.22)
        lines.add_line((x, bottom - height), (x, bottom), ink)
        if tick.has_label:
            lines.add_text((x + em(0.2), top), ink, label_of(tick.time))
    end = view.x(viewer.session.script.duration)
    if end <= view.x(view.start + view.span):
        tip = end + em(FLAG), bottom - 0.5 * em(FLAG)
        lines.add_triangle_filled((end, bottom - em(FLAG)), tip, (end, bottom), ink)
    draw_playhead(viewer, view, top, bottom)
    x = view.x(viewer.session.time)
    if view.start <= viewer.session.time <= view.start + view.span:
        accent, half = _ink(theme.accent), em(0.4)
        tip = x, top + 1.3 * half
        lines.add_triangle_filled((x - half, top), (x + half, top), tip, accent)


def label_of(time: float) -> str:
    """Seconds as short as they can be told, minutes where there are some."""
    if time < 60.0:
        return f"{time:.3g} s" if time == 0.0 else f"{time:.3g}"
    minutes, seconds = divmod(round(time, 3), 60.0)
    return f"{minutes:.0f}:{seconds:02.0f}"


def draw_playhead(viewer: Viewer, view: TimeView, top: float, bottom: float) -> None:
    """The line at the time shown."""
    time = viewer.session.time
    if view.start <= time <= view.start + view.span:
        x = round(view.x(time)) + 0.5
        width = max(em(0.09), 1.0)
        lines = imgui.get_window_draw_list()
        lines.add_line((x, top), (x, bottom), _ink(viewer.gui.theme.accent), width)


def draw_label(
    viewer: Viewer,
    text: str,
    left: float,
    top: float,
    height: float,
    arrow: float,
    *,
    is_open: bool,
) -> None:
    """The name of a row, with an arrow where it folds."""
    lines, ink = imgui.get_window_draw_list(), _ink(viewer.gui.theme.muted)
    if arrow:
        x, y, size = left + 0.4 * arrow, top + 0.5 * height, 0.28 * arrow
        back, tip = 0.6 * size, size
        if is_open:
            lines.add_triangle_filled((x - tip, y - back), (x + tip, y - back), (x, y + tip), ink)
        else:
            lines.add_triangle_filled((x - back, y - tip), (x + tip, y), (x - back, y + tip), ink)
    lines.add_text((left + arrow, top + 0.5 * (height - imgui.get_font_size())), ink, text)


def draw_lane(
    viewer: Viewer,
    view: TimeView,
    lane: Lane,
    selected: frozenset[KeyPlace],
    top: float,
    unit: float,
) -> None:
    """A row of `unit` times its height: its ground, where nothing moves, keys, names of poses."""
    lines, theme, bottom = imgui.get_window_draw_list(), viewer.gui.theme, top + lane.height * unit
    middle = bottom - 0.5 * unit
    start, shown_end = view.start, view.start + view.span
    low, high = view.x(start) - em(0.5), view.x(shown_end) + em(0.5)
    end = min(max(view.x(viewer.session.script.duration), low), high)
    first, last = (low, top + 1.0), (high, bottom - 1.0)
    lines.add_rect_filled(first, last, _ink(theme.field, 0.45), em(0.2))
    lines.add_rect_filled(first, (end, last[1]), _ink(theme.field), em(0.2))
    for begin, finish in lane.held:
        if finish > start and begin < shown_end:
            ends = (max(view.x(begin), low), middle), (min(view.x(finish), high), middle)
            lines.add_line(*ends, _ink(theme.muted, 0.45), em(0.22))
    size = em(KEY if lane.is_whole else 0.8 * KEY)
    ink = _text_ink() if lane.is_whole else _ink(theme.muted)
    _draw_keys(lines, view, lane, selected, middle, size, (ink, _ink(theme.accent)))
    _draw_names(lines, view, lane, top, high, _ink(theme.muted))


def _draw_keys(
    lines: Any,
    view: TimeView,
    lane: Lane,
    selected: frozenset[KeyPlace],
    middle: float,
    size: float,
    inks: tuple[int, int],
) -> None:
    """The keys that are in sight, selected ones last and on top."""
    margin = view.seconds(size)
    shown = lane.between(view.start - margin, view.start + view.span + margin)
    plain: dict[int, float] = {}  # where they are, by what is drawn as one
    chosen: dict[int, float] = {}
    for key in shown:
        x = view.x(key.time)
        (chosen if selected and key in selected else plain)[int(x / CLOSEST)] = x
    for marks, ink, scale in ((plain, inks[0], 1.0), (chosen, inks[1], 1.2)):
        reach = scale * size
        for x in marks.values():
            left, right = (x - reach, middle), (x + reach, middle)
            lines.add_quad_filled(left, (x, middle - reach), right, (x, middle + reach), ink)


def _draw_names(lines: Any, view: TimeView, lane: Lane, top: float, right: float, ink: int) -> None:
    """The names of poses above them, as much of each as there is room for before the next."""
    ends = [view.x(time) - em(0.6) for time, _ in lane.names[1:]] + [right]
    for (time, name), end in zip(lane.names, ends, strict=False):
        if view.start <= time <= view.start + view.span:
            x = view.x(time) - em(KEY)
            room = min(end, right) - x
            if room >= min(em(LEAST_NAME), imgui.calc_text_size(name).x):
                lines.add_text((x, top), ink, shortened(name, room))


def draw_box(viewer: Viewer, first: Point, last: Point) -> None:
    """What a drag over nothing encloses."""
    lines, accent = imgui.get_window_draw_list(), viewer.gui.theme.accent
    low = (min(first[0], last[0]), min(first[1], last[1]))
    high = (max(first[0], last[0]), max(first[1], last[1]))
    lines.add_rect_filled(low, high, _ink(accent, 0.15))
    lines.add_rect(low, high, _ink(accent, 0.8))
