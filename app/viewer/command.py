"""A command, which menus and keys carry out, and the answer to the keys that were pressed."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from imgui_bundle import imgui

from .messages import Messages, Task

_MODIFIERS = {"Ctrl": imgui.Key.mod_ctrl, "Shift": imgui.Key.mod_shift, "Alt": imgui.Key.mod_alt}
_KEY_NAMES = {"Left": "left_arrow", "Right": "right_arrow"}
# Ctrl keys that a line of text takes for itself while one writes.
_WRITING = ("Ctrl+A", "Ctrl+C", "Ctrl+V", "Ctrl+Z", "Ctrl+Shift+Z")


@dataclass(frozen=True)
class Command:
    """One thing to do: where it stands, its key, what it does, and whether it is switched on."""

    menu: str
    label: str
    key: str  # "" for none
    run: Task
    is_on: Callable[[], bool] | None = None
    can_run: Callable[[], bool] = lambda: True
    other_key: str = ""
    reads: Callable[[], str] | None = None  # its label now, where that changes
    by_key: Task | None = None  # what its key does, where that is not the same
    # The rows of a menu of its own, in place of `run`: what each reads, is it on, what it does.
    choices: Callable[[], Sequence[tuple[str, bool, Task]]] | None = None

    @property
    def displayed_key(self) -> str:
        """The key as people know it."""
        return self.key.replace("Equal", "=").replace("Minus", "-").replace("Keypad", "Num ")

    @property
    def keys(self) -> tuple[str, ...]:
        """All keys that do it."""
        return tuple(key for key in (self.key, self.other_key) if key)


def run_pressed(commands: Iterable[Command], messages: Messages) -> None:
    """Carry out the commands whose keys were pressed in this frame."""
    is_writing = imgui.get_io().want_text_input
    for command in commands:
        for key in command.keys:
            is_for_text = is_writing and ("Ctrl" not in key or key in _WRITING)
            if not is_for_text and imgui.is_key_chord_pressed(_chord(key)) and command.can_run():
                messages.attempt(command.by_key or command.run)


def _chord(key: str) -> int:
    """A key as imgui counts it."""
    *modifiers, last = key.split("+")
    name = _KEY_NAMES.get(last, last.lower())
    code: Any = getattr(imgui.Key, f"_{name}" if name.isdigit() else name)
    return sum((int(_MODIFIERS[modifier]) for modifier in modifiers), start=int(code))
