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

from .messages import Message

LINUX_HELPERS = ("zenity", "kdialog", "matedialog", "qarma")  # one of which draws native dialogs
SCRIPTS = "Scripts and poses"
SUFFIX = ".toml"  # of both
UNSEEN = 1.0  # [s] a dialog that has ended so soon without an answer never came up


@dataclass
class Request:
    """A file that is asked for, and what to do with it."""

    title: str
    is_saving: bool
    proposed: Path  # where to begin; for saving with a name
    suffixes: tuple[str, ...]  # how the names of such files end
    then: Callable[[Path], Message]
    dialog: Any = None  # the native one; None where panels/chooser.py asks
    began: float = 0.0  # [s] when it came up


class Files:
    """Asks for one file at a time."""

    request: Request | None

    def __init__(self, *, is_native: bool | None = None) -> None:
        self._is_native = has_native_dialogs() if is_native is None else is_native
        self.request = None
        self._folder: Path | None = None  # where the last file was

    @property
    def is_waiting(self) -> bool:
        """Whether an answer is awaited."""
        return self.request is not None

    def ask(
        self,
        title: str,
        then: Callable[[Path], Message],
        *,
        saving: bool,
        proposed: str = "",
        kind: str = SCRIPTS,
        suffixes: tuple[str, ...] = (SUFFIX,),
    ) -> None:
        """Ask for a file of a kind; `then` is called with it in a later frame, or never."""
        target = (self._folder or Path.cwd()) / proposed
        self.request = Request(title, saving, target, suffixes, then)
        if self._is_native:
            dialog = dialogs.save_file if saving else dialogs.open_file
            endings = " ".join(f"*{suffix}" for suffix in suffixes)
            filters = [kind, endings, "All files", "*"]
            self.request.dialog = dialog(title, str(target), filters)
            self.request.began = time.monotonic()

    def poll(self) -> Message:
        """Look whether the native dialog has an answer, and go on with it."""
        request = self.request
        if request is None or request.dialog is None or not request.dialog.ready(0):
            return None
        result = request.dialog.result()
        path = result if isinstance(result, str) else next(iter(result), "")
        if not path and time.monotonic() - request.began < UNSEEN:
            self._is_native = False
            request.dialog = None  # go on in the window: there was no dialog
            return None
        target = Path(path)
        if path and request.is_saving and not target.suffix:
            target = target.with_suffix(request.suffixes[0])
            if target.exists():  # the dialog has asked about the name without its end
                request.proposed, request.dialog = target, None
                return None
        return self.answer(target if path else None)

    def answer(self, path: Path | None) -> Message:
        """Go on with the file that was chosen; None for none."""
        request, self.request = self.request, None
        if request is None or path is None:
            return None
        self._folder = path.parent
        return request.then(path)


def has_native_dialogs() -> bool:
    """Whether this system can show its own file dialogs."""
    if not sys.platform.startswith("linux"):
        return True
    return any(shutil.which(helper) for helper in LINUX_HELPERS)
