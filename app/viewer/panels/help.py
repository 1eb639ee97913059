"""How to begin, in three steps beside the face; and the overview of keys and mouse."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from imgui_bundle import imgui

from ...controls.vocabulary import readable
from ..context import ApplicationContext
from ..interface.commands import Command
from ..interface.gui import NOTE_FLAGS, TICK, colour, em, ink_of
from ..interface.widgets import muted

STEPS = (
    ("Pull the cheek", "with the left mouse button"),
    ("Press [Compare: wipe] and drag the line", "right of it, the mesh is refined"),
    ("Press [Play]", "and the face plays its script"),
)
STEPS_WIDTH, MARGIN, RADIUS = 15.0, 0.8, 0.62  # [em]
FACE = 0.27  # half of its width, of the picture's height
FAREWELL = 4.0  # [s] that it stays when all is done


class FirstSteps:
    """Draws the steps, and ticks off what the user does."""

    def __init__(self, app: ApplicationContext, doing: Callable[[], Iterable[bool]]) -> None:
        """doing: whether the user does now what each of the steps asks for."""
        self._gui, self._view, self._doing = app.gui, app.view, doing
        self.done: list[bool] = []  # of each step; empty: nothing is shown
        self._seconds_left = FAREWELL

    def begin(self) -> None:
        """Show them, none of them done."""
        self.done, self._seconds_left = [False] * len(STEPS), FAREWELL

    def draw(self) -> None:
        """Draw them beside the face, away from the colour bar; where there is no room, below it."""
        if not self.done:
            return
        left, top, width, height = self._view.area
        self.done = [was or now for was, now in zip(self.done, self._doing(), strict=True)]
        below = float(0.5 * width - FACE * height < em(STEPS_WIDTH + 2.0 * MARGIN))
        x, y = (start + below * size for start, size in ((left, width), (top, height)))
        margin = em(MARGIN) * (1.0 - 2.0 * below)
        imgui.set_next_window_pos((x + margin, y + margin), 0, (below, below))
        imgui.set_next_window_size((em(STEPS_WIDTH), 0.0))
        imgui.set_next_window_bg_alpha(0.88)
        imgui.push_style_var(imgui.StyleVar_.window_rounding, em(0.5))
        imgui.push_style_var(imgui.StyleVar_.window_padding, (em(0.8), em(0.7)))
        imgui.begin("##steps", None, NOTE_FLAGS)
        muted(self._gui, "First steps")
        imgui.same_line(em(STEPS_WIDTH - 3.0))
        is_skipped = imgui.small_button("Close" if all(self.done) else "Skip")
        self._gui.remember("first steps: Skip")
        for number, (what, how) in enumerate(STEPS):
            imgui.dummy((0.0, em(0.15)))
            self._draw_mark(number)
            imgui.begin_group()
            imgui.text_unformatted(self._gui.with_keys(what))
            muted(self._gui, how)
            imgui.end_group()
        if all(self.done):
            imgui.dummy((0.0, em(0.15)))
            muted(self._gui, self._gui.with_keys("[Keys and mouse] shows every key."))
            self._seconds_left -= imgui.get_io().delta_time
        imgui.end()
        imgui.pop_style_var(2)
        if is_skipped or self._seconds_left <= 0.0:
            self.done = []

    def _draw_mark(self, number: int) -> None:
        """A ring with the step's number; once that is done, a disc with a tick."""
        theme, ink, radius = self._gui.theme, imgui.get_window_draw_list(), em(RADIUS)
        corner = imgui.get_cursor_screen_pos()
        x, y = corner.x + radius, corner.y + em(1.05)
        word, shade = f"{number + 1}", theme.accent
        if self.done[number]:
            word, shade = TICK, theme.panel
            ink.add_circle_filled((x, y), radius, ink_of(theme.accent))
        else:
            ink.add_circle((x, y), radius, ink_of(theme.accent), 0, em(0.09))
        size = imgui.calc_text_size(word)
        ink.add_text((x - 0.5 * size.x, y - 0.5 * size.y), ink_of(shade), word)
        imgui.dummy((2.0 * radius + em(0.3), 0.0))
        imgui.same_line()


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
WIDE = 63.0  # [em] that the wide ones take


class Help:
    """Draws the list of all keys, and of what the mouse does."""

    def __init__(self, app: ApplicationContext) -> None:
        self._gui, self._state = app.gui, app.panel_state

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
        is_left = imgui.is_key_pressed(imgui.Key.escape) and not gui.has_popup
        self._state.is_help_open = bool(stays) and not is_left
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
            imgui.text(readable(keys) or NO_KEY)
            imgui.pop_style_color()
            imgui.table_next_column()
            imgui.text(readable(meaning))
        imgui.end_table()
