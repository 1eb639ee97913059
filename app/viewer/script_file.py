"""Which file a script is kept in, and whether what is there is what it says now."""

from __future__ import annotations

import re
from importlib.resources import files
from pathlib import Path

from ..script import Script, preface_of, save_script

_QUOTED = re.compile(r"""'[^'\n]*'|"(?:\\.|[^"\\\n])*\"""")


class ScriptFile:
    """The file of one script, through all that is done to it; undo and redo share it.

    path: None as long as no file of the user's holds the script.
    """

    def __init__(self, path: Path | None, saved: Script | None) -> None:
        self.path = path
        self._saved = saved
        self._bytes = _bytes_of(path)

    @classmethod
    def of(cls, script: Script) -> ScriptFile:
        """The file that a script was read from; examples and recordings are no file to save to."""
        path = Path(script.source)
        is_own = not script.is_converted and path.is_file()
        is_own = is_own and not path.resolve().is_relative_to(str(files("risorius.assets")))
        return cls(path if is_own else None, script)

    @classmethod
    def recovered(cls, path: Path | None, when: float) -> ScriptFile:
        """The file of a script that was not saved to it, as it was at a time [s since 1970]."""
        file = cls(path, None)
        if path is not None and path.exists() and path.stat().st_mtime > when:
            file._bytes = None  # somebody has written it since
        return file

    def differs(self, script: Script) -> bool:
        """Whether saving would change anything."""
        return script is not self._saved and script != self._saved

    @property
    def objection(self) -> str:
        """What would be lost by writing the file unasked, in words; "" for nothing."""
        if self.path is None or not self.path.exists():
            return ""
        if _bytes_of(self.path) != self._bytes:
            return "another program has changed it"
        return "its comments would be lost" if self._has_comments else ""

    @property
    def _has_comments(self) -> bool:
        """Whether there are comments that are not kept: all but those at the head."""
        text = (self._bytes or b"").decode(errors="replace")
        return "#" in _QUOTED.sub("", text.removeprefix(preface_of(text)))

    def save(self, script: Script, path: Path) -> None:
        """Write the script, which from now on is kept there; UserError where it cannot be."""
        save_script(path, script)
        self.path, self._saved, self._bytes = path, script, _bytes_of(path)


def _bytes_of(path: Path | None) -> bytes | None:
    """What is in a file; None where it cannot be read."""
    try:
        return path.read_bytes() if path is not None else None
    except OSError:
        return None
