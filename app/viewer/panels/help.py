"""The overview of keys and mouse."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from imgui_bundle import imgui

from ..command import Command
from ..gui import Gui, colour, em
from .widgets import muted

MOUSE = (
    ("left on the skin", "pose; Ctrl: pull; click: muscle"),
    ("left beside, or right", "orbit"),
    ("middle, or Shift", "pan"),
    ("wheel", "zoom"),
    ("double click a slider", "type a number"),
    ("right click a slider", "back to 0"),
    ("drag a panel's edge", "make it wider"),
    ("drop files", "open them"),
)
MARKING = (
    ("click the skin", "place the point asked for"),
    ("drag a point", "move it on the skin"),
    ("drag, or right", "turn the head"),
    *MOUSE[2:4],
)
TIMELINE = (
    ("click a key", "select it, go there"),
    ("Shift click", "select more, or fewer"),
    ("drag a key", "move what is selected"),
    ("Ctrl while dragging", "between frames"),
    ("Escape", "leave it where it was"),
    ("drag over nothing", "select in a box"),
    ("double click a pose", "name it"),
    ("right click", "all of this"),
    ("wheel, Shift wheel", "zoom, scroll"),
    ("drag the end", "longer, shorter"),
)
# Menus by column, and what the mouse does.
COLUMNS = (
    ("File", "Edit", "Time"),
    ("Keys", "Expression", "Live", "Help"),
    ("View", "Landmarks"),
    ("Mouse", "Timeline"),
)
NARROW_COLUMNS = (
    ("File", "Edit", "Time", "Live", "Help"),
    ("Keys", "View", "Landmarks"),
    ("Mouse", "Timeline", "Expression"),
)
WIDE = 63.0  # [em] that the wide ones take


def draw_help(gui: Gui, commands: Sequence[Command], *, is_marking: bool = False) -> bool:
    """Draw the list, scrolled where the window is small; whether it stays open.

    is_marking: the commands are those for marking landmarks.
    """
    display = imgui.get_io().display_size
    imgui.set_next_window_pos((0.5 * display.x, 0.5 * display.y), 0, (0.5, 0.5))
    imgui.set_next_window_size_constraints((0.0, 0.0), display)
    flags = imgui.WindowFlags_.always_auto_resize | imgui.WindowFlags_.no_collapse
    flags |= imgui.WindowFlags_.horizontal_scrollbar
    _, stays = imgui.begin("Keys and mouse (F1)", True, flags)
    lines: dict[str, list[tuple[str, str]]]
    lines = {"Mouse": [*MARKING]} if is_marking else {"Mouse": [*MOUSE], "Timeline": [*TIMELINE]}
    for command in commands:
        if command.key:
            keys = ", ".join(filter(None, (command.displayed_key, command.other_key)))
            lines.setdefault(command.menu, []).append((keys, command.label))
    for index, titles in enumerate(COLUMNS if display.x > em(WIDE) else NARROW_COLUMNS):
        if index:
            imgui.same_line(0.0, em(1.5))
        imgui.begin_group()
        for title in filter(lines.get, titles):
            muted(gui, title)
            _draw_lines(gui, title, lines[title])
        imgui.end_group()
    place, size = imgui.get_window_pos(), imgui.get_window_size()
    gui.places["help"] = (place.x, place.y, place.x + size.x, place.y + size.y)
    imgui.end()
    return bool(stays) and not imgui.is_key_pressed(imgui.Key.escape)


def _draw_lines(gui: Gui, name: str, lines: Iterable[tuple[str, str]]) -> None:
    """What to press in one column, what it does in another."""
    flags = imgui.TableFlags_.sizing_fixed_fit | imgui.TableFlags_.no_host_extend_x
    if imgui.begin_table(name, 2, flags):
        for keys, meaning in lines:
            imgui.table_next_column()
            imgui.text_colored(colour(gui.theme.accent), keys)
            imgui.table_next_column()
            imgui.text(meaning)
        imgui.end_table()
