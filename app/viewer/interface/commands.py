"""Commands of menus and keys: the menu bar, and the response to pressed keys."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from imgui_bundle import imgui

from ..messages import Messages, Task
from .gui import Gui, colour
from .widgets import button, muted

KEY_OF_MODIFIER = {
    "Ctrl": imgui.Key.mod_ctrl,
    "Shift": imgui.Key.mod_shift,
    "Alt": imgui.Key.mod_alt,
}
KEY_OF_NAME = {imgui.get_key_name(key).removesuffix("Arrow"): key for key in imgui.Key
         if imgui.Key.tab <= key < imgui.Key.gamepad_start}  # fmt: skip


@dataclass
class Command:
    """One command: its menu, label and key, its action, and whether it is switched on."""

    menu: str  # "" for a command that only keys run
    label: str
    key: str  # one key, or several separated by ", "; "" for none
    run: Task
    is_on: Callable[[], bool] | None = None
    can_run: Callable[[], bool] = lambda: True
    submenu: Callable[[], Iterable[Command]] | None = None  # a submenu instead of an action
    begins_section: bool = False  # whether a line separates it from the item above
    words: str = ""  # further words by which the search of controls finds it

    @property
    def displayed_keys(self) -> str:
        """The keys as menus display them, for example = for Equal."""
        return self.key.replace("Equal", "=").replace("Minus", "-").replace("Keypad", "Num ")

    @property
    def keys(self) -> tuple[str, ...]:
        """All keys that run the command."""
        return tuple(filter(None, self.key.split(", ")))


def run_pressed(commands: Iterable[Command], messages: Messages, gui: Gui) -> None:
    """Carry out the commands whose keys were pressed in this frame."""
    if gui.has_popup:  # the popup gets these keys
        return
    is_writing = imgui.get_io().want_text_input or gui.is_reading
    # Ctrl keys that edit a line of text while the user types.
    text_keys = ("Ctrl+A", "Ctrl+C", "Ctrl+V", "Ctrl+Y", "Ctrl+Z", "Ctrl+Shift+Z")
    # Menus whose keys are ignored while a mouse button is pressed; "": commands without a menu.
    changing_menus = ("Edit", "Keys", "")
    for command in commands:
        for key in command.keys:
            is_for_text = is_writing and ("Ctrl" not in key or key in text_keys)
            if is_for_text or not imgui.is_key_chord_pressed(chord(key)):
                continue
            is_in_the_way = command.menu in changing_menus and imgui.is_any_mouse_down()
            if command.can_run() and not is_in_the_way:
                messages.carry_out(command.run)


def chord(key: str) -> int:
    """Return imgui's key chord: a key with its modifiers, as one number."""
    *modifiers, last = key.split("+")
    return sum((int(KEY_OF_MODIFIER[each]) for each in modifiers), start=int(KEY_OF_NAME[last]))


class MenuBar:
    """Draws menus and runs the chosen commands."""

    def __init__(
        self, gui: Gui, messages: Messages, commands: Sequence[Command], unsaved: Callable[[], str]
    ) -> None:
        """unsaved: returns the unsaved work in words, or ""."""
        self._gui = gui
        self._messages = messages
        self._commands = commands
        self._unsaved = unsaved

    def draw(self) -> float:
        """Draw the bar; returns its height [window units]."""
        if not imgui.begin_main_menu_bar():
            return 0.0
        height = float(round(imgui.get_window_size().y))
        for title in dict.fromkeys(command.menu for command in self._commands if command.menu):
            is_open = imgui.begin_menu(title)
            self._gui.remember(f"menu {title}")
            if is_open:
                self.draw_menu(title)
                imgui.end_menu()
        if unsaved := self._unsaved():
            muted(self._gui, f"   Unsaved: {unsaved}")
        imgui.end_main_menu_bar()
        return height

    def draw_menu(self, title: str) -> None:
        """Draw the commands of an open menu."""
        for command in self._commands:
            if command.menu != title:
                continue
            if command.begins_section:
                imgui.separator()
            if command.submenu is not None:
                rows = tuple(command.submenu())
                if imgui.begin_menu(command.label, bool(rows)):
                    MenuBar(self._gui, self._messages, rows, self._unsaved).draw_menu(title)
                    imgui.end_menu()
                self._gui.remember(f"menu {title}: {command.label}")
                continue
            is_on = command.is_on is not None and command.is_on()
            label = command.label
            keys = command.displayed_keys
            is_clicked, _ = imgui.menu_item(label, keys, is_on, command.can_run())
            self._gui.remember(f"menu {title}: {label}")
            if is_clicked:
                self._messages.carry_out(command.run)
        if imgui.is_key_pressed(imgui.Key.escape):  # the mouse could reopen a submenu
            imgui.close_current_popup()


def command_button(
    gui: Gui,
    messages: Messages,
    command: Command,
    label: str = "",
    *,
    name: str = "",
    width: float = 0.0,
    meaning: str = "",
    is_wanted: bool = False,
) -> None:
    """Draw a button that runs a command; it is lit while the command is on, or `is_wanted`.

    label, meaning: text and hint of the button, by default the command's label and keys.
    name, width: see `button`.
    """
    is_on = is_wanted or (command.is_on is not None and command.is_on())
    ink = colour(gui.theme.accent, 0.6) if is_on else None
    imgui.begin_disabled(not command.can_run())
    text = label or command.label
    hint = meaning or command.displayed_keys
    if button(gui, text, name=name, width=width, meaning=hint, highlight=ink):
        messages.carry_out(command.run)
    imgui.end_disabled()
