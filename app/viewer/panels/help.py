"""The overview of all keys, made of the commands that there are, and of what the mouse does."""

from __future__ import annotations

from collections.abc import Sequence

from imgui_bundle import imgui

from ...controls.vocabulary import readable
from ..context import ApplicationContext
from ..interface.commands import Command
from ..interface.gui import colour, em
from ..interface.widgets import muted

MOUSE = (
    ("left on the skin", "pose; Ctrl: pull; click: muscle"),
    ("left beside, or right", "orbit"),
    ("middle, or Shift", "pan"),
    ("wheel", "zoom"),
    ("double click a slider", "type a number"),
    ("right click a slider", "back to 0"),
    ("drag a key", "move what is selected; Ctrl: anywhere"),
    ("drag over nothing", "select keys in a box"),
    ("right click a key", "what can be done with it"),
    ("drop files", "open them"),
)
NO_KEY = "\u2013"
WIDE = 63.0  # [em] that four columns take


class Help:
    """Draws the list."""

    def __init__(self, app: ApplicationContext) -> None:
        self._gui, self._state = app.gui, app.panel_state

    def draw(self, commands: Sequence[Command], mouse: Sequence[tuple[str, str]]) -> None:
        """Draw the list while it is open, scrolled where the window is small."""
        gui, display = self._gui, imgui.get_io().display_size
        if not self._state.is_help_open:
            return
        imgui.set_next_window_pos((0.5 * display.x, 0.5 * display.y), 0, (0.5, 0.5))
        imgui.set_next_window_size_constraints((0.0, 0.0), display)
        flags = imgui.WindowFlags_.always_auto_resize | imgui.WindowFlags_.no_collapse
        flags |= imgui.WindowFlags_.horizontal_scrollbar
        _, stays = imgui.begin("Keys and mouse", True, flags)
        is_left = imgui.is_key_pressed(imgui.Key.escape) and not gui.has_popup
        self._state.is_help_open = bool(stays) and not is_left
        rows: dict[str, list[tuple[str, str]]] = {}
        for each in commands:
            if each.submenu is None:
                rows.setdefault(each.menu, []).append((each.displayed_keys or NO_KEY, each.label))
        rows["Mouse"] = list(mouse)
        height = sum(len(each) + 1 for each in rows.values()) / (4 if display.x > em(WIDE) else 3)
        drawn, ends = 0, height
        imgui.begin_group()
        for title, lines in rows.items():
            if drawn + 0.5 * len(lines) > ends:  # most of it would stand below the others
                ends += height
                imgui.end_group()
                imgui.same_line(0.0, em(1.5))
                imgui.begin_group()
            self._draw_lines(title, lines)
            drawn += len(lines) + 1
        imgui.end_group()
        place, size = imgui.get_window_pos(), imgui.get_window_size()
        gui.places["help"] = (place.x, place.y, place.x + size.x, place.y + size.y)
        imgui.end()

    def _draw_lines(self, name: str, lines: Sequence[tuple[str, str]]) -> None:
        """What to press in one column, what it does in another."""
        flags = imgui.TableFlags_.sizing_fixed_fit | imgui.TableFlags_.no_host_extend_x
        if lines:
            muted(self._gui, name)
        if not lines or not imgui.begin_table(name, 2, flags):
            return
        for keys, meaning in lines:
            imgui.table_next_column()
            imgui.push_style_color(imgui.Col_.text, colour(self._gui.theme.accent))
            imgui.text(readable(keys))
            imgui.pop_style_color()
            imgui.table_next_column()
            imgui.text(readable(meaning))
        imgui.end_table()
