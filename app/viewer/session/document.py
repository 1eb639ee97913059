"""What can be undone and saved: states of it, and the file that a script is kept in."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path
from typing import Generic, TypeVar

from ...script import Script, preface_of, save_script

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


@dataclass(frozen=True)
class Document:
    """A pose, a script, and where that is kept."""

    values: Mapping[str, float] | None  # set by hand, what is not 0; None: as the script has it
    script: Script
    file: ScriptFile  # in which the script is kept
    time: float = field(default=0.0, compare=False)  # [s] at which the pose was made


State = TypeVar("State")
MOST = 100  # states


class History(Generic[State]):
    """The states that there were; the last one noted is the present."""

    def __init__(self, present: State) -> None:
        self._states = [present]
        self.labels = ["Beginning"]  # what was done to come to each state
        self.place = 0  # of the present among them

    @property
    def can_undo(self) -> bool:
        """Whether there is something before the present."""
        return self.place > 0

    @property
    def can_redo(self) -> bool:
        """Whether something was undone."""
        return self.place < len(self._states) - 1

    @property
    def present(self) -> State:
        """The state noted last, or come back to."""
        return self._states[self.place]

    def note(self, state: State, label: str = "") -> None:
        """Something was done; what was undone before is forgotten. Equal states count once.

        label: what was done, as "Mirror".
        """
        if state == self.present:
            return
        end = self.place + 1
        self._states[end:], self.labels[end:] = [state], [label]
        del self._states[:-MOST], self.labels[:-MOST]
        self.place = len(self._states) - 1

    def amend(self, state: State) -> None:
        """The present is this now, which nobody would call a step."""
        self._states[self.place] = state

    def go(self, place: int) -> State:
        """To the state of this number, or as near as there is one."""
        self.place = min(max(place, 0), len(self._states) - 1)
        return self.present
