"""The timeline below the picture: play, record, loop, speed, key; below them the keys in time."""

from __future__ import annotations

from imgui_bundle import imgui

from ..export import Exporter
from ..gui import Gui, colour, em
from ..key_selection import KeySelection
from ..messages import Messages, Task
from ..script_commands import ScriptCommands
from ..session import SPEEDS, Session
from .dope_sheet import DopeSheet
from .widgets import button, hint, shortened, stay_in_line

BUTTON_WIDTH, SPEED_WIDTH = 4.0, 4.6  # [em]
MOST_HEIGHT = 0.4  # of the window


class Timeline:
    """Draws buttons and dope sheet, and carries out what is done with the buttons."""

    def __init__(
        self,
        gui: Gui,
        session: Session,
        messages: Messages,
        *,
        scripts: ScriptCommands,
        selection: KeySelection,
        exporter: Exporter,
        sheet: DopeSheet,
    ) -> None:
        self._gui, self._session, self._messages = gui, session, messages
        self._scripts, self._selection, self._exporter = scripts, selection, exporter
        self.sheet = sheet
        self._rows = 1  # of buttons, which go on in a second one where the window is narrow

    def height(self) -> float:
        """Of the timeline [window units]; where words are too large for the window, it scrolls."""
        most = MOST_HEIGHT * imgui.get_io().display_size.y
        buttons = self._rows * imgui.get_frame_height_with_spacing()
        buttons += 2.0 * imgui.get_style().window_padding.y
        return float(min(buttons + self.sheet.height(most - buttons), most))

    def draw(self) -> None:
        """Draw everything, inside its window."""
        session = self._session
        top = imgui.get_cursor_pos_y()
        label = "Pause" if session.is_playing else "Play"
        self._button("play", label, session.toggle_playing, "play the script, or pause it (Space)")
        stay_in_line(em(BUTTON_WIDTH))
        self._button(
            "record",
            "Stop" if session.is_recording else "Record",
            self._scripts.toggle_recording,
            "take every movement of every control, until it is stopped (Ctrl+R)",
            is_on=session.is_recording,
        )
        stay_in_line(em(BUTTON_WIDTH))
        loops, meaning = session.is_looping, "begin again at the end (L)"
        self._button("loop", "Loop", session.toggle_looping, meaning, is_on=loops)
        self._draw_speed()
        stay_in_line(em(BUTTON_WIDTH))
        meaning = "the face as it is becomes a key at the time shown (K)"
        self._button("set key", "Set key", self._selection.set_key, meaning)
        self._draw_words()
        self._rows = round((imgui.get_cursor_pos_y() - top) / imgui.get_frame_height_with_spacing())
        self.sheet.draw()

    def _draw_speed(self) -> None:
        stay_in_line(em(SPEED_WIDTH))
        imgui.set_next_item_width(em(SPEED_WIDTH))
        if imgui.begin_combo("##speed", f"{self._session.speed:g} x"):
            for speed in SPEEDS:
                if imgui.selectable(f"{speed:g} x", speed == self._session.speed)[0]:
                    self._session.speed = speed
                self._gui.remember(f"speed {speed:g}")
            imgui.end_combo()
        self._gui.remember("speed")
        hint("of playing")

    def _draw_words(self) -> None:
        """The time, and what is being made now, else the script's name."""
        session, theme, film = self._session, self._gui.theme, self._exporter.film
        words, ink = session.name, theme.muted
        if session.script_is_unsaved:
            words += " *"
        if session.is_recording:
            words, ink = f"recording {session.recorded_seconds:.1f} s", theme.error
        if film is not None:
            words, ink = f"filming {film.seconds:.1f} s", theme.error
        imgui.same_line()
        time = f"{session.time:.2f} s of {session.script.duration:.2f}"
        imgui.text(shortened(time, imgui.get_content_region_avail().x))
        hint("the time shown, and the script's length; drag its end in the ruler")
        imgui.same_line(0.0, em(1.2))
        imgui.text_colored(colour(ink), shortened(words, imgui.get_content_region_avail().x))
        where = session.file.path or "not kept in a file yet"
        hint(f"{session.script.title or session.name}: {where}")

    def _button(
        self, name: str, label: str, run: Task, meaning: str, *, is_on: bool = False
    ) -> None:
        highlight = colour(self._gui.theme.accent, 0.6) if is_on else None
        width = em(BUTTON_WIDTH)
        if button(self._gui, label, name=name, width=width, meaning=meaning, highlight=highlight):
            self._messages.attempt(run)
