"""Which file a script is kept in, and whether what is there is what it says now."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

from ..script import Script
from ..script_writer import save_script


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
        """The file that a script was read from; the program's own examples are nobody's file."""
        path = Path(script.source)
        is_own = path.is_file() and not path.resolve().is_relative_to(str(files("assets")))
        return cls(path if is_own else None, script)

    def differs(self, script: Script) -> bool:
        """Whether saving would change anything."""
        return script is not self._saved and script != self._saved

    @property
    def is_foreign(self) -> bool:
        """Whether another program has changed the file since it was read or written here."""
        return self.path is not None and self.path.exists() and _bytes_of(self.path) != self._bytes

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
