"""How finely the scene is drawn while it moves: as finely as this machine can, without flicker.

A scene that stands still, a screenshot and a film are always drawn in full. While something moves,
the detail may only fall, when frames were too slow for some time; it may rise by one level when a
new motion begins, if there was ample time left. So it never swings to and fro.
"""

from __future__ import annotations

from risorius import render

FULL = render.Detail(samples=4, scale=1.0)
# One sample, outlines smoothed by fringes (render/outline.py); then a little blurred, too.
# Two samples would not help: software draws four. Processor time of a whole frame at 1280 x 720,
# as parts of the first: 1, 0.53, 0.47, 0.39 (measured 2026-11-21); with four samples at 0.75: 0.8.
LEVELS = (
    FULL,
    render.Detail(samples=0, scale=1.0),
    render.Detail(samples=0, scale=0.75),
    render.Detail(samples=0, scale=0.6),
)
FIRST_ON_SOFTWARE = 1  # lest the first second stutters
TOO_SLOW = 0.045  # [s] a frame; more than 20 a second are promised
AMPLE = 0.024  # [s] a frame at which the next finer level is safe
PATIENCE = 4  # frames in a row that decide


class LevelOfDetail:
    """Picks a level of detail by the time that frames took."""

    def __init__(self, *, is_software: bool) -> None:
        self.level = FIRST_ON_SOFTWARE if is_software else 0
        self._slow = 0
        self._fast = 0

    @property
    def detail(self) -> render.Detail:
        """For a scene that moves."""
        return LEVELS[self.level]

    @property
    def unhurried(self) -> render.Detail:
        """For a scene that moves a little now and then: not coarser than software begins with."""
        return LEVELS[min(self.level, FIRST_ON_SOFTWARE)]

    def begin_motion(self) -> None:
        """Something begins to move: the one moment at which more detail goes unnoticed."""
        if self._fast >= PATIENCE and self.level > 0:
            self.level -= 1
        self._slow = self._fast = 0

    def note(self, seconds: float) -> None:
        """A frame of a moving scene took so long, all in all."""
        self._slow = self._slow + 1 if seconds > TOO_SLOW else 0
        self._fast = self._fast + 1 if seconds < AMPLE else 0
        if self._slow >= PATIENCE and self.level < len(LEVELS) - 1:
            self.level += 1
            self._slow = 0
