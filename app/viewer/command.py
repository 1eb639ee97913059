"""A command, which menus and keys carry out, and the answer to the keys that were pressed."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field

from imgui_bundle import imgui

from .gui import Gui
from .messages import Messages, Task

_MODIFIERS = {"Ctrl": imgui.Key.mod_ctrl, "Shift": imgui.Key.mod_shift, "Alt": imgui.Key.mod_alt}
# All others, by their names.
_KEYS = {
    imgui.get_key_name(key).removesuffix("Arrow"): key
    for key in imgui.Key
    if imgui.Key.tab <= key < imgui.Key.gamepad_start
}
_SIGNS = {"Equal": "=", "Minus": "-"}  # as people know them
# What no command may be given: they change others, or have a use everywhere.
_RESERVED = ("Escape", "Tab", "Lock", "Ctrl", "Shift", "Alt", "Super")
# Ctrl keys that a line of text takes for itself while one writes.
_WRITING = ("Ctrl+A", "Ctrl+Y", "Ctrl+Z", "Ctrl+Shift+Z")
_WALKING = ("Space", "Enter", "Left", "Right", "Home")  # used where the keyboard walks


@dataclass
class Command:
    """One thing to do: where it stands, its key, what it does, and whether it is switched on."""

    menu: str
    label: str
    key: str  # "" for none
    run: Task
    is_on: Callable[[], bool] | None = None
    can_run: Callable[[], bool] = lambda: True
    other_key: str = ""
    submenu: Callable[[], Iterable[Command]] | None = None  # in place of doing something
    usual_key: str = field(init=False)

    def __post_init__(self) -> None:
        self.usual_key = self.key

    @property
    def name(self) -> str:
        """By which settings know it."""
        return f"{self.menu}: {self.label}"

    @property
    def displayed_key(self) -> str:
        """The key as people know it."""
        *modifiers, last = self.key.split("+")
        return "+".join((*modifiers, _SIGNS.get(last, last)))

    @property
    def keys(self) -> tuple[str, ...]:
        """All keys that do it."""
        return tuple(key for key in (self.key, self.other_key) if key)


def set_keys(commands: Iterable[Command], changed: Mapping[str, str]) -> None:
    """Give the commands that are named other keys, all others their usual ones."""
    for command in commands:
        command.key = changed.get(command.name, command.usual_key)


def run_pressed(commands: Iterable[Command], messages: Messages, gui: Gui) -> None:
    """Carry out the commands whose keys were pressed in this frame."""
    if gui.has_popup:  # whose keys they are
        return
    is_writing = imgui.get_io().want_text_input
    for command in commands:
        for key in command.keys:
            is_for_text = is_writing and ("Ctrl" not in key or key in _WRITING)
            is_taken = is_for_text or (gui.owns_keys and key in _WALKING)
            if not is_taken and imgui.is_key_chord_pressed(chord(key)) and command.can_run():
                messages.attempt(command.run)


def chord(key: str) -> int:
    """A key as imgui counts it; ValueError for none."""
    *modifiers, last = key.split("+")
    try:
        return sum((int(_MODIFIERS[each]) for each in modifiers), start=int(_KEYS[last]))
    except KeyError:
        raise ValueError(f"no such key: {key}") from None


def pressed_key() -> str:
    """The key that was pressed in this frame and may be a command's, "" for none."""
    io = imgui.get_io()
    is_held = {"Ctrl": io.key_ctrl, "Shift": io.key_shift, "Alt": io.key_alt}
    modifiers = [name for name, is_down in is_held.items() if is_down]
    for name, key in _KEYS.items():
        if not name.endswith(_RESERVED) and imgui.is_key_pressed(key, repeat=False):
            return "+".join((*modifiers, name))
    return ""
