"""The menu bar, and each menu where it comes up elsewhere."""

from __future__ import annotations

from collections.abc import Sequence

from imgui_bundle import imgui

from ..command import Command
from ..gui import Gui
from ..messages import Messages
from ..session import Session
from .widgets import muted


class MenuBar:
    """Draws menus and carries out what is chosen in them."""

    def __init__(
        self, gui: Gui, session: Session, messages: Messages, commands: Sequence[Command]
    ) -> None:
        self._gui, self._session, self._messages = gui, session, messages
        self._commands = commands

    def draw(self) -> float:
        """Draw the bar; returns its height [window units]."""
        if not imgui.begin_main_menu_bar():
            return 0.0
        height = float(round(imgui.get_window_size().y))
        for title in dict.fromkeys(command.menu for command in self._commands):
            is_open = imgui.begin_menu(title)
            self._gui.remember(f"menu {title}")
            if is_open:
                self.draw_menu(title)
                imgui.end_menu()
        if self._session.unsaved:
            muted(self._gui, f"   Unsaved: {self._session.unsaved}")
        imgui.end_main_menu_bar()
        return height

    def draw_menu(self, title: str) -> None:
        """What a menu offers, inside it."""
        for command in self._commands:
            if command.menu != title:
                continue
            if command.submenu is not None:
                rows = tuple(command.submenu())
                if imgui.begin_menu(command.label, bool(rows)):
                    MenuBar(self._gui, self._session, self._messages, rows).draw_menu(title)
                    imgui.end_menu()
                self._gui.remember(f"menu {title}: {command.label}")
                continue
            is_on = command.is_on is not None and command.is_on()
            name = f"menu {title}: {command.label}"
            label = f"{command.reads()}###{name}" if command.reads else command.label
            is_clicked, _ = imgui.menu_item(label, command.displayed_keys, is_on, command.can_run())
            self._gui.remember(name)
            if is_clicked:
                self._messages.attempt(command.run)
        if imgui.is_key_pressed(imgui.Key.escape):  # the mouse may be on what opens a submenu again
            imgui.close_current_popup()
