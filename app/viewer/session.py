"""What a user does with a face: controls, a script in time, a recording, undo, unsaved work.

Knows the scene and nothing of windows. Every control of every layer (muscles, jaw, gaze, action
units, expressions, visemes) is one entry of `values`; the scene adds them up.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ..errors import UserError
from ..scenes import Scene, within
from ..script import Script, load_script
from ..script_writer import is_pose, pose_script, save_script
from .history import History
from .recorder import Recorder
from .rows import mirrored, twin_of

SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0)
RANDOM_SHARE = 0.25  # of the muscles that a random pose moves
RANDOM_STRENGTH = 0.8  # most of their range
REPLAY_SETTLING = 1.0  # [s] for which the first pose of a replay was held, as in a film


@dataclass(frozen=True)
class Document:
    """What can be undone and saved."""

    values: Mapping[str, float]  # what is not 0
    script: Script


class Session:
    """The controls of a scene and the script that may move them."""

    def __init__(self, scene: Scene, script: Script) -> None:
        script.check(scene.limits)
        self.scene = scene
        self.limits = scene.limits
        simulation = getattr(scene, "simulation", None)
        # The lowest controls, to which all others add up; all where a scene does not tell.
        self.muscles = frozenset(simulation.controls if simulation is not None else self.limits)
        self.groups = _highest_first(scene.groups, self.muscles, scene.expressions)
        self.values = dict.fromkeys(self.limits, 0.0)
        self.script = script
        self.time = 0.0
        self.is_playing = False
        self.is_looping = False
        self.speed = 1.0
        self.pose_is_unsaved = False  # made by hand; an expression's button brings itself back
        self.script_is_unsaved = False
        self._recorder: Recorder | None = None
        self._moved_by: dict[str, frozenset[str]] = {}
        self._held: dict[str, float] = {}  # by hand while a recording plays the script
        self._history = History(self._document())

    # Controls by hand

    def set(self, name: str, value: float, *, linked: bool = False) -> None:
        """Set a control within its limits, and with `linked` its twin; a script that plays stops.

        While recording, the script goes on and this control is held.
        """
        for each in {name, twin_of(name)} if linked else {name}:
            low, high = self.limits[each]
            self.values[each] = min(max(float(value), low), high)
            if self.is_playing and self.is_recording:
                self._held[each] = self.values[each]
        if not self.is_recording:
            self.is_playing = False
        self.pose_is_unsaved = True

    def show(self, name: str) -> None:
        """This control alone at its most, or neutral if it is so already."""
        pose = dict.fromkeys(self.limits, 0.0)
        if self.shown != name:
            pose[name] = self.limits[name][1]
        self._take_pose(pose, is_unsaved=False)

    @property
    def shown(self) -> str | None:
        """The one control that is not 0, if it is at its most."""
        active = [name for name, value in self.values.items() if value]
        if len(active) == 1 and self.values[active[0]] == self.limits[active[0]][1]:
            return active[0]
        return None

    def neutral(self) -> None:
        """All controls to zero; the skin swings back by itself."""
        self._take_pose(dict.fromkeys(self.limits, 0.0), is_unsaved=False)

    def mirror(self) -> None:
        """What is left becomes right."""
        self._take_pose(mirrored(self.values))

    def randomise(self, generator: np.random.Generator) -> None:
        """A few muscles of each group by chance, both sides alike; layers stay at zero."""
        pose = dict.fromkeys(self.limits, 0.0)
        for names in self.scene.groups.values():
            for name in names:
                is_muscle = name in self.muscles and self.limits[name][0] == 0.0
                if is_muscle and twin_of(name) <= name and generator.random() < RANDOM_SHARE:
                    value = RANDOM_STRENGTH * generator.random() * self.limits[name][1]
                    pose[name] = pose[twin_of(name)] = value
        self._take_pose(pose)

    def _take_pose(self, pose: Mapping[str, float], *, is_unsaved: bool = True) -> None:
        self.is_playing = False
        self.values = dict(pose)
        self.pose_is_unsaved = is_unsaved
        self.note()

    def moved_by(self, name: str) -> frozenset[str]:
        """The muscles that a control moves: itself, or those that a layer's control adds to."""
        simulation = getattr(self.scene, "simulation", None)
        if simulation is None or name in self.muscles:
            return frozenset({name})
        if name not in self._moved_by:
            # Asked of the simulation, between two steps, so that nothing of it is known here.
            simulation.pose({name: self.limits[name][1]})
            sums = simulation.sums
            self.scene.pose(self.values)
            self._moved_by[name] = frozenset(each for each, share in sums.items() if share)
        return self._moved_by[name]

    # Undo

    def _document(self) -> Document:
        return Document({name: value for name, value in self.values.items() if value}, self.script)

    def note(self) -> None:
        """A change is complete (a slider let go, a button pressed): it can be undone."""
        self._history.note(self._document())

    @property
    def can_undo(self) -> bool:
        """Whether there is something to undo."""
        return self._history.can_undo or self._document() != self._history.present

    @property
    def can_redo(self) -> bool:
        """Whether there is something to redo."""
        return self._history.can_redo

    def undo(self) -> None:
        """Back to before the last change, or to it, if the script has moved the controls since."""
        is_elsewhere = self._document() != self._history.present
        self._restore(self._history.present if is_elsewhere else self._history.undo())

    def redo(self) -> None:
        """Forward again."""
        self._restore(self._history.redo())

    def _restore(self, document: Document) -> None:
        self.is_playing = False
        self.values = self._all(document.values)
        self.pose_is_unsaved = bool(document.values)
        if document.script != self.script:
            self.script, self.script_is_unsaved = document.script, True
            self.time = min(self.time, self.script.duration)

    # Time

    def toggle_playing(self) -> None:
        """Play or pause; at the end of the script, play it again."""
        self.is_playing = not self.is_playing
        if self.is_playing and self.time >= self.script.duration:
            self.time = 0.0
        if self.is_playing and self.time == 0.0:
            self.start_over()

    def start_over(self) -> None:
        """The first pose, as if it had been held for a while: each replay begins alike."""
        self.time = 0.0
        self._follow_script()
        self.scene.reset()
        self.scene.pose(self.values)
        if any(self.values.values()):
            self.scene.step(REPLAY_SETTLING)

    def seek(self, time: float) -> None:
        """Go to a time of the script and take its pose."""
        self.time = min(max(time, 0.0), self.script.duration)
        self._follow_script()
        self.pose_is_unsaved = False

    def seek_key(self, direction: int) -> None:
        """Pause at the next time at which the script has a key, or with -1 at the one before."""
        times = key_times(self.script)
        beyond = [time for time in times if (time - self.time) * direction > 1e-6]
        self.is_playing = False
        self.seek((min if direction > 0 else max)(beyond, default=self.time))

    def advance(self, seconds: float) -> None:
        """Let time pass: the script moves the controls, the scene follows them."""
        if self.is_playing:
            self.time += self.speed * seconds
            if self.time >= self.script.duration:
                self.time = 0.0 if self.is_looping else self.script.duration
                self.is_playing = self.is_looping
            self._follow_script()
        if self._recorder is not None:
            self._recorder.take(seconds, self.values)
        self.scene.pose(self.values)
        self.scene.step(seconds)

    def _follow_script(self) -> None:
        self.values = self._all({**self.script.at(self.time), **self._held})

    def _all(self, values: Mapping[str, float]) -> dict[str, float]:
        """A value for each control, within its limits; 0 where none is given."""
        return {**dict.fromkeys(self.limits, 0.0), **within(self.limits, values)}

    @property
    def is_recording(self) -> bool:
        """Whether movements are being recorded."""
        return self._recorder is not None

    def toggle_recording(self) -> None:
        """Record the controls from now on, or take what was recorded as the script."""
        if self._recorder is None:
            self._recorder = Recorder()
            self._held = {}
            return
        take = self._recorder.script(
            title="Recording", scene=self.script.scene, camera=self.script.camera
        )
        self._recorder, self._held = None, {}
        self.is_playing = False
        if take is None:
            raise UserError("nothing was recorded: no control moved")
        self.script, self.script_is_unsaved, self.time = take, True, take.duration
        self.pose_is_unsaved = False
        self.note()

    @property
    def recorded_seconds(self) -> float:
        """How long the recording is so far."""
        return self._recorder.time if self._recorder is not None else 0.0

    # Files

    def read(self, path: Path) -> Script:
        """The script or pose in a file, if it is for this scene; UserError says what is wrong."""
        script = load_script(path)
        if script.scene != self.script.scene:
            raise UserError(
                f"{path}: is for the scene '{script.scene}', and this window shows "
                f"'{self.script.scene}': `risorius view --scene {script.scene} --script {path}`"
            )
        script.check(self.limits)
        return script

    def take(self, script: Script) -> None:
        """A pose to show, which a recording takes in, or a script to play, which ends it."""
        self.is_playing = False
        if is_pose(script):
            self.values = self._all(script.at(0.0))
        else:
            self._recorder, self._held = None, {}
            self.script, self.script_is_unsaved = script, False
            self.seek(0.0)
        self.pose_is_unsaved = False
        self.note()

    def save_script(self, path: Path) -> None:
        """Write the script to a file; UserError where it cannot be written."""
        save_script(path, self.script)
        self.script = replace(self.script, source=str(path))
        self.script_is_unsaved = False
        self.note()

    def save_pose(self, path: Path) -> None:
        """Write the controls as they are to a file; UserError where it cannot be written."""
        save_script(path, pose_script(self.values, title=path.stem, scene=self.script.scene))
        self.pose_is_unsaved = False

    @property
    def unsaved(self) -> str:
        """What would be lost by closing, in words; "" for nothing."""
        lost = {
            "the pose": self.has_unsaved_pose,
            "the recorded script": self.script_is_unsaved,
            "the recording": self.is_recording,
        }
        return " and ".join(what for what, is_lost in lost.items() if is_lost)

    @property
    def has_unsaved_pose(self) -> bool:
        """Whether there is a pose made by hand that no file has."""
        return self.pose_is_unsaved and any(self.values.values())


def key_times(script: Script) -> list[float]:
    """The times at which a script has keys, in order [s]."""
    channels = (*script.poses.values(), *script.tracks.values())
    return sorted({key.time for channel in channels for key in channel.keys})


def _highest_first(
    groups: Mapping[str, tuple[str, ...]], muscles: Collection[str], expressions: Collection[str]
) -> dict[str, tuple[str, ...]]:
    """Expressions, then the other layers above the muscles, then muscles, jaw and gaze."""

    def rank(title: str) -> int:
        first = groups[title][0]
        return 0 if first in expressions else 1 if first not in muscles else 2

    return {title: groups[title] for title in sorted(groups, key=rank)}
