"""When the simulation takes its steps: as real time goes, and none for a face at rest."""

from __future__ import annotations

import numpy as np

from risorius import sim

from ..errors import UserError
from .clock import CALM, STEP, Clock
from .frame_times import FrameTimes
from .session import Session

STILL = 2e-4  # [mm] if no vertex moves further in a step, the face is at rest


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

    def advance(self, seconds: float, *, is_pulled: bool) -> None:
        """As many steps as are due; none for a face at rest that nobody moves.

        is_pulled: whether the mouse drags the skin. UserError where the simulation gave up.
        """
        steps = self._clock.steps(seconds)
        session, scene = self._session, self._session.scene
        wanted = dict(session.values)
        is_driven = session.is_playing or session.is_recording or is_pulled
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
