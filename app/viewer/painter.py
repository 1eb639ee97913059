"""When the scene is drawn: if it has changed, with less detail while it moves."""

from __future__ import annotations

from typing import Protocol

from risorius import render

from .level_of_detail import FULL, LevelOfDetail
from .messages import Messages
from .session.physics import CALM
from .settings import Display
from .view import View


class Drawable(Protocol):
    """What can be drawn into the window: a `Stage`, or else."""

    surface: render.WindowSurface

    def bind(self, display: Display) -> None:
        """Get ready for what the user wants to see; UserError where that cannot be."""

    def draw(self, view: View) -> None:
        """Draw it as it is now; the surface's `detail` says how finely."""


class Painter:
    """Keeps the picture of the scene up to date, as finely as the machine can."""

    def __init__(self, stage: Drawable, view: View, messages: Messages) -> None:
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
        surface.area = self._view.drawn
        surface.rules = self._view.divider()
        state = self._view.state
        painted, detail = self._painted
        has_changed = state != painted or has_moved or surface.is_resized
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
