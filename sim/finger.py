"""A finger that draws at the skin: springs from some vertices to where they are drawn.

Source: own.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from . import checked
from .landmarks import Array
from .state import State

RATE = 350.0  # rad/s of the firmest pull: outdoes the skin, stable at the longest substep
WANTED = "different vertex numbers, shape (n,)"


class Finger:
    """Holds vertices, or none; one belongs to one simulation."""

    def __init__(self) -> None:
        self.let_go()

    def hold(self, vertices: npt.NDArray[np.int64], to: Array, stiffness: Array) -> None:
        """Draw vertices, by their numbers (n,), to places (n, 3) of the standard space."""
        self._vertices, self._to, self._stiffness = vertices, to, stiffness

    def let_go(self) -> None:
        """Hold nothing."""
        self.hold(np.zeros(0, np.int64), np.zeros((0, 3)), np.zeros(0))

    def add(self, state: State) -> None:
        """Add the springs to what holds and pulls the skin."""
        if len(self._vertices):
            drawn = self._to - state.carried[self._vertices]
            state.hold[self._vertices] += self._stiffness
            state.pull[self._vertices] += self._stiffness[:, None] * drawn


def checked_drag(
    vertices: npt.ArrayLike, targets: npt.ArrayLike, firmness: npt.ArrayLike, count: int
) -> tuple[npt.NDArray[np.int64], Array, Array]:
    """What a finger was told, of a mesh with `count` vertices; ValueError where it does not fit."""
    numbers = checked.vertex_numbers("vertices", vertices, (None,), count, WANTED)
    points = checked.numbers("targets", targets, (len(numbers), 3))
    share = checked.numbers("firmness", firmness, (len(numbers),))
    if not ((share >= 0.0) & (share <= 1.0)).all():
        raise ValueError(
            f"firmness: runs from {share.min():g} to {share.max():g}, must be from 0 to 1"
        )
    if len(np.unique(numbers)) < len(numbers):
        raise ValueError(f"vertices: some are there twice, must be {WANTED}")
    return numbers, points, share
