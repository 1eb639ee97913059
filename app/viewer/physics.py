"""When the simulation takes its steps: as real time goes, and none for a face at rest.

Real time is cut into steps of the same length, which no frame rate can upset. Source: Fiedler 2004,
"Fix your timestep!".
"""

from __future__ import annotations

import numpy as np

from risorius import sim

from ..errors import UserError
from .frame_times import FrameTimes
from .session import Session

STEP = 1.0 / 60.0  # [s] as in films and tests; the simulation divides it further by itself
MOST_STEPS = 6  # a tenth of a second: what a stalled window catches up
EARLY = 0.25  # of a step that may be taken before it is due: a screen of 60 Hz that is now a little
# late and now early gets one step for each of its frames, and motion does not judder
EARLIEST = 0.95  # the same for what a live face has just sent, which must not wait a frame
CALM = 0.15  # [s] without change before physics rests and the scene is drawn in full
STILL = 2e-4  # [mm] if no vertex moves further in a step, the face is at rest


class Clock:
    """Says how many steps are due; what is left over waits for the next time."""

    def __init__(self) -> None:
        self._owed = 0.0

    def steps(self, elapsed: float, early: float = EARLY) -> int:
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
        self._session, self._times = session, times
        self._clock = Clock()
        self.begin_anew()

    def begin_anew(self) -> None:
        """Another scene may be about to move."""
        self.has_stepped = False  # in this frame
        self._posed: dict[str, float] = {}  # the values at the last step
        self._still_for = 0.0  # [s] that no vertex has moved

    @property
    def is_at_rest(self) -> bool:
        """Whether nothing has moved for some time."""
        return self._still_for > CALM

    def advance(self, seconds: float, *, is_skin_dragged: bool, is_urgent: bool = False) -> None:
        """As many steps as are due; none for a face at rest that nobody moves.

        is_skin_dragged: whether the mouse drags the skin. is_urgent: whether a live face has just
        moved. UserError where the simulation gave up.
        """
        steps = self._clock.steps(seconds, EARLIEST if is_urgent else EARLY)
        session, scene = self._session, self._session.scene
        wanted = dict(session.current)
        is_driven = session.is_playing or session.is_recording or is_skin_dragged
        is_driven = is_driven or wanted != self._posed
        self.has_stepped = steps > 0 and (is_driven or not self.is_at_rest)
        if not self.has_stepped:
            return
        self._posed = wanted
        self._times.next_frame()
        before = scene.positions
        with self._times.timed("simulation"):
            try:
                for _ in range(steps):
                    before = scene.positions.copy()
                    session.advance(STEP)
            except sim.SimulationUnstable as error:
                session.neutral()
                scene.reset()
                self._still_for = 0.0
                raise UserError(str(error)) from None
        moved = float(np.abs(scene.positions - before).max(initial=0.0))
        # Muscles follow late: what has not moved yet may still be about to.
        self._still_for = 0.0 if is_driven or moved > STILL else self._still_for + steps * STEP
