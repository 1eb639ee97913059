"""Rows of a panel that set fields of the display: a label with a list or a checkbox."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from functools import partial

from imgui_bundle import imgui

from ...control_names import readable
from ..context import ApplicationContext
from ..interface.widgets import LabelledRows
from ..messages import Message
from ..settings import Display, switch

# Fields of the display, by the labels of their rows.
FIELD_OF_ROW = {
    "Refine": "is_refined",
    "Skin tone": "tone",
    "Hair": "has_hair",
    "Colour by splits": "splits",
    "Wires of splits": "wires",
}
FIELD_OF_ROW |= {each.name.capitalize().replace("_", " "): each.name for each in fields(Display)}


class DisplayRows(LabelledRows):
    """Labelled rows for the settings of the display."""

    def __init__(self, app: ApplicationContext, hints: Mapping[str, str]) -> None:
        super().__init__(app.gui, share=0.45, hints=hints)
        self._settings = app.settings
        self._messages = app.messages

    def switch(self, label: str) -> None:
        """Draw a checkbox for a field of the display."""
        display = self._settings.display
        name = FIELD_OF_ROW[label]
        self.check(label, getattr(display, name), partial(switch, display, name))

    def check(self, label: str, is_on: bool, switch: Callable[[], None]) -> None:
        """Draw a checkbox that calls `switch`."""
        is_clicked, _ = imgui.checkbox(readable(label), is_on)
        self._gui.remember(label)
        self.end(label)
        if is_clicked:
            switch()

    def pick(self, label: str, choices: Sequence[str]) -> None:
        """Draw a row with a list for a field of the display."""
        display = self._settings.display
        name = FIELD_OF_ROW[label]
        self.choice_row(label, getattr(display, name), choices, partial(setattr, display, name))

    def choice_row(
        self, label: str, present: str, choices: Sequence[str], put: Callable[[str], Message]
    ) -> None:
        """Draw a row with a list, and call `put` with the user's choice."""
        chosen = self.choose(label, present, choices)
        if chosen is not None:
            self._messages.carry_out(partial(put, chosen))
