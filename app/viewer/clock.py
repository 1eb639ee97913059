"""Real time cut into steps of the same length, for physics that no frame rate can upset.

Source: Fiedler 2004, "Fix your timestep!".
"""

from __future__ import annotations

STEP = 1.0 / 60.0  # [s] as in films and tests; the simulation divides it further by itself
CALM = 0.15  # [s] without change before physics rests and the scene is drawn in full
MOST_STEPS = 6  # a tenth of a second: what a stalled window catches up
EARLY = 0.25  # of a step that may be taken before it is due: a screen of 60 Hz that is now a little
# late and now early gets one step for each of its frames, and motion does not judder


class Clock:
    """Says how many steps are due; what is left over waits for the next time."""

    def __init__(self) -> None:
        self._owed = 0.0

    def steps(self, elapsed: float) -> int:
        """How many steps to take after `elapsed` more seconds; the rest of a stall is forgotten."""
        self._owed += max(elapsed, 0.0)
        due = max(int(self._owed / STEP + EARLY), 0)
        if due > MOST_STEPS:
            self._owed = 0.0
            return MOST_STEPS
        self._owed -= due * STEP
        return due
