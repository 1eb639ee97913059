"""What a user does with a face: controls, a script in time, a recording, undo, unsaved work.

Knows the scene and nothing of windows. Every control is one entry of `values`; the scene adds them
up.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..errors import UserError
from ..mirror import copied, mirrored, twin_of
from ..motion import SETTLING
from ..scenes import Scene
from ..script import Pose, Script, is_pose, pose_script, rounded, save_script
from . import keyframes
from .controls import Controls
from .document import Document
from .history import History
from .lead import Lead
from .recorder import Recorder
from .script_file import ScriptFile
from .unsaved import Work

SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0)
NEW_SECONDS = 4.0  # that a script begun from nothing lasts


class Session:
    """The controls of a scene and the script that may move them."""

    is_playing: bool
    is_looping: bool

    def __init__(self, scene: Scene, script: Script) -> None:
        script.check(scene.limits)
        self.scene, self.controls = scene, Controls(scene)
        self.values = self.controls.pose({})
        self.script = script
        self.file = ScriptFile.of(script)
        self.time = 0.0
        self.is_playing = False
        self.is_looping = False
        self.speed = 1.0
        self.pose_is_unsaved = False  # made by hand; an expression's button brings itself back
        self.is_following = False  # the controls are where the script has them
        self._recorder: Recorder | None = None
        self._held: dict[str, float] = {}  # by hand while a recording plays the script
        self.live = Lead()  # a live face, which leaves no trace in what can be undone
        self.display: object = None  # how the scene is drawn, see `show`
        self._history = History(self._document(), lambda before, after: after.new_keys(before))

    def move_to(self, scene: Scene) -> None:
        """Go on with another scene that has the same controls; UserError if it has not.

        Script, pose, what can be undone and what is unsaved: all of it stays.
        """
        if scene.name != self.scene.name or not scene.limits.keys() >= self.controls.limits.keys():
            raise UserError(f"this window shows a {self.scene.name}, which has other controls")
        self.script.check(scene.limits)
        self.scene, self.controls = scene, Controls(scene)
        self.values = self.controls.pose(self.values)

    # Controls by hand

    def set(self, name: str, value: float, *, linked: bool = False) -> None:
        """Set a control within its limits, and with `linked` its twin; a script that plays stops.

        While recording, the script goes on and this control is held.
        """
        for each in {name, twin_of(name)} if linked else {name}:
            low, high = self.controls.limits[each]
            self.values[each] = min(max(rounded(value), low), high)
            if self.is_playing and self.is_recording:
                self._held[each] = self.values[each]
        if not self.is_recording:
            self.is_playing = False
        self.pose_is_unsaved, self.is_following = True, False

    def toggle_alone(self, name: str) -> None:
        """This control alone at its most, or neutral if it is so already."""
        pose = self.controls.pose({}) if self.is_alone(name) else self.controls.alone(name)
        self._set_pose(pose, is_unsaved=False)

    def is_alone(self, name: str) -> bool:
        """Whether this control alone is not 0, and at its most."""
        return self.values == self.controls.alone(name)

    def neutral(self) -> None:
        """All controls to zero; the skin swings back by itself."""
        self._set_pose(self.controls.pose({}), is_unsaved=False)

    def mirror(self, source: str = "") -> None:
        """What is left becomes right and the reverse, or one side ("left", "right") the other's."""
        self._set_pose(copied(self.values, source) if source else mirrored(self.values))

    def randomise(self, generator: np.random.Generator | None = None) -> None:
        """A few muscles of each group by chance, both sides alike; layers stay at zero."""
        self._set_pose(self.controls.random(generator or np.random.default_rng()))

    def _set_pose(self, pose: Mapping[str, float], *, is_unsaved: bool = True) -> None:
        self.is_playing = False
        self.values = dict(pose)
        self.pose_is_unsaved, self.is_following = is_unsaved, False
        self.note()

    @property
    def current(self) -> dict[str, float]:
        """Where each control is now: by hand or script, and over it what a live face leads."""
        return self.live.over(self.values, self.controls.limits)

    # Undo

    def _document(self) -> Document:
        by_hand = {name: value for name, value in self.values.items() if value}
        values = None if self.is_following else by_hand
        return Document(values, self.script, self.file, self.display)

    def show(self, display: object) -> None:
        """Draw the scene in another way: what nobody changes any more, and equals its like."""
        state = replace(self._history.present, display=display)  # the script may move the rest
        keep = self._history.amend if self.display is None else self._history.note
        self.display = display
        keep(state)

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
        present, before = self._history.present, self._history.undo()
        if self._document() != present and not before.differs_in_view(present):
            before = present if before is present else self._history.redo()
        self._restore(before, present)

    def redo(self) -> None:
        """Forward again."""
        present = self._history.present
        self._restore(self._history.redo(), present)

    def _restore(self, document: Document, present: Document) -> None:
        self.display = document.display
        if document.differs_in_view(present):
            return
        self.is_playing = False
        self.script, self.file = document.script, document.file
        self.time = min(self.time, self.script.duration)
        if document.values is None:
            self._follow_script()
        else:
            self.values, self.is_following = self.controls.pose(document.values), False
        self.pose_is_unsaved = bool(document.values)

    # Time

    def toggle_playing(self) -> None:
        """Play or pause; at the end of the script, play it again."""
        self.is_playing = not self.is_playing
        if self.is_playing and self.time >= self.script.duration:
            self.time = 0.0
        if self.is_playing and self.time == 0.0:
            self.start_over()

    def toggle_looping(self) -> None:
        """Play the script again and again, or once."""
        self.is_looping = not self.is_looping

    def start_over(self) -> None:
        """The first pose, as if it had been held for a while: each replay begins alike."""
        self.time = 0.0
        self._follow_script()
        self.scene.reset()
        self.scene.pose(self.current)
        if any(self.current.values()):
            self.scene.step(SETTLING)  # as in a film

    def seek(self, time: float) -> None:
        """Go to a time of the script and take its pose."""
        self.time = min(max(time, 0.0), self.script.duration)
        self._follow_script()
        self.pose_is_unsaved = False

    def seek_key(self, direction: int) -> None:
        """Pause at the next time at which the script has a key, or with -1 at the one before."""
        self.is_playing = False
        self.seek(keyframes.time_beyond(self.script, self.time, direction))

    # Keys

    def edit(self, script: Script, *, is_done: bool = True) -> None:
        """Take the script as it was changed; a face that follows it follows the change.

        is_done: the change is complete and can be undone; False while something is dragged.
        """
        if self.is_recording:
            raise UserError("stop the recording first: it takes the place of the script")
        self.script = script
        self.time = min(self.time, script.duration)
        if self.is_following:
            self._follow_script()
        if is_done:
            self.note()

    def set_key(self) -> float:
        """The face as it is becomes a key of the script; its time [s]."""
        time = keyframes.key_time(self.script, self.time)
        self.is_playing = False
        keyed = keyframes.keyed(self.script, time, self.current, self.controls.limits)
        self.edit(keyed, is_done=False)
        self.seek(time)
        self.note()
        return time

    def advance(self, seconds: float, beneath: Mapping[str, float] | None = None) -> None:
        """Let time pass: the script moves the controls, the scene follows them.

        beneath: what else moves the scene, at controls that are 0; no script ever has it.
        """
        if self.is_playing:
            self.time += self.speed * seconds
            if self.time >= self.script.duration:
                self.time = 0.0 if self.is_looping else self.script.duration
                self.is_playing = self.is_looping
            self._follow_script()
        current = self.current
        if self._recorder is not None:
            # Beside a sound a recording has the script's time, to stay in step with what is heard.
            passed = seconds if self.script.sound is None else self.time - self._recorder.time
            self._recorder.add(passed, current)
        self.scene.pose({**current, **(beneath or {})})
        self.scene.step(seconds)

    def _follow_script(self) -> None:
        self.is_following = True
        self.values = self.controls.pose({**self.script.at(self.time), **self._held})

    @property
    def is_recording(self) -> bool:
        """Whether movements are being recorded."""
        return self._recorder is not None

    def toggle_recording(self) -> None:
        """Record the controls from now on, or make what was recorded the script.

        A script with a sound plays meanwhile; while it is paused, or goes through a part again,
        nothing is recorded.
        """
        if self._recorder is None:
            self._recorder, self._held = Recorder(self.script), {}
            if self.script.sound is not None and not self.is_playing:
                self.toggle_playing()
            return
        recording = self._recorder.script()
        self._recorder, self._held = None, {}
        self.is_playing = False
        if recording is None:
            raise UserError("nothing was recorded: no control moved")
        self._replace_script(recording, ScriptFile(None, None), recording.duration)

    @property
    def recording_so_far(self) -> Script | None:
        """What would be the script if the recording was stopped now."""
        return self._recorder.script() if self._recorder is not None else None

    @property
    def recorded_seconds(self) -> float:
        """How long the recording is so far."""
        return self._recorder.time if self._recorder is not None else 0.0

    # Files

    def open(self, script: Script) -> None:
        """A pose to show, which a recording takes in, or a script to play, which ends it."""
        self.is_playing = False
        if is_pose(script):
            self._set_pose(self.controls.pose(script.at(0.0)), is_unsaved=False)
        else:
            self._replace_script(script, ScriptFile.of(script), 0.0)

    def begin_script(self) -> None:
        """An empty script: the neutral face, to which keys can be added."""
        script = Script(
            "",
            NEW_SECONDS,
            "a new script",
            scene=self.script.scene,
            camera=self.script.camera,
            poses=(Pose(0.0),),
        )
        self._replace_script(script, ScriptFile(None, script), 0.0)

    def _replace_script(self, script: Script, file: ScriptFile, time: float) -> None:
        """Another script in place of this one."""
        self._recorder, self._held = None, {}
        self.script, self.file = script, file
        self.seek(time)
        self.note()

    def recover(self, work: Work, when: float) -> None:
        """Go on with unsaved work of another session, as it was at a time [s since 1970]."""
        self.is_playing = False
        if work.script is not None:
            self._replace_script(work.script, ScriptFile.recovered(work.path, when), 0.0)
        if work.recording is not None:
            self._replace_script(work.recording, ScriptFile(None, None), work.recording.duration)
        if work.pose is not None:
            self._set_pose(self.controls.pose(work.pose.at(0.0)))

    def save_script(self, path: Path) -> None:
        """Write the script to a file; UserError where it cannot be written."""
        self.file.save(self.script, path)

    def save_pose(self, path: Path) -> None:
        """Write the controls as they are to a file; UserError where it cannot be written."""
        save_script(path, pose_script(self.current, title=path.stem, scene=self.script.scene))
        self.pose_is_unsaved = False

    @property
    def unsaved(self) -> str:
        """What would be lost by closing, in words; "" for nothing."""
        lost = {
            "the pose": self.has_unsaved_pose,
            "the script": self.script_is_unsaved,
            "the recording": self.is_recording,
        }
        return " and ".join(what for what, is_lost in lost.items() if is_lost)

    @property
    def script_is_unsaved(self) -> bool:
        """Whether the script says what its file does not."""
        return self.file.differs(self.script)

    @property
    def name(self) -> str:
        """What the script is called: by its file, if there is one, else by its title."""
        path = self.file.path
        return path.name if path is not None else self.script.title or "Untitled"

    @property
    def has_unsaved_pose(self) -> bool:
        """Whether there is a pose made by hand that no file has."""
        return self.pose_is_unsaved and any(self.values.values())
