"""Which file: the system's own dialog where there is one, else a chooser in the window."""

from __future__ import annotations

import shutil
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from imgui_bundle import portable_file_dialogs as dialogs

from .gui import Gui
from .panels.chooser import SUFFIX, Chooser

LINUX_HELPERS = ("zenity", "kdialog", "matedialog", "qarma")  # one of which draws native dialogs
SCRIPTS = "Scripts and poses"
UNSEEN = 1.0  # [s] a dialog that has ended so soon without an answer never came up


@dataclass
class Request:
    """A file that is asked for, and what to do with it."""

    title: str
    is_saving: bool
    proposed: Path  # where to begin; for saving with a name
    suffixes: tuple[str, ...]  # how the names of such files end
    then: Callable[[Path], None]
    dialog: Any = None  # the native one
    began: float = 0.0  # [s] when it came up
    chooser: Chooser | None = None  # in its place


class Files:
    """Asks for one file at a time."""

    def __init__(self, *, is_native: bool | None = None) -> None:
        self._is_native = has_native_dialogs() if is_native is None else is_native
        self._request: Request | None = None
        self._folder: Path | None = None  # where the last file was

    @property
    def is_waiting(self) -> bool:
        """Whether an answer is awaited."""
        return self._request is not None

    def ask(
        self,
        title: str,
        then: Callable[[Path], None],
        *,
        saving: bool,
        proposed: str = "",
        kind: str = SCRIPTS,
        suffixes: tuple[str, ...] = (SUFFIX,),
    ) -> None:
        """Ask for a file of a kind; `then` is called with it in a later frame, or never."""
        proposed_path = (self._folder or Path.cwd()) / proposed
        request = Request(title, saving, proposed_path, suffixes, then)
        if self._is_native:
            dialog = dialogs.save_file if saving else dialogs.open_file
            endings = " ".join(f"*{suffix}" for suffix in suffixes)
            request.dialog = dialog(title, str(proposed_path), [kind, endings, "All files", "*"])
            request.began = time.monotonic()
        else:
            _open_chooser(request, proposed_path)
        self._request = request

    def draw(self, gui: Gui) -> None:
        """Look whether there is an answer, or draw the chooser."""
        request = self._request
        if request is None:
            return
        if request.chooser is not None:
            answer = request.chooser.draw(gui)
            if answer is not None:
                self._answer(request, answer)
        elif request.dialog.ready(0):
            result = request.dialog.result()
            self._hear(request, result if isinstance(result, str) else next(iter(result), ""))

    def _hear(self, request: Request, path: str) -> None:
        """Take the native dialog's answer, or go on in the window where there was no dialog."""
        if not path and time.monotonic() - request.began < UNSEEN:
            self._is_native = False
            _open_chooser(request, request.proposed)
            return
        target = Path(path)
        if path and request.is_saving and not target.suffix:
            target = target.with_suffix(SUFFIX)
            if target.exists():  # the dialog has asked about the name without its end
                _open_chooser(request, target)
                return
        self._answer(request, target if path else "")

    def _answer(self, request: Request, answer: Path | str) -> None:
        self._request = None
        if isinstance(answer, Path):
            self._folder = answer.parent
            request.then(answer)


def _open_chooser(request: Request, target: Path) -> None:
    """Ask inside the window."""
    folder, name = (target.parent, target.name) if request.is_saving else (target, "")
    request.chooser = Chooser(
        request.title, folder, name, is_saving=request.is_saving, suffixes=request.suffixes
    )


def has_native_dialogs() -> bool:
    """Whether this system can show its own file dialogs."""
    if not sys.platform.startswith("linux"):
        return True
    return any(shutil.which(helper) for helper in LINUX_HELPERS)
