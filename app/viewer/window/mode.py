"""The interface of the window's two modes: the face, and a mesh whose landmarks are marked."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from ..interface.commands import Command
from ..messages import Message, Task
from ..picture.mouse import CameraMouse
from ..picture.stage import Painter, SceneView


class Mode(Protocol):
    """A picture with its panels, commands and mouse; the window shows one at a time."""

    @property
    def name(self) -> str:
        """The name of the user's file."""

    @property
    def unsaved(self) -> str:
        """The unsaved work in words; "" for none."""

    @property
    def view(self) -> SceneView:
        """The camera, and the picture's place in the window."""

    @property
    def painter(self) -> Painter:
        """The object that keeps the picture up to date."""

    @property
    def mouse(self) -> CameraMouse:
        """The object that carries out the mouse's actions in the picture."""

    @property
    def commands(self) -> Sequence[Command]:
        """The commands of menus and keys."""

    @property
    def draws_over_picture(self) -> bool:
        """Whether panels draw over the picture, and so must be drawn after each change of it."""

    @property
    def is_at_rest(self) -> bool:
        """Whether everything is at rest, and stays at rest without an event."""

    @property
    def is_idling(self) -> bool:
        """Whether the face only has idle life."""

    @property
    def has_news(self) -> bool:
        """Whether a panel has news that did not come from the user's input."""

    def paint(self, elapsed: float) -> bool:
        """Let `elapsed` seconds pass, and draw the picture; return whether it has changed."""

    def draw_panels(self) -> None:
        """Draw the panels, and give the picture its place."""

    def rest(self) -> None:
        """Stop the sound while the window sleeps."""

    def drop(self, paths: Sequence[str]) -> Message:
        """Open files that were dropped onto the window."""

    def leave(self, then: Task) -> Message:
        """Run `then`; ask first if unsaved work of this mode would be lost."""
