"""A user's work on a face: controls, a script in time, a recording, undo, unsaved work.

This module uses the scene, which adds up all `values`. It is independent of windows.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from ...control_names import copied, mirrored, readable, twin_of
from ...control_names.limits import ControlValues
from ...errors import UserError
from ...motion import SETTLING_TIME
from ...performances import new_script
from ...scenes import Scene
from ...script import Script, keyframes, rounded
from ...script.recorder import Recorder
from ...script.script_file import is_pose, pose_script, save_script
from ...text import as_text, counted
from ..messages import Message
from .document import Document, History, LiveOverride, SceneControls, ScriptFile


class Session:
    """The controls of a scene and the script that may move them."""

    def __init__(self, scene: Scene, script: Script) -> None:
        script.check(scene.limits)
        self.scene = scene
        self.controls = SceneControls(scene)
        self.values = script.values(0.0, scene.limits)
        self.script = script
        self.file = ScriptFile.from_script(script)
        self.time = 0.0
        self.speed = 1.0
        self.is_playing = self.is_looping = self.is_keying = False  # keying: changes become keys
        self.pose_is_unsaved = False  # a pose by hand, except from an expression's button
        self.is_following = any(self.values.numbers)  # the script; not at first if it is neutral
        self._is_touched = False  # whether a control was moved by hand since the last `note`
        self._moved = set[str]()  # controls moved by hand since the face followed the script
        self.recorder: Recorder | None = None  # recorder of the current recording
        self.live_override = LiveOverride(scene.limits)  # not a part of undo
        self.history = History(self._document())
        self.work = Work(self)

    def move_to(self, scene: Scene) -> None:
        """Keep the work, and show another scene; raises UserError if the scene lacks controls."""
        if scene.name != self.scene.name or not scene.limits.keys() >= self.controls.limits.keys():
            raise UserError(f"this window shows a {self.scene.name}, which has other controls")
        self.script.check(scene.limits)
        self.scene = scene
        self.controls = SceneControls(scene)
        self.values = scene.limits.pose(self.values)
        self.live_override = LiveOverride(scene.limits)

    # Controls by hand

    def set(self, name: str, value: float, *, linked: bool = False) -> None:
        """Set a control within its limits, and its twin if `linked`; a playing script stops."""
        names = {name, twin_of(name)} if linked else {name}
        self.values = self.scene.limits.pose(dict.fromkeys(names, rounded(value)), self.values)
        if self.recorder is not None:  # the script goes on, and this value is held
            self.recorder.held.update((each, self.values[each]) for each in names)
        if not self.is_recording:
            self.is_playing = self.is_following = False
            self.pose_is_unsaved = self._is_touched = True
            self._moved |= names

    def toggle_solo(self, name: str) -> None:
        """Show this control alone at its limit; if that is already so, show the neutral face."""
        pose = self.scene.limits.pose({}) if self.is_solo(name) else self.controls.solo_pose(name)
        self.set_pose(pose, is_unsaved=False)

    def is_solo(self, name: str) -> bool:
        """Whether only this control is set, and at its limit."""
        return self.values == self.controls.solo_pose(name)

    def neutral(self) -> None:
        """Set all controls to zero; the skin swings back."""
        self.set_pose(self.scene.limits.pose({}), is_unsaved=False)

    def mirror(self, source: str = "") -> None:
        """Exchange left and right, or copy one side ("left", "right") to the other."""
        values = copied(self.values, source) if source else mirrored(self.values)
        self.set_pose(self.scene.limits.pose(values))

    def set_pose(self, pose: ControlValues, *, is_unsaved: bool = True) -> None:
        """Set all controls to a pose; a recording records the changed controls."""
        if self.recorder is not None:
            self.recorder.held |= {n: v for n, v in pose.items() if v != self.values[n]}
        else:
            self.is_playing = self.is_following = False
            self.pose_is_unsaved = is_unsaved
            self._is_touched = True
            self._moved |= {name for name, value in pose.items() if value != self.values[name]}
        self.values = pose
        self.note()

    @property
    def current(self) -> ControlValues:
        """The value of each control by hand or script, overridden by a live face."""
        return self.live_override.applied_to(self.values)

    @property
    def differing(self) -> frozenset[str]:
        """The controls whose values by hand differ from the script; computed from every track."""
        if self.is_following or self.is_recording:
            return frozenset()
        return frozenset(self._differing_from(self.values))

    @property
    def touched(self) -> frozenset[str]:
        """The controls moved by hand or by a live face since the last key."""
        return frozenset(self._moved.union(self._differing_from(self.current)))

    def _differing_from(self, values: ControlValues) -> list[str]:
        return keyframes.differing(self.script, self.time, values)

    # Undo

    def _document(self) -> Document:
        values = None
        if not self.is_following:
            values = {name: value for name, value in self.values.items() if value}
        return Document(values, self.script, self.file, self.time)

    def note(self) -> None:
        """Note a complete change (a released slider, a pressed button) for undo."""
        if self.is_recording:
            return  # a recording is one change, noted at its end
        is_touched, self._is_touched = self._is_touched, False
        if is_touched and self.is_keying and self.differing:
            self._key(self.values, self._moved.union(self._differing_from(self.values)))
        self.history.note(self._document())

    @property
    def can_undo(self) -> bool:
        """Whether there is something to undo."""
        return self.history.can_undo or self._document() != self.history.current

    def undo(self) -> None:
        """Undo the changes since the last noted state; without changes, undo that state."""
        self.go_to(self.history.place - (self._document() == self.history.current))

    def redo(self) -> None:
        """Redo the last undone change."""
        self.go_to(self.history.place + 1)

    def go_to(self, place: int) -> None:
        """Restore the state with this index in the history."""
        self._refuse_while_recording()
        document = self.history.restore(place)
        self.is_playing = self._is_touched = False
        self._moved.clear()
        self.script = document.script
        self.file = document.file
        if document.values is None:
            self._go_to(self.time)
        else:  # a pose is shown at its own time
            self.time = min(document.time, self.script.duration)
            self.values = self.scene.limits.pose(document.values)
            self.is_following = False
        self.pose_is_unsaved = bool(document.values)

    # Time

    def toggle_playing(self) -> Message:
        """Play or pause; at the end of the script, play from its beginning."""
        self.is_playing = not self.is_playing
        line = self.release_controls() if self.is_playing else None
        is_over = self.time >= self.script.duration and not self.is_recording
        if self.is_playing and (is_over or self.time == 0.0):
            self.start_over()
        return line

    def start_over(self) -> None:
        """Begin with the first pose, after a time to settle, so that all replays begin alike."""
        self.time = 0.0
        self._follow_script()
        self.scene.reset()
        self.scene.set_controls(self.current)
        if any(self.current.numbers):
            self.scene.step(SETTLING_TIME)  # as in a film

    def seek(self, time: float) -> Message:
        """Show the script's pose at a time; the message names the controls that this resets."""
        self._refuse_while_recording()
        line = self.release_controls()
        self._go_to(time)
        return line

    def _go_to(self, time: float) -> None:
        self.time = min(max(time, 0.0), self.script.duration)
        self._follow_script()
        self.pose_is_unsaved = False

    def release_controls(self) -> Message:
        """Follow the script again; the message names released controls, which undo restores."""
        if self.is_following or self.is_recording:
            return None
        self.note()
        names = self.differing
        self._go_to(self.time)
        if not names:
            self.history.amend(self._document())
            return None
        controls = readable(min(names)) if len(names) == 1 else counted(len(names), "control")
        self.history.note(self._document())
        return f"{controls} not keyed, so released; [Undo] restores the pose"

    def seek_key(self, direction: int) -> Message:
        """Go to the next time with a key, or with -1 to the previous time, and pause."""
        line = self.seek(keyframes.time_beyond(self.script, self.time, direction))
        self.is_playing = False
        return line

    def edit(self, script: Script, *, is_done: bool = True) -> None:
        """Replace the script by a changed script; a face that follows it is updated.

        is_done: False during a drag; a change is a step of undo only when it is done.
        """
        self._refuse_while_recording()
        self.script = script
        self.time = min(self.time, script.duration)
        if self.is_following:
            self._follow_script()
        if is_done:
            self.note()

    def _refuse_while_recording(self) -> None:
        if self.is_recording:
            raise UserError(
                "stop the recording first ([Record]); it is added to the script as it is now"
            )

    def set_key(self, names: Iterable[str] | None = None) -> float:
        """Set a key with the current face; return its time [s].

        names: the controls that get keys; None for a whole pose. Other controls keep the values
        that the user has set.
        """
        self._refuse_while_recording()
        time = self._key(self.current, names)
        self.note()
        return time

    def _key(self, values: ControlValues, names: Iterable[str] | None) -> float:
        time = keyframes.key_time(self.script, self.time)
        left = set[str]()
        if names is None:
            self.script = keyframes.keyed(self.script, time, values)
        else:
            chosen = set(names)
            left = set(self.differing - chosen)
            self.script = keyframes.with_keys_of(self.script, time, values, chosen)
            self._moved -= chosen
        self.is_playing = False
        if left:
            self.time = time
        else:
            self._go_to(time)
        return time

    def advance(self, seconds: float, beneath: Mapping[str, float] | None = None) -> None:
        """Advance by `seconds` [s]: the script moves the controls, and the scene follows them.

        beneath: values to add to controls that are 0; they are never recorded.
        """
        if self.is_playing:
            self.time += self.speed * seconds
            if self.time >= self.script.duration and (self.is_looping or not self.is_recording):
                self.time = 0.0 if self.is_looping else self.script.duration
                self.is_playing = self.is_looping
            self._follow_script()
        current = self.current
        if self.recorder is not None:
            self.recorder.add(self.time, current)
        self.scene.set_controls(self.scene.limits.pose(beneath, current) if beneath else current)
        self.scene.step(seconds)

    def _follow_script(self) -> None:
        self.is_following = True
        self._moved.clear()
        held = self.recorder.held if self.recorder is not None else {}
        limits = self.scene.limits
        self.values = limits.pose(held, self.script.values(self.time, limits))

    @property
    def is_recording(self) -> bool:
        """Whether movements are being recorded."""
        return self.recorder is not None

    def toggle_recording(self) -> Message:
        """Begin to record moved controls while the script plays on, or end the recording.

        Nothing is recorded while the script is paused or repeats a part.
        """
        if self.recorder is None:
            held = {name: self.values[name] for name in self.differing}
            start = self.time % self.script.duration if self.is_looping else self.time
            self.recorder = Recorder(self.script, start, held)
            self.time = self.recorder.start
            self.pose_is_unsaved = False
            if not self.is_playing:
                self.toggle_playing()
            return f"Recording from {self.time:.2f} s: your moves replace the script there"
        recorder, self.recorder = self.recorder, None
        recording = recorder.script()
        self.is_playing = False
        if recording is not None:
            self.script = recording
            self._go_to(rounded(self.time))  # the end, if the recording is the script's last part
        self.values = self.scene.limits.pose(recorder.missed, self.values)
        self.is_following = False
        missed = self.differing  # these controls stay as a pose by hand
        self.is_following = not missed
        self.pose_is_unsaved = bool(missed)
        controls = counted(len(recorder.samples), "control")
        self.note()
        if recording is None:
            raise UserError("nothing was recorded: no control moved")
        apart = f"; {counted(len(missed), 'control')} moved after that, not keyed" if missed else ""
        return f"{controls} recorded from {recorder.start:.2f} to {recorder.time:.2f} s{apart}"

    @property
    def recorded_seconds(self) -> float:
        """Current duration of the recording [s]."""
        return self.recorder.time - self.recorder.start if self.recorder is not None else 0.0

    def replace_script(self, script: Script, file: ScriptFile) -> None:
        """Replace the script by another script; a recording ends."""
        self.recorder = None
        self._is_touched = False
        self.script = script
        self.file = file
        self.is_playing = False
        self._go_to(0.0)
        self.note()


class Work:
    """The files of a session: scripts and poses that are opened, saved or unsaved."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def open(self, script: Script) -> None:
        """Show a pose or a script; a recording records the pose, and ends with a script."""
        if is_pose(script):
            pose = script.values(0.0, self._session.scene.limits)
            self._session.set_pose(pose, is_unsaved=False)
        else:
            self._session.replace_script(script, ScriptFile.from_script(script))

    def begin_script(self) -> None:
        """Begin a script with the current face as its pose, to which keys can be added."""
        session = self._session
        old = session.script
        is_unsaved = session.pose_is_unsaved
        script = new_script(old.scene, old.camera, session.values)
        session.replace_script(script, ScriptFile(None, script))
        session.pose_is_unsaved = is_unsaved

    def save_script(self, path: Path) -> None:
        """Write the script to a file; raises UserError if it cannot be written."""
        self._session.file.save(self._session.script, path)

    def save_pose(self, path: Path) -> None:
        """Write the current controls to a file; raises UserError if it cannot be written."""
        session = self._session
        pose = pose_script(session.current, title=path.stem, scene=session.script.scene)
        save_script(path, pose)
        session.pose_is_unsaved = False

    @property
    def unsaved(self) -> str:
        """The work that closing would lose, in words; "" for nothing."""
        lost = {"the pose": self.has_unsaved_pose, "the script": self.script_is_unsaved}
        lost["the recording"] = self._session.is_recording
        return " and ".join(part for part, is_lost in lost.items() if is_lost)

    @property
    def script_is_unsaved(self) -> bool:
        """Whether the script differs from its file."""
        return self._session.file.differs(self._session.script)

    @property
    def name(self) -> str:
        """The script's name: the name of its file, or without a file its title."""
        path = self._session.file.path
        return as_text(path.name if path else self._session.script.title or "Untitled")

    @property
    def has_unsaved_pose(self) -> bool:
        """Whether there is an unsaved pose made by hand."""
        return self._session.pose_is_unsaved and any(self._session.values.numbers)
