"""The user's document: the controls of a scene, undo, a script's file."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path
from typing import Generic, TypeVar

import numpy as np

from risorius.assets.loading import read_words
from risorius.sim.layers import BOTH_SIDES

from ...control_names.limits import ControlValues, Limits
from ...scenes import Scene
from ...script import Script
from ...script.script_file import preface_of, save_script


class SceneControls:
    """Every control of every layer (muscles, jaw, gaze, action units, expressions, visemes).

    limits: the lowest and highest value of each control. muscles: the controls of the lowest layer,
    which all other controls move; without layers, all controls. groups: title -> controls, the
    highest layer first; the group of muscles for both sides is left out.
    """

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self.limits = scene.limits
        own = self.limits if scene.face is None else scene.face.simulation.controls.lowest
        self.muscles = frozenset(own)
        order = [*read_words()["order"], *scene.groups]
        self.groups = {
            title: scene.groups[title]
            for title in dict.fromkeys(order)
            if title in scene.groups and title != BOTH_SIDES
        }

    def solo_pose(self, name: str) -> ControlValues:
        """Return the pose with this control at its highest value, and all others at 0."""
        return self.limits.pose({name: self.limits[name][1]})

    def moved_by(self, values: Mapping[str, float]) -> frozenset[str]:
        """Return the controls of the lowest layer that a pose moves."""
        active = (name for name, value in values.items() if value)
        return frozenset().union(*map(self._scene.moved_by, active))


class LiveOverride:
    """Overrides controls by a live face, with a weight of 0 (no effect) to 1 (full replacement)."""

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._names: tuple[str, ...] | None = None
        self.override({}, 0.0)

    def override(self, controls: Mapping[str, float], share: float) -> None:
        """Set the overriding controls and their weight; unknown names are left out."""
        if (names := tuple(controls)) != self._names:  # a stream has the same names in each frame
            self._names = names
            self._known = tuple(name for name in names if name in self._limits)
            self._places = self._limits.places(self._known)
        wanted = np.array([controls[name] for name in self._known], np.float64)
        self._wanted = self._limits.cut_off(wanted, self._places)
        self._share = share

    @property
    def is_on(self) -> bool:
        """Whether any control is overridden."""
        return self._share > 0.0

    def applied_to(self, values: ControlValues) -> ControlValues:
        """Return the overridden values; a weighted mean of two values stays within their limits."""
        if not self._share:
            return values
        numbers = values.numbers.copy()
        numbers[self._places] += self._share * (self._wanted - numbers[self._places])
        return ControlValues(self._limits, numbers)


QUOTED_TEXT = re.compile(r"""'[^'\n]*'|"(?:\\.|[^"\\\n])*\"""")


class ScriptFile:
    """The file of one script, through all changes of the script, including undo and redo.

    path: None while no file of the user has the script.
    """

    def __init__(self, path: Path | None, saved: Script) -> None:
        self.path = path
        self._saved = saved
        self._bytes = _bytes_of(path)

    @classmethod
    def from_script(cls, script: Script) -> ScriptFile:
        """Return the file of a script; its path is None for examples and recordings."""
        path = Path(script.source)
        is_own = not script.is_converted and path.is_file()
        is_own = is_own and not path.resolve().is_relative_to(str(files("risorius.assets")))
        return cls(path if is_own else None, script)

    def differs(self, script: Script) -> bool:
        """Whether the script differs from the saved script."""
        return script is not self._saved and script != self._saved

    @property
    def objection(self) -> str:
        """The reason to ask before the file is replaced, in words; "" for none."""
        if self.path is None or not self.path.exists():
            return ""
        if _bytes_of(self.path) != self._bytes:
            return "another program has changed it"
        return "its comments would be lost" if self._has_comments else ""

    @property
    def _has_comments(self) -> bool:
        """Whether the file has comments below its head, which saving would remove."""
        text = (self._bytes or b"").decode(errors="replace")
        return "#" in QUOTED_TEXT.sub("", text.removeprefix(preface_of(text)))

    def save(self, script: Script, path: Path) -> None:
        """Write the script to a file, its file from now on; raises UserError if this fails."""
        save_script(path, script)
        self.path = path
        self._saved = script
        self._bytes = _bytes_of(path)


def _bytes_of(path: Path | None) -> bytes | None:
    """Return the bytes of a file; None if it cannot be read."""
    try:
        return path.read_bytes() if path is not None else None
    except OSError:
        return None


@dataclass(frozen=True)
class Document:
    """A pose, a script, and the file of the script."""

    values: Mapping[str, float] | None  # values by hand that are not 0; None: the script's
    script: Script
    file: ScriptFile  # the script's file
    time: float = field(default=0.0, compare=False)  # time of the pose [s]


State = TypeVar("State")


class History(Generic[State]):
    """States for undo and redo; `place` is the index of the current state."""

    def __init__(self, present: State) -> None:
        self._states = [present]
        self.place = 0  # index of the current state

    @property
    def can_undo(self) -> bool:
        """Whether there is a state before the current one."""
        return self.place > 0

    @property
    def can_redo(self) -> bool:
        """Whether an undone state exists."""
        return self.place < len(self._states) - 1

    @property
    def current(self) -> State:
        """The state that was noted or restored last."""
        return self._states[self.place]

    def note(self, state: State) -> None:
        """Add a changed state, and drop undone states; an equal state is ignored."""
        if state == self.current:
            return
        self._states[self.place + 1 :] = [state]
        del self._states[:-100]  # number of kept states
        self.place = len(self._states) - 1

    def amend(self, state: State) -> None:
        """Replace the current state without a step of undo."""
        self._states[self.place] = state

    def restore(self, place: int) -> State:
        """Restore the state with this index, or with the nearest index."""
        self.place = min(max(place, 0), len(self._states) - 1)
        return self.current
