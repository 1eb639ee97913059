"""When the scene is drawn: if it has changed, and while it moves as finely as this machine can.

A scene that stands still, a screenshot and a film are always drawn in full. While something moves,
the detail may only fall, when frames were too slow for some time; it may rise by one level when a
new motion begins, if there was ample time left. So it never swings to and fro.
"""

from __future__ import annotations

from risorius import render

from ..messages import Messages
from ..session.physics import CALM
from .stage import FULL, Stage
from .view import View

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


class Painter:
    """Keeps the picture of the scene up to date, as finely as the machine can."""

    def __init__(self, stage: Stage, view: View, messages: Messages) -> None:
        self._stage, self._view, self._messages = stage, view, messages
        self.level_of_detail = LevelOfDetail(is_software=stage.surface.is_software)
        self._calm_for = 0.0  # [s] that the picture has not changed
        self.forget()

    def forget(self) -> None:
        """What was drawn last is not what should be seen."""
        self._painted: tuple[object, render.Detail] = (None, FULL)

    @property
    def is_complete(self) -> bool:
        """Whether the picture shows the present view, in full detail."""
        return self._painted == (self._view.state, FULL)

    def paint(self, elapsed: float, *, has_moved: bool, is_alive: bool) -> bool:
        """Draw the scene if it has changed, or is not drawn in full yet; whether it changed.

        elapsed: since the last frame [s]. has_moved: whether what is seen of it did. is_alive: it
        only lives, and will move again in a moment: finer pictures in between would flicker.
        """
        surface = self._stage.surface
        surface.area = self._view.viewport
        surface.rules = self._view.divider()
        state = self._view.state
        painted, detail = self._painted
        has_changed = state != painted or has_moved or surface.frame_size != surface.size
        if has_changed and self._calm_for > CALM:
            self.level_of_detail.begin_motion()
        self._calm_for = 0.0 if has_changed else self._calm_for + elapsed
        if has_changed:
            level = self.level_of_detail
            is_unhurried = is_alive and state == painted
            self._draw(level.unhurried if is_unhurried else level.detail, state)
        elif detail != FULL and self._calm_for > CALM and not is_alive:
            self._draw(FULL, state)
        return has_changed

    def _draw(self, detail: render.Detail, state: object) -> None:
        self._messages.attempt(lambda: self._stage.bind(self._view.display))
        self._stage.surface.detail, self._stage.surface.labels = detail, ()
        self._stage.draw(self._view)
        self._painted = state, detail
