"""When the simulation takes its steps: as real time goes, and none for a face at rest.

Real time is cut into steps of the same length, which no frame rate can upset. Source: Fiedler 2004,
"Fix your timestep!". While nobody moves the face, and somebody may look, it lives by itself: that
adds to controls that are 0, and to no other. No slider moves, nothing is recorded, saved or undone;
that it begins and ends softly is left to the muscles.
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
from ...motion.life import Idle, Values
from .session import Session

STEP = 1.0 / 60.0  # [s] as in films and tests; the simulation divides it further by itself
MOST_STEPS = 6  # a tenth of a second, which a stalled window catches up
# Of a step that may be taken before it is due: a screen of 60 Hz that is now a little late and now
# early gets one step for each of its frames, and motion does not judder.
EARLY_SHARE = 0.25
CALM_SECONDS = 0.15  # [s] without change before physics rests and the scene is drawn in full
PHASES = ("simulation", "refinement", "upload", "draw")  # of the paper's Figure 1

Life = Callable[[float], Mapping[str, float]]  # values to add to controls, so much [s] later


class FrameTimes:
    """Milliseconds of the last frames that were drawn, for the window and benchmarks.

    milliseconds: by phase. whole: of frames with events and panels, up to the frame after.
    steps: of the simulation.
    """

    def __init__(self) -> None:
        self.clear()

    def clear(self) -> None:
        """Forget all frames: those to come are of another scene."""
        kept_frames = 60
        self.milliseconds = {name: deque([0.0], kept_frames) for name in PHASES}
        self.whole = deque([0.0], kept_frames)
        self.steps = deque([0], kept_frames)
        self._is_over = False  # the last frame

    @contextmanager
    def timed(self, phase: str) -> Iterator[None]:
        """Add the time that the block takes to the present frame's."""
        if self._is_over:
            for column in (*self.milliseconds.values(), self.whole):
                column.append(0.0)
            self.steps.append(0)
            self._is_over = False
        start = time.perf_counter()
        yield
        self.milliseconds[phase][-1] += 1e3 * (time.perf_counter() - start)

    def next_frame(self, elapsed: float) -> None:
        """Begin with the next frame, `elapsed` seconds after the last; one without work is none."""
        if not self._is_over:
            self.whole[-1] = 1e3 * elapsed
        self._is_over = True

    def median(self, phase: str) -> float:
        """The median of a phase [ms], of the frames in which it was done; 0 before the first."""
        times = [each for each in self.milliseconds[phase] if each > 0.0]
        return float(np.median(times)) if times else 0.0

    @property
    def frame(self) -> float:
        """The median of whole frames [ms]; 0 before the first."""
        times = [each for each in self.whole if each > 0.0]
        return float(np.median(times)) if times else 0.0


class Clock:
    """Counts the steps that are due; time left over waits for the next call."""

    def __init__(self) -> None:
        self._owed = 0.0

    def steps(self, elapsed: float, early: float = EARLY_SHARE) -> int:
        """How many steps to take after `elapsed` more seconds; the rest of a stall is forgotten.

        early: of a step that may be taken before it is due.
        """
        self._owed += max(elapsed, 0.0)
        due = max(int(self._owed / STEP + early), 0)
        if due > MOST_STEPS:
            self._owed = 0.0
            return MOST_STEPS
        self._owed -= due * STEP
        return due


class Physics:
    """Lets time pass in a session."""

    def __init__(self, session: Session, times: FrameTimes) -> None:
        self._session = session
        self._times = times
        self._clock = Clock()
        self.begin_anew()

    def begin_anew(self) -> None:
        """Begin with another scene, which may move at once."""
        self._times.clear()
        self.has_moved = False  # since the last frame in which it had, as far as one can see
        self._seen = self._session.scene.positions.copy()  # in that frame
        self._seen_bones = self._session.scene.bone_transforms()
        self._left_for = 0.0  # [s] that nobody has moved the face
        self._posed: ControlValues | None = None  # at the last step
        self._still_at = self._seen  # where vertices were when they last moved
        self._still_for = 0.0  # [s] that no vertex has moved from there

    @property
    def is_at_rest(self) -> bool:
        """Whether nothing has moved for some time."""
        return self._still_for > CALM_SECONDS

    @property
    def is_left_alone(self) -> bool:
        """Whether nobody has moved the face for some time, and it does no more than live."""
        left_alone_seconds = 0.5  # [s] after which a face that nobody moved any more only lives
        return self._left_for > left_alone_seconds

    def advance(
        self,
        seconds: float,
        *,
        is_skin_dragged: bool,
        is_urgent: bool = False,
        life: Life | None = None,
    ) -> None:
        """Take the steps that are due; none for a face at rest that neither a user nor life moves.

        is_skin_dragged: whether the mouse drags the skin. is_urgent: whether a live face has just
        moved. UserError if the simulation gave up.
        """
        # The same for a packet of a live face, which must not wait a frame.
        urgent_early_share = 0.95
        steps = self._clock.steps(seconds, urgent_early_share if is_urgent else EARLY_SHARE)
        session = self._session
        scene = self._session.scene
        wanted = session.current
        is_driven = session.is_playing or session.is_recording or is_skin_dragged
        is_driven = is_driven or wanted != self._posed
        self._left_for = 0.0 if is_driven or life is None else self._left_for + steps * STEP
        if is_driven:  # even in a frame too short for a step: the window must not go to sleep
            self._still_for = 0.0
        self.has_moved = False
        if steps == 0 or (life is None and self.is_at_rest):
            return
        self._posed = wanted
        self._step(steps, life)
        # In some poses lips in contact tremble by 0.006 mm, which nobody sees and nothing ends.
        still_distance = 0.01  # [mm]
        moved = float(np.abs(scene.positions - self._still_at).max(initial=0.0))
        # Muscles follow late: a face that has not moved yet may be about to.
        if is_driven or moved > still_distance:
            self._still_at = scene.positions.copy()
            self._still_for = 0.0
        else:
            self._still_for += steps * STEP
        self.has_moved = not self.is_left_alone or self._is_to_be_seen()
        if self.has_moved:
            self._seen = scene.positions.copy()
            self._seen_bones = scene.bone_transforms()

    def _step(self, steps: int, life: Life | None) -> None:
        """Take steps."""
        session = self._session
        scene = self._session.scene
        with self._times.timed("simulation"):
            self._times.steps[-1] += steps
            try:
                for _ in range(steps):
                    session.advance(STEP, life(STEP) if life is not None else {})
            except sim.SimulationUnstable as error:
                session.neutral()
                scene.reset()
                self._still_for = 0.0
                raise UserError(str(error)) from None

    def _is_to_be_seen(self) -> bool:
        """Whether the face has moved enough since it was last seen to move."""
        scene = self._session.scene
        seen_distance = 0.2  # [mm] of motion that is drawn while it only lives: about half a pixel
        if float(np.abs(scene.positions - self._seen).max(initial=0.0)) > seen_distance:
            return True
        turns = (
            float(np.abs(matrix[:3, :3] - self._seen_bones[name][:3, :3]).max())
            for name, matrix in scene.bone_transforms().items()
        )
        eye_radius = 12.0  # [mm] about: of how far a turning eye moves
        return max(turns, default=0.0) * eye_radius > seen_distance


SLEEP_DELAY = 600.0  # [s] without input: the user has gone, and the machine may rest


class IdleLife:
    """The life of the face in a window."""

    def __init__(
        self,
        session: Session,
        is_wanted: Callable[[], bool],
        eye: Callable[[], Floats64],
    ) -> None:
        """is_wanted: whether the user wants it. eye: where the viewer's is, shape (3,) [mm]."""
        self._session = session
        self._is_wanted = is_wanted
        self._eye = eye
        self._idle = Idle(session.scene)
        self._time = 0.0  # of its life [s]
        self._without_input = 0.0  # [s]

    def note_input(self) -> None:
        """Note input: a user is there."""
        self._without_input = 0.0

    @property
    def is_on(self) -> bool:
        """Whether the face lives now.

        A script that is played, recorded or looked through moves it alone, until it has ended, and
        so does a live face, until it is lost.
        """
        session = self._session
        if not self._is_wanted() or session.scene.face is None:
            return False
        is_in_script = session.is_following and session.time < session.script.duration
        is_moved = session.is_playing or session.is_recording or is_in_script
        return not (is_moved or session.live_override.is_on) and self._without_input < SLEEP_DELAY

    def after(self, seconds: float, *, is_held: bool) -> Values:
        """The values to add to the controls, `seconds` later than the last time.

        is_held: the user has hold of something, so that the face does no more than look at him.
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
        return self._idle.beneath(moved, viewer, self._time, is_still=is_held)
