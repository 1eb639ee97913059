"""Messages of one line in the window; errors that a user can correct become messages."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ..control_names import sentence
from ..errors import UserError
from ..text import as_text

Message = str | None  # a text to show, or None
Task = Callable[[], Message]  # an action of the user; it may raise UserError or OSError


@dataclass
class Messages:
    """Shows one line at a time over the picture; a lasting line stays until the next command.

    A line names keys as hints do (`Gui.with_keys`): by the labels of commands, in brackets.
    """

    text: str = ""
    is_error: bool = False
    stays: bool = False
    seconds_left: float = 0.0

    def show(self, text: str, *, error: bool = False, stays: bool = False) -> None:
        """Show a line in place of the last line; an error stays."""
        self.text = sentence(as_text(text))
        self.is_error = error
        self.stays = error or stays
        self.seconds_left = 6.0  # until the line disappears

    def attempt(self, task: Task, *, stays: bool = False) -> None:
        """Run a task, and show the message that it returns or the error that it raises."""
        try:
            line = task()
        except (UserError, OSError) as error:
            self.show(str(error), error=True)
            return
        if line:
            self.show(line, stays=stays)

    def carry_out(self, command: Task) -> None:
        """Remove the last message, then run a command of the user like `attempt`."""
        self.text = ""
        self.attempt(command)

    def age(self, seconds: float) -> None:
        """Count the seconds since the last frame; a line that is not lasting disappears."""
        if not self.stays:
            # A longer frame [s] counts as this time, because it did not display the line.
            longest_frame = 0.25
            self.seconds_left -= min(seconds, longest_frame)
        if self.seconds_left <= 0.0:
            self.text = ""

    @property
    def is_fading(self) -> bool:
        """Whether the line will disappear after some time."""
        return bool(self.text) and not self.stays
