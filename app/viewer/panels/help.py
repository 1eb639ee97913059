"""The overview of keys and mouse."""

from __future__ import annotations

from collections.abc import Sequence

from imgui_bundle import imgui

from ...controls.vocabulary import readable
from ..command import Command, pressed_key, set_keys
from ..gui import Gui, colour, em
from ..panel_state import PanelState
from .widgets import button, muted

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
    ("Ctrl wheel on curves", "zoom their values"),
    ("drag the end", "longer, shorter"),
)
# Menus by column, and what the mouse does.
COLUMNS = (
    ("File", "Edit", "Time"),
    ("Keys", "Expression"),
    ("View", "Landmarks"),
    ("Mouse", "Timeline", "Live", "Help"),
)
NARROW_COLUMNS = (
    ("File", "Edit", "Time", "Live", "Help"),
    ("Keys", "View", "Landmarks"),
    ("Mouse", "Timeline", "Expression"),
)
NO_KEY = "\u2013"
ASK = "Click a key to change it."
WIDE = 63.0  # [em] that the wide ones take


class Help:
    """Draws the list, in which each key can be changed."""

    def __init__(self, gui: Gui, state: PanelState, changed: dict[str, str]) -> None:
        """changed: the keys of commands that have not their usual ones, by the commands' labels."""
        self._gui, self._state, self._changed = gui, state, changed
        self._asked: Command | None = None  # for which a key is to be pressed
        self._line = ASK

    def draw(self, commands: Sequence[Command]) -> None:
        """Draw the list while it is open, scrolled where the window is small."""
        gui, display = self._gui, imgui.get_io().display_size
        if not self._state.is_help_open:
            return
        imgui.set_next_window_pos((0.5 * display.x, 0.5 * display.y), 0, (0.5, 0.5))
        imgui.set_next_window_size_constraints((0.0, 0.0), display)
        flags = imgui.WindowFlags_.always_auto_resize | imgui.WindowFlags_.no_collapse
        flags |= imgui.WindowFlags_.horizontal_scrollbar
        _, stays = imgui.begin("Keys and mouse", True, flags)
        is_left = imgui.is_key_pressed(imgui.Key.escape) and not (gui.has_popup or self._asked)
        self._state.is_help_open = bool(stays) and not is_left
        self._take_key(commands)
        is_marking = any(command.menu == "Landmarks" for command in commands)
        others = {"Mouse": MARKING} if is_marking else {"Mouse": MOUSE, "Timeline": TIMELINE}
        for index, titles in enumerate(COLUMNS if display.x > em(WIDE) else NARROW_COLUMNS):
            if index:
                imgui.same_line(0.0, em(1.5))
            imgui.begin_group()
            for title in titles:
                keys = [each for each in commands if each.menu == title and not each.submenu]
                self._draw_lines(title, keys or others.get(title, ()))
            imgui.end_group()
        place, size = imgui.get_window_pos(), imgui.get_window_size()
        gui.places["help"] = (place.x, place.y, place.x + size.x, place.y + size.y)
        imgui.end()

    def _take_key(self, commands: Sequence[Command]) -> None:
        """Give the command that asks for one the key that is pressed, unless another has it."""
        asked, key = self._asked, pressed_key()
        taken = [each.label for each in commands if each is not asked and key in each.keys]
        imgui.text(self._line)
        if asked is not None:
            self._gui.has_popup = True  # no key is for commands now
            if taken:
                self._line = f"{key} is taken: {taken[0]}. Press another, or Escape."
            elif key:
                self._changed[asked.label] = key
            if imgui.is_key_pressed(imgui.Key.escape) or (key and not taken):
                self._asked, self._line = None, ASK
        elif self._changed:
            imgui.same_line()
            if button(self._gui, "Usual keys"):
                self._changed.clear()
        self._gui.keys |= set_keys(commands, self._changed)

    def _draw_lines(self, name: str, lines: Sequence[Command | tuple[str, str]]) -> None:
        """What to press in one column, what it does in another."""
        flags = imgui.TableFlags_.sizing_fixed_fit | imgui.TableFlags_.no_host_extend_x
        if lines:
            muted(self._gui, name)
        if not lines or not imgui.begin_table(name, 2, flags):
            return
        for line in lines:
            imgui.table_next_column()
            keys, meaning = line if isinstance(line, tuple) else (line.displayed_keys, line.label)
            imgui.push_style_color(imgui.Col_.text, colour(self._gui.theme.accent))
            if isinstance(line, tuple):
                imgui.text(readable(keys))
            elif imgui.selectable(f"{keys or NO_KEY}##{meaning}", self._asked is line)[0]:
                self._asked, self._line = line, f"{meaning}: press a key for it, or Escape."
            self._gui.remember(f"key {meaning}")
            imgui.pop_style_color()
            imgui.table_next_column()
            imgui.text(readable(meaning))
        imgui.end_table()
