"""The timeline below the picture: the keys over time, and buttons below them."""

from __future__ import annotations

from collections.abc import Iterable

from imgui_bundle import imgui

from ...text import counted
from ..context import ApplicationContext
from ..interface.commands import Command, command_button
from ..interface.gui import colour, em
from ..interface.widgets import choose, hint, shortened, stay_in_line
from .dope_sheet import DopeSheet

# Label of a command -> the button's text while it is on, and a hint.
BUTTON_TEXTS = {
    "Play": ("Pause", "play the script ([Play])"),
    "Record": ("Stop", "record the controls that you move, from here on ([Record])"),
    "Loop": ("Loop", "begin again at the end ([Loop])"),
    "Curves": ("Curves", "keys in rows, or their values as curves ([Curves])"),
    "Set key": (
        "Set key",
        "key the controls moved since the last key ([Set key]), or the whole "
        "pose ([Key whole pose])",
    ),
    "Let go": ("Let go", "controls changed by hand return to the values of the script"),
    "Auto-key": ("Auto-key", "each change by hand becomes a key at once"),
}


class Timeline:
    """Draws buttons and dope sheet, and runs the commands of the buttons."""

    def __init__(
        self, app: ApplicationContext, commands: Iterable[Command], dope_sheet: DopeSheet
    ) -> None:
        """commands: the window's commands, which include the buttons' commands."""
        self._gui = app.gui
        self._session = app.session
        self._messages = app.messages
        self._commands = {command.label: command for command in commands}
        self.dope_sheet = dope_sheet
        self._rows = 1  # rows of buttons: a narrow window has a second one

    def height(self) -> float:
        """Return the height of the timeline [window units]; rows scroll if letters are large."""
        display = imgui.get_io().display_size.y
        most = 0.4 * display
        buttons = self._rows * imgui.get_frame_height_with_spacing()
        buttons += 2.0 * imgui.get_style().window_padding.y
        return float(min(buttons + self.dope_sheet.height(most - buttons), most))

    def draw(self) -> None:
        """Draw everything inside its window: buttons at the lower edge, which does not move."""
        left, top = imgui.get_cursor_pos()
        height = self._rows * imgui.get_frame_height_with_spacing()
        height = max(imgui.get_content_region_avail().y - height, self.dope_sheet.height(0.0))
        self.dope_sheet.draw(height)
        top += height + imgui.get_style().item_spacing.y
        imgui.set_cursor_pos((left, top))
        for label in ("Play", "Record", "Loop"):
            self._draw_button(label)
        self._draw_speed()
        differing = self._session.differing
        self._draw_button("Set key", is_wanted=bool(differing))
        self._draw_button("Let go")
        self._draw_button("Auto-key")
        self._draw_button("Curves")
        self._draw_status(len(differing))
        self._rows = round((imgui.get_cursor_pos_y() - top) / imgui.get_frame_height_with_spacing())

    def _draw_button(self, label: str, *, is_wanted: bool = False) -> None:
        command = self._commands[label]
        (label_on, meaning) = BUTTON_TEXTS[label]
        is_on = command.is_on is not None and command.is_on()
        text = label_on if is_on else label
        button_width = 4.0  # [em]
        width = em(button_width)
        if label != "Play":
            stay_in_line(width)
        command_button(
            self._gui, self._messages, command, text,
            name=label.lower(), width=width, meaning=meaning, is_wanted=is_wanted,
        )  # fmt: skip

    def _draw_speed(self) -> None:
        speed_width = 4.6  # [em]
        stay_in_line(em(speed_width))
        imgui.set_next_item_width(em(speed_width))
        speed_choices = (0.1, 0.25, 0.5, 1.0, 2.0)
        speeds = {f"{speed:g} x": speed for speed in speed_choices}
        chosen = choose(self._gui, "speed", f"{self._session.speed:g} x", speeds)
        if chosen is not None:
            self._session.speed = speeds[chosen]
        hint("speed of the script")

    def _draw_status(self, differing: int) -> None:
        """Draw the time, and a recording, the number of differing controls, or the script.

        If there is no room for both, a recording or a number replaces the time, and the script's
        name is left out.
        """
        session = self._session
        theme = self._gui.theme
        status = session.work.name
        ink = theme.muted
        if session.work.script_is_unsaved:
            status += " *"
        if differing:
            status = f"{counted(differing, 'control')} not keyed"
            ink = theme.accent
        if session.is_recording:
            status = f"recording {session.recorded_seconds:.1f} s"
            ink = theme.error
            status += "" if session.is_playing else ", paused"
        time = f"{session.time:.2f} of {session.script.duration:.2f} s"
        gap = em(1.2)
        widths = [imgui.calc_text_size(text).x for text in (time, status)]
        stay_in_line(widths[0])
        is_tight = imgui.get_content_region_avail().x < sum(widths) + gap
        is_news = bool(differing) or session.is_recording
        if not (is_tight and is_news):
            imgui.text(shortened(time, imgui.get_content_region_avail().x))
            hint("the time shown, and the script's length, whose end is in the ruler")
            if is_tight:  # the title also has the script's name
                return
            imgui.same_line(0.0, gap)
        imgui.text_colored(colour(ink), shortened(status, imgui.get_content_region_avail().x))
        self._gui.remember("status")
        where = session.file.path or "not kept in a file yet"
        hint(f"{session.script.title or session.work.name}: {where}")
