"""The strip below the picture: play, record, loop, speed, and the script from start to end."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from imgui_bundle import imgui

from .. import commands
from ..gui import colour, em
from ..session import SPEEDS

if TYPE_CHECKING:
    from ..window import Viewer


class Timeline:
    """Draws the strip and carries out what is done in it."""

    def __init__(self, viewer: Viewer) -> None:
        self._viewer = viewer

    @staticmethod
    def height() -> float:
        """Of the strip [window units]."""
        return (
            2.0 * imgui.get_frame_height_with_spacing() + 2.0 * imgui.get_style().window_padding.y
        )

    def draw(self) -> None:
        """Draw everything, inside the strip's window."""
        viewer, session, gui = self._viewer, self._viewer.session, self._viewer.gui
        self._button("Pause" if session.is_playing else "Play", "play", session.toggle_playing)
        label = "Stop" if session.is_recording else "Record"
        self._button(
            label, "record", lambda: commands.toggle_recording(viewer), is_on=session.is_recording
        )
        self._button(
            "Loop", "loop", lambda: commands.toggle_looping(viewer), is_on=session.is_looping
        )
        imgui.set_next_item_width(em(5.0))
        if imgui.begin_combo("##speed", f"{session.speed:g} x"):
            for speed in SPEEDS:
                if imgui.selectable(f"{speed:g} x", speed == session.speed)[0]:
                    session.speed = speed
                gui.remember(f"speed {speed:g}")
            imgui.end_combo()
        gui.remember("speed")
        imgui.same_line()
        star = " *" if session.script_is_unsaved else ""
        imgui.text_colored(colour(gui.theme.muted), f"{session.script.title}{star}")
        if session.is_recording:
            imgui.same_line()
            imgui.text_colored(
                colour(gui.theme.error), f"recording {session.recorded_seconds:.1f} s"
            )
        if viewer.film is not None:
            imgui.same_line()
            imgui.text_colored(colour(gui.theme.error), f"filming {viewer.film.seconds:.1f} s")
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

    def _draw_keys(self) -> None:
        """A tick for each time at which the script has a key."""
        script = self._viewer.session.script
        times = {key.time for channel in script.poses.values() for key in channel.keys}
        low, high = imgui.get_item_rect_min(), imgui.get_item_rect_max()
        inset = 0.5 * imgui.get_style().grab_min_size + 2.0
        ink = imgui.get_color_u32(colour(self._viewer.gui.theme.muted))
        lines = imgui.get_window_draw_list()
        for time in times:
            x = low.x + inset + (high.x - low.x - 2.0 * inset) * time / script.duration
            lines.add_line(imgui.ImVec2(x, high.y - 4.0), imgui.ImVec2(x, high.y), ink)

    def _button(
        self, label: str, name: str, run: Callable[[], None], *, is_on: bool = False
    ) -> None:
        if is_on:
            imgui.push_style_color(imgui.Col_.button, colour(self._viewer.gui.theme.accent, 0.6))
        is_clicked = imgui.button(label, imgui.ImVec2(em(4.2), 0.0))
        if is_on:
            imgui.pop_style_color()
        self._viewer.gui.remember(name)
        imgui.same_line()
        if is_clicked:
            self._viewer.attempt(run)
