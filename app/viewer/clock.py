"""Real time cut into steps of the same length, for physics that no frame rate can upset.

Source: Fiedler 2004, "Fix your timestep!".
"""

from __future__ import annotations

STEP = 1.0 / 120.0  # [s] finer than any screen's frames, so that motion does not judder
MOST_STEPS = 12  # a tenth of a second: what a stalled window catches up


class Clock:
    """Says how many steps are due; what is left over waits for the next time."""

    def __init__(self) -> None:
        self._owed = 0.0

    def steps(self, elapsed: float) -> int:
        """How many steps to take after `elapsed` more seconds; the rest of a stall is forgotten."""
        self._owed += max(elapsed, 0.0)
        due = int(self._owed / STEP + 1e-6)
        if due > MOST_STEPS:
            self._owed = 0.0
            return MOST_STEPS
        self._owed -= due * STEP
        return due
