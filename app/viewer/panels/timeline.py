"""The strip below the picture: play, record, loop, speed, and the script from start to end."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from imgui_bundle import imgui

from ...script import Script
from .. import commands
from ..gui import colour, em
from ..session import SPEEDS, key_times
from .words import hint, shortened, stay_in_line

if TYPE_CHECKING:
    from ..window import Viewer

BUTTON_WIDTH, SPEED_WIDTH = 4.0, 4.6  # [em]
HINTS = {
    "play": "play the script, or pause it (Space)",
    "record": "take every movement of every control, until it is stopped (Ctrl+R)",
    "loop": "begin again at the end (L)",
}


class Timeline:
    """Draws the strip and carries out what is done in it."""

    def __init__(self, viewer: Viewer) -> None:
        self._viewer = viewer
        self._ticked: tuple[Script | None, list[float]] = None, []
        self._rows = 1  # of buttons, which go on in a second one where the window is narrow

    def height(self) -> float:
        """Of the strip [window units]."""
        rows = self._rows + 1
        padding = imgui.get_style().window_padding.y
        return float(rows * imgui.get_frame_height_with_spacing() + 2.0 * padding)

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
        self._draw_words()
        self._rows = round((imgui.get_cursor_pos_y() - top) / imgui.get_frame_height_with_spacing())
        imgui.set_next_item_width(-1.0)
        duration = session.script.duration
        is_changed, time = imgui.slider_float(
            "##time", session.time, 0.0, duration, f"%.2f s of {duration:.2f}"
        )
        gui.remember("time")
        self._draw_keys()
        if is_changed:
            session.seek(time)
        if imgui.is_item_deactivated_after_edit():
            session.note()

    def _draw_words(self) -> None:
        """What is being made now, else the script's name."""
        viewer, session, theme = self._viewer, self._viewer.session, self._viewer.gui.theme
        words, ink = session.script.title, theme.muted
        if session.script_is_unsaved:
            words += " *"
        if session.is_recording:
            words, ink = f"recording {session.recorded_seconds:.1f} s", theme.error
        if viewer.film is not None:
            words, ink = f"filming {viewer.film.seconds:.1f} s", theme.error
        imgui.same_line()
        imgui.text_colored(colour(ink), shortened(words, imgui.get_content_region_avail().x))
        hint(f"{session.script.title}: {session.script.source}")

    def _draw_keys(self) -> None:
        """A tick for each time at which the script has a key."""
        script = self._viewer.session.script
        if script is not self._ticked[0]:
            self._ticked = script, key_times(script)
        low, high = imgui.get_item_rect_min(), imgui.get_item_rect_max()
        inset = 0.5 * imgui.get_style().grab_min_size + 2.0
        ink = imgui.get_color_u32(colour(self._viewer.gui.theme.muted))
        lines = imgui.get_window_draw_list()
        for time in self._ticked[1]:
            x = low.x + inset + (high.x - low.x - 2.0 * inset) * time / script.duration
            lines.add_line(imgui.ImVec2(x, high.y - em(0.27)), imgui.ImVec2(x, high.y), ink)

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
