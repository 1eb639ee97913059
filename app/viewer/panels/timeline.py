"""The strip below the picture: play, record, loop, speed, key; below them the keys in time."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from imgui_bundle import imgui

from .. import commands, key_commands
from ..gui import colour, em
from ..session import SPEEDS
from .dope_sheet import DopeSheet
from .words import hint, shortened, stay_in_line

if TYPE_CHECKING:
    from ..window import Viewer

BUTTON_WIDTH, SPEED_WIDTH = 4.0, 4.6  # [em]
MOST_HEIGHT = 0.4  # of the window
HINTS = {
    "play": "play the script, or pause it (Space)",
    "record": "take every movement of every control, until it is stopped (Ctrl+R)",
    "loop": "begin again at the end (L)",
    "set key": "the face as it is becomes a key at the time shown (K)",
}


class Timeline:
    """Draws the strip and carries out what is done in it."""

    def __init__(self, viewer: Viewer) -> None:
        self._viewer = viewer
        self.sheet = DopeSheet(viewer)
        self._rows = 1  # of buttons, which go on in a second one where the window is narrow

    def height(self) -> float:
        """Of the strip [window units]; where words are too large for the window, it scrolls."""
        most = MOST_HEIGHT * imgui.get_io().display_size.y
        buttons = self._rows * imgui.get_frame_height_with_spacing()
        buttons += 2.0 * imgui.get_style().window_padding.y
        return float(min(buttons + self.sheet.height(most - buttons), most))

    def draw(self) -> None:
        """Draw everything, inside the strip's window."""
        viewer, session, gui = self._viewer, self._viewer.session, self._viewer.gui
        top = imgui.get_cursor_pos_y()
        self._button("Pause" if session.is_playing else "Play", "play", session.toggle_playing)
        label = "Stop" if session.is_recording else "Record"
        self._button(
            label, "record", lambda: commands.toggle_recording(viewer), is_on=session.is_recording
        )
        self._button(
            "Loop", "loop", lambda: commands.toggle_looping(viewer), is_on=session.is_looping
        )
        stay_in_line(em(SPEED_WIDTH))
        imgui.set_next_item_width(em(SPEED_WIDTH))
        if imgui.begin_combo("##speed", f"{session.speed:g} x"):
            for speed in SPEEDS:
                if imgui.selectable(f"{speed:g} x", speed == session.speed)[0]:
                    session.speed = speed
                gui.remember(f"speed {speed:g}")
            imgui.end_combo()
        gui.remember("speed")
        hint("of playing")
        self._button("Set key", "set key", lambda: key_commands.set_key(viewer))
        self._draw_words()
        self._rows = round((imgui.get_cursor_pos_y() - top) / imgui.get_frame_height_with_spacing())
        self.sheet.draw()

    def _draw_words(self) -> None:
        """The time, and what is being made now, else the script's name."""
        viewer, session, theme = self._viewer, self._viewer.session, self._viewer.gui.theme
        words, ink = session.name, theme.muted
        if session.script_is_unsaved:
            words += " *"
        if session.is_recording:
            words, ink = f"recording {session.recorded_seconds:.1f} s", theme.error
        if viewer.film is not None:
            words, ink = f"filming {viewer.film.seconds:.1f} s", theme.error
        imgui.same_line()
        time = f"{session.time:.2f} s of {session.script.duration:.2f}"
        imgui.text(shortened(time, imgui.get_content_region_avail().x))
        hint("the time shown, and the script's length; drag its end in the ruler")
        imgui.same_line(0.0, em(1.2))
        imgui.text_colored(colour(ink), shortened(words, imgui.get_content_region_avail().x))
        where = session.file.path or "not kept in a file yet"
        hint(f"{session.script.title or session.name}: {where}")

    def _button(
        self, label: str, name: str, run: Callable[[], None], *, is_on: bool = False
    ) -> None:
        if name != "play":
            stay_in_line(em(BUTTON_WIDTH))
        if is_on:
            imgui.push_style_color(imgui.Col_.button, colour(self._viewer.gui.theme.accent, 0.6))
        is_clicked = imgui.button(label, imgui.ImVec2(em(BUTTON_WIDTH), 0.0))
        if is_on:
            imgui.pop_style_color()
        self._viewer.gui.remember(name)
        hint(HINTS[name])
        if is_clicked:
            self._viewer.attempt(run)
