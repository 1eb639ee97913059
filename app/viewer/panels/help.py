"""The overview of keys and mouse."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from imgui_bundle import imgui

from ..command import Command, pressed_key, set_keys
from ..gui import Gui, colour, em
from ..panel_state import PanelState
from .widgets import button, hint, muted

MOUSE = (
    ("left on the skin", "pull; click: its muscle"),
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


CHANGE = "Other key"  # the title of what asks for one


class Help:
    """Draws the list, in which each key can be changed."""

    def __init__(self, gui: Gui, state: PanelState, changed: dict[str, str]) -> None:
        """changed: the keys of commands that have not their usual ones, by the commands' names."""
        self._gui, self._state, self._changed = gui, state, changed
        self._asked: Command | None = None  # for which a key is to be pressed
        self._complaint = ""

    def draw(self, commands: Sequence[Command], *, is_marking: bool = False) -> None:
        """Draw the list while it is open, scrolled where the window is small.

        is_marking: the commands are those for marking landmarks.
        """
        gui, display = self._gui, imgui.get_io().display_size
        if not self._state.is_help_open:
            return
        imgui.set_next_window_pos((0.5 * display.x, 0.5 * display.y), 0, (0.5, 0.5))
        imgui.set_next_window_size_constraints((0.0, 0.0), display)
        flags = imgui.WindowFlags_.always_auto_resize | imgui.WindowFlags_.no_collapse
        flags |= imgui.WindowFlags_.horizontal_scrollbar
        _, stays = imgui.begin("Keys and mouse", True, flags)
        asked = None
        for index, titles in enumerate(COLUMNS if display.x > em(WIDE) else NARROW_COLUMNS):
            if index:
                imgui.same_line(0.0, em(1.5))
            imgui.begin_group()
            for title in titles:
                rows = [each for each in commands if each.menu == title and each.key]
                lines = {"Mouse": MARKING if is_marking else MOUSE, "Timeline": TIMELINE}
                if rows or (title in lines and not (is_marking and title == "Timeline")):
                    muted(gui, title)
                    asked = self._draw_lines(title, rows or lines[title]) or asked
            imgui.end_group()
        self._draw_foot(commands)
        if asked is not None:
            self._asked, self._complaint = asked, ""
            imgui.open_popup(CHANGE)
        if imgui.begin_popup(CHANGE):
            self._ask(commands)
            imgui.end_popup()
        place, size = imgui.get_window_pos(), imgui.get_window_size()
        gui.places["help"] = (place.x, place.y, place.x + size.x, place.y + size.y)
        imgui.end()
        is_left = imgui.is_key_pressed(imgui.Key.escape) and not gui.has_popup
        self._state.is_help_open = bool(stays) and not is_left

    def _draw_lines(
        self, title: str, lines: Iterable[Command | tuple[str, str]]
    ) -> Command | None:
        """What to press in one column, what it does in another; of which command a key is asked."""
        asked = None
        flags = imgui.TableFlags_.sizing_fixed_fit | imgui.TableFlags_.no_host_extend_x
        if imgui.begin_table(title, 2, flags):
            imgui.push_style_color(imgui.Col_.text, colour(self._gui.theme.accent))
            for line in lines:
                imgui.table_next_column()
                if isinstance(line, Command):
                    keys = ", ".join(filter(None, (line.displayed_key, line.other_key)))
                    if imgui.selectable(f"{keys}##{line.name}", False)[0]:
                        asked = line
                    self._gui.remember(f"key {line.name}")
                    hint("another key ...")
                else:
                    imgui.text(line[0])
                imgui.table_next_column()
                words = line.label if isinstance(line, Command) else line[1]
                imgui.text_colored(imgui.get_style_color_vec4(imgui.Col_.text_disabled), words)
            imgui.pop_style_color()
            imgui.end_table()
        return asked

    def _draw_foot(self, commands: Sequence[Command]) -> None:
        muted(self._gui, "Click a key to change it.")
        if self._changed:
            imgui.same_line()
            if button(self._gui, "Back to the usual keys"):
                self._changed.clear()
                set_keys(commands, self._changed)

    def _ask(self, commands: Sequence[Command]) -> None:
        """Give the command that asks the keys that are pressed, unless another has them."""
        asked, key = self._asked, pressed_key()
        assert asked is not None
        imgui.text(f"{asked.label}: press the new key. Escape leaves it as it is.")
        self._gui.remember("key asked")
        if self._complaint:
            imgui.text_colored(colour(self._gui.theme.error), self._complaint)
        others = [each for each in commands if key in each.keys and each is not asked]
        if others:
            self._complaint = f"{key} is taken: {others[0].label}. Press another."
        elif key:
            self._changed[asked.name] = key
            if key == asked.usual_key:
                del self._changed[asked.name]
            set_keys(commands, self._changed)
            imgui.close_current_popup()
