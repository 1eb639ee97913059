"""Which file: the system's own dialog where there is one, else a line to type in the window."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from imgui_bundle import imgui
from imgui_bundle import portable_file_dialogs as dialogs

from .gui import Gui, em

LINUX_HELPERS = ("zenity", "kdialog", "matedialog", "qarma")  # one of which draws native dialogs
FILTERS = ["Scripts and poses", "*.toml", "All files", "*"]


@dataclass
class Request:
    """A file that is asked for, and what to do with it."""

    title: str
    is_saving: bool
    proposed: str
    then: Callable[[Path], None]
    dialog: Any = None  # the native one


class Files:
    """Asks for one file at a time."""

    def __init__(self, *, is_native: bool | None = None) -> None:
        self._is_native = has_native_dialogs() if is_native is None else is_native
        self._request: Request | None = None
        self._text = ""
        self._is_new = False

    @property
    def is_waiting(self) -> bool:
        """Whether an answer is awaited."""
        return self._request is not None

    def ask(
        self, title: str, then: Callable[[Path], None], *, saving: bool, proposed: str = ""
    ) -> None:
        """Ask for a file; `then` is called with it in a later frame, or never."""
        self._request = Request(title, saving, proposed, then)
        self._text, self._is_new = proposed, True
        if self._is_native:
            kind = dialogs.save_file if saving else dialogs.open_file
            self._request.dialog = kind(title, proposed, FILTERS)

    def draw(self, gui: Gui) -> None:
        """Look whether there is an answer, or draw the line in which to type one."""
        if self._request is None:
            return
        if self._request.dialog is None:
            self._draw_line(gui, self._request)
        elif self._request.dialog.ready(0):
            result = self._request.dialog.result()
            path = result if isinstance(result, str) else next(iter(result), "")
            self._answer(path)

    def _answer(self, path: str) -> None:
        request, self._request = self._request, None
        if request is None or not path.strip():
            return
        target = Path(path.strip().strip("'\"")).expanduser()
        if request.is_saving and not target.suffix:
            target = target.with_suffix(".toml")
        request.then(target)

    def _draw_line(self, gui: Gui, request: Request) -> None:
        if self._is_new:
            imgui.open_popup(request.title)
        imgui.set_next_window_size(imgui.ImVec2(em(32), 0.0))
        is_open, _ = imgui.begin_popup_modal(
            request.title, None, imgui.WindowFlags_.always_auto_resize
        )
        if not is_open:
            return
        if self._is_new:
            imgui.set_keyboard_focus_here()
            self._is_new = False
        imgui.set_next_item_width(-1.0)
        is_entered, self._text = imgui.input_text(
            "##path", self._text, imgui.InputTextFlags_.enter_returns_true
        )
        gui.remember("path")
        is_confirmed = imgui.button("Save" if request.is_saving else "Open")
        gui.remember("path confirmed")
        imgui.same_line()
        is_cancelled = imgui.button("Cancel") or imgui.is_key_pressed(imgui.Key.escape)
        gui.remember("path cancelled")
        if is_entered or is_confirmed or is_cancelled:
            imgui.close_current_popup()
            self._answer("" if is_cancelled else self._text)
        imgui.end_popup()


def has_native_dialogs() -> bool:
    """Whether this system can show its own file dialogs."""
    if not sys.platform.startswith("linux"):
        return True
    return any(shutil.which(helper) for helper in LINUX_HELPERS)
