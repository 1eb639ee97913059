"""What can be undone and saved: one state of it, and the file that a script is kept in."""

from __future__ import annotations

import re
from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass, field, replace
from importlib.resources import files
from pathlib import Path

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
    display: object = None  # how the scene is drawn: never changed, compared by what it says
    time: float = field(default=0.0, compare=False)  # [s] at which the pose was made

    def differs_in_view(self, other: Document) -> bool:
        """Whether it is drawn in another way than the other, and else the same."""
        return self != other and replace(self, display=other.display) == other

    def view_change(self, display: object) -> str:
        """What another way to draw the scene changes, in words."""
        before, after = vars(self.display), vars(display)
        names = [name.removeprefix("is_") for name in after if after[name] != before[name]]
        return f"View: {', '.join(names).replace('_', ' ')}"

    def redrawn(self, before: object, after: object) -> Document:
        """The same, drawn as it was changed from one way to draw the scene to another."""
        own, old, new = map(vars, (self.display, before, after))
        display = copy(self.display)
        vars(display).update({name: new[name] for name in own if own[name] == old[name]})
        return replace(self, display=display)

    def new_keys(self, before: Document) -> int:
        """How many keys of tracks it has that the state before does not share with it."""
        known = {id(track) for track in before.script.tracks.values()}
        return sum(len(track) for track in self.script.tracks.values() if id(track) not in known)
