"""What can be undone and saved: one state of it."""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass, field, replace

from ..script import Script
from .script_file import ScriptFile


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
