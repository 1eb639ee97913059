"""Steps of the simulation in real time; a face at rest takes no steps.

Real time is cut into steps of equal length, independent of the frame rate. Source: Fiedler 2004,
"Fix your timestep!". While nobody moves the face, it has idle life, which only adds to controls
that are 0. Idle life moves no slider, and is not recorded, saved or undone. It begins and ends
softly, because muscles respond slowly.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager

import numpy as np

from risorius import sim
from risorius.geometry.arrays import Floats64

from ...control_names.limits import ControlValues
from ...errors import UserError
from ...motion import opening_of_jaw
from ...motion.life import Idle, IdleValues
from .session import Session

STEP_TIME = 1.0 / 60.0  # [s], as in films and tests; the simulation divides it further
MOST_STEPS_PER_FRAME = 6  # in one frame: after a stall, the window catches up a tenth of a second
# A step may be taken early by this share of its length: frames of a 60 Hz screen that are slightly
# late or early then get one step each, so motion does not stutter.
EARLY_FRACTION = 0.25
CALM_SECONDS = 0.15  # [s] without change until physics rests, and the scene has full detail
PHASE_NAMES = ("simulation", "refinement", "upload", "draw")  # of the paper's Figure 1

LifeValues = Callable[[float], Mapping[str, float]]  # seconds -> values to add to controls


class FrameTimes:
    """Milliseconds of the last frames that were drawn, for the window and benchmarks.

    milliseconds: times by phase. whole: times from the beginning of a frame to the next frame, with
        events and panels.
    steps: numbers of simulation steps.
    """

    def __init__(self) -> None:
        self.clear()

    def clear(self) -> None:
        """Forget all frames: the next ones show another scene."""
        kept_frames = 60
        self.milliseconds = {name: deque([0.0], kept_frames) for name in PHASE_NAMES}
        self.whole = deque([0.0], kept_frames)
        self.steps = deque([0], kept_frames)
        self._is_over = False  # whether the last frame is complete

    @contextmanager
    def timed(self, phase: str) -> Iterator[None]:
        """Measure the block, and add its time to a phase of the current frame."""
        if self._is_over:
            for column in (*self.milliseconds.values(), self.whole):
                column.append(0.0)
            self.steps.append(0)
            self._is_over = False
        start = time.perf_counter()
        yield
        self.milliseconds[phase][-1] += 1e3 * (time.perf_counter() - start)

    def next_frame(self, elapsed: float) -> None:
        """Begin the next frame, `elapsed` seconds after the last; idle frames are not counted."""
        if not self._is_over:
            self.whole[-1] = 1e3 * elapsed
        self._is_over = True

    def median(self, phase: str) -> float:
        """Return the median of a phase [ms] over the frames with this phase; 0 before the first."""
        times = [each for each in self.milliseconds[phase] if each > 0.0]
        return float(np.median(times)) if times else 0.0

    @property
    def frame(self) -> float:
        """The median of whole frames [ms]; 0 before the first."""
        times = [each for each in self.whole if each > 0.0]
        return float(np.median(times)) if times else 0.0


class Clock:
    """Counts the steps that are due; the remaining time counts in the next call."""

    def __init__(self) -> None:
        self._owed = 0.0

    def steps(self, elapsed: float, early: float = EARLY_FRACTION) -> int:
        """Number of due steps after `elapsed` more seconds, MOST_STEPS_PER_FRAME at most.

        early: fraction of its length by which a step may be taken early.
        """
        self._owed += max(elapsed, 0.0)
        due = max(int(self._owed / STEP_TIME + early), 0)
        if due > MOST_STEPS_PER_FRAME:
            self._owed = 0.0
            return MOST_STEPS_PER_FRAME
        self._owed -= due * STEP_TIME
        return due


class Physics:
    """Advances the scene of a session in time."""

    def __init__(self, session: Session, times: FrameTimes) -> None:
        self._session = session
        self._times = times
        self._clock = Clock()
        self.begin_anew()

    def begin_anew(self) -> None:
        """Begin again with another scene, which may move at once."""
        self._times.clear()
        self.has_moved = False  # whether the face moved visibly since `_seen`
        self._seen = self._session.scene.positions.copy()  # vertices at the last visible motion
        self._seen_bones = self._session.scene.bone_transforms()
        self._left_for = 0.0  # [s] without a user's motion of the face
        self._posed: ControlValues | None = None  # values at the last step
        self._still_at = self._seen  # vertices at their last motion
        self._still_for = 0.0  # [s] without motion since then

    @property
    def is_at_rest(self) -> bool:
        """Whether the face has rested for some time."""
        return self._still_for > CALM_SECONDS

    @property
    def is_idling(self) -> bool:
        """Whether nobody has moved the face for some time, and it only has idle life."""
        left_alone_seconds = 0.5  # [s] without a user's motion until only idle life is left
        return self._left_for > left_alone_seconds

    def advance(
        self,
        seconds: float,
        *,
        is_skin_dragged: bool,
        is_urgent: bool = False,
        life: LifeValues | None = None,
    ) -> None:
        """Take the due steps; take none if the face rests, and neither user nor idle life moves it.

        is_skin_dragged: whether the mouse drags the skin. is_urgent: whether a live face has just
        moved. Raises UserError if the simulation failed.
        """
        # EARLY_FRACTION after a packet of a live face, which must not wait for the next frame.
        urgent_early_fraction = 0.95
        steps = self._clock.steps(seconds, urgent_early_fraction if is_urgent else EARLY_FRACTION)
        session = self._session
        scene = self._session.scene
        wanted = session.current
        is_driven = session.is_playing or session.is_recording or is_skin_dragged
        is_driven = is_driven or wanted != self._posed
        self._left_for = 0.0 if is_driven or life is None else self._left_for + steps * STEP_TIME
        if is_driven:  # even in a frame without a step, because the window must stay awake
            self._still_for = 0.0
        self.has_moved = False
        if steps == 0 or (life is None and self.is_at_rest):
            return
        self._posed = wanted
        self._step(steps, life)
        # In some poses touching lips tremble forever by an invisible 0.006 mm.
        still_distance = 0.01  # [mm]
        moved = float(np.abs(scene.positions - self._still_at).max(initial=0.0))
        # Muscles follow late: a face that has not moved yet may move soon.
        if is_driven or moved > still_distance:
            self._still_at = scene.positions.copy()
            self._still_for = 0.0
        else:
            self._still_for += steps * STEP_TIME
        self.has_moved = not self.is_idling or self._is_to_be_seen()
        if self.has_moved:
            self._seen = scene.positions.copy()
            self._seen_bones = scene.bone_transforms()

    def _step(self, steps: int, life: LifeValues | None) -> None:
        """Take steps; raises UserError if the simulation fails."""
        session = self._session
        scene = self._session.scene
        with self._times.timed("simulation"):
            self._times.steps[-1] += steps
            try:
                for _ in range(steps):
                    session.advance(STEP_TIME, life(STEP_TIME) if life is not None else {})
            except sim.SimulationUnstable as error:
                session.neutral()
                scene.reset()
                self._still_for = 0.0
                raise UserError(str(error)) from None

    def _is_to_be_seen(self) -> bool:
        """Whether the face has moved visibly since its last visible motion."""
        scene = self._session.scene
        seen_distance = 0.2  # [mm] of motion, about half a pixel
        if float(np.abs(scene.positions - self._seen).max(initial=0.0)) > seen_distance:
            return True
        turns = (
            float(np.abs(matrix[:3, :3] - self._seen_bones[name][:3, :3]).max())
            for name, matrix in scene.bone_transforms().items()
        )
        eye_radius = 12.0  # [mm], to convert turns of an eye into motion
        return max(turns, default=0.0) * eye_radius > seen_distance


SLEEP_DELAY = 600.0  # [s] without input: the user has left, and the machine may rest


class IdleLife:
    """Gives idle life to the face in a window."""

    def __init__(
        self,
        session: Session,
        is_wanted: Callable[[], bool],
        eye: Callable[[], Floats64],
    ) -> None:
        """is_wanted: whether the user wants idle life. eye: the viewer's place, shape (3,) [mm]."""
        self._session = session
        self._is_wanted = is_wanted
        self._eye = eye
        self._idle = Idle(session.scene)
        self._time = 0.0  # of idle life [s]
        self._without_input = 0.0  # [s]

    def note_input(self) -> None:
        """Note input: a user is there."""
        self._without_input = 0.0

    @property
    def is_on(self) -> bool:
        """Whether the face has idle life now.

        It has none while a live face moves it, while a script is recorded, and while it shows a
        script before its end, unless a script with `alive = true` is playing.
        """
        session = self._session
        if not self._is_wanted() or session.scene.face is None:
            return False
        is_in_script = session.is_following and session.time < session.script.duration
        is_in_script = is_in_script or session.is_playing
        lives = session.script.alive and session.is_playing
        is_moved = session.is_recording or (is_in_script and not lives)
        return not (is_moved or session.live_override.is_on) and self._without_input < SLEEP_DELAY

    def after(self, seconds: float, *, is_held: bool) -> IdleValues:
        """Return the values to add to the controls, `seconds` after the last call.

        is_held: whether the user holds something, so that the face only looks at the user.
        """
        if not self.is_on:
            return {}
        if self._idle.scene is not self._session.scene:
            self._idle = Idle(self._session.scene)
        self._time += seconds
        self._without_input += seconds
        viewer = self._eye()
        session = self._session
        moved = session.controls.moved_by(session.values)
        opening = 0.0
        if session.is_playing:  # a script does not share its controls, even where they are 0
            moved = moved.union(*map(session.scene.moved_by, session.script.names))
            opening = opening_of_jaw(session.scene, session.current)
        return self._idle.amounts(moved, viewer, self._time, is_still=is_held, opening=opening)
