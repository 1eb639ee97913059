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
        """The name of the file that the user works on."""

    @property
    def unsaved(self) -> str:
        """The work that no file has, in words; "" for none."""

    @property
    def view(self) -> SceneView:
        """The camera, and the picture's place in the window."""

    @property
    def painter(self) -> Painter:
        """Keeps the picture up to date."""

    @property
    def mouse(self) -> CameraMouse:
        """Carries out actions of the mouse in the picture."""

    @property
    def commands(self) -> Sequence[Command]:
        """The commands of menus and keys."""

    @property
    def draws_over_picture(self) -> bool:
        """Whether panels draw over the picture, and so change whenever it does."""

    @property
    def is_at_rest(self) -> bool:
        """Whether nothing moves, and nothing is about to."""

    @property
    def is_left_alone(self) -> bool:
        """Whether the face does no more than live."""

    @property
    def has_news(self) -> bool:
        """Whether a panel has something new to show that is no input of the user."""

    def paint(self, elapsed: float) -> bool:
        """Let seconds pass, and draw the picture; returns whether it has changed."""

    def draw_panels(self) -> None:
        """Draw the panels, and give the picture its place."""

    def rest(self) -> None:
        """Make no sound, because the window waits for an event."""

    def drop(self, paths: Sequence[str]) -> Message:
        """Open files that were dropped onto the window."""

    def leave(self, then: Task) -> Message:
        """Run `then`; if work of this mode alone would be lost, ask first."""
