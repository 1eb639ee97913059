"""Three steps that show what this is about, beside the face, until they are done or skipped."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from imgui_bundle import imgui

from ..gui import NOTE_FLAGS, TICK, Gui, em, ink_of
from ..view import View
from .widgets import muted

STEPS = (
    ("Pull the cheek", "with the left mouse button"),
    ("Press [Compare: wipe] and drag the line", "right of it, the mesh is refined"),
    ("Press [Play]", "and the face plays its script"),
)
WIDTH, MARGIN, RADIUS = 15.0, 0.8, 0.62  # [em]
FACE = 0.27  # half of its width, of the picture's height
FAREWELL = 4.0  # [s] that it stays when all is done


class FirstSteps:
    """Draws the steps, and ticks off what the user does."""

    def __init__(self, gui: Gui, view: View, doing: Callable[[], Iterable[bool]]) -> None:
        """doing: whether the user does now what each of the steps asks for."""
        self._gui, self._view, self._doing = gui, view, doing
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
        below = float(0.5 * width - FACE * height < em(WIDTH + 2.0 * MARGIN))
        x, y = (start + below * size for start, size in ((left, width), (top, height)))
        margin = em(MARGIN) * (1.0 - 2.0 * below)
        imgui.set_next_window_pos((x + margin, y + margin), 0, (below, below))
        imgui.set_next_window_size((em(WIDTH), 0.0))
        imgui.set_next_window_bg_alpha(0.88)
        imgui.push_style_var(imgui.StyleVar_.window_rounding, em(0.5))
        imgui.push_style_var(imgui.StyleVar_.window_padding, (em(0.8), em(0.7)))
        imgui.begin("##steps", None, NOTE_FLAGS)
        muted(self._gui, "First steps")
        imgui.same_line(em(WIDTH - 3.0))
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
