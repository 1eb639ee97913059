"""Touches of the skin: impulses, and springs that pull."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..geometry.arrays import Floats64
from . import checked
from .bones import Bones
from .face_model import FaceModel
from .state import State


class Touch:
    """Impulses on the skin of one simulation, and springs that pull it."""

    def __init__(self, model: FaceModel, state: State, positions: Floats64, bones: Bones) -> None:
        """positions: the skin now [head units], shape (V, 3)."""
        self._model = model
        self._state = state
        self._positions = positions
        self._bones = bones
        self.end_drag()

    def kick(self, velocities: npt.ArrayLike) -> None:
        """Add velocities [head units / s], shape (V, 3): an impulse.

        Raises ValueError for another shape, and for values that are not finite.
        """
        added = checked.numbers("velocities", velocities, self._positions.shape)
        self._state.v[:] += self._in_standard_space(added)

    def drag(
        self, vertices: npt.ArrayLike, targets: npt.ArrayLike, firmness: npt.ArrayLike
    ) -> None:
        """Attach vertices to springs until the next `drag` or `end_drag`: a finger pulls the skin.

        vertices: different vertex indices, shape (n,). targets: the point to which each is pulled
        [head units], shape (n, 3). firmness: strength of each spring, 0 (none) .. 1 (holds against
        any muscle), shape (n,). Raises ValueError if these arguments do not fit together.
        """
        wanted = "different vertex indices, shape (n,)"
        count = len(self._positions)
        indices = checked.vertex_indices("vertices", vertices, (None,), count, wanted)
        points = checked.numbers("targets", targets, (len(indices), 3))
        firm = checked.numbers("firmness", firmness, (len(indices),))
        if not ((firm >= 0.0) & (firm <= 1.0)).all():
            raise ValueError(
                f"firmness: runs from {firm.min():g} to {firm.max():g}, must be from 0 to 1"
            )
        if len(np.unique(indices)) < len(indices):
            raise ValueError(f"vertices: some occur twice, must be {wanted}")
        away = self._in_standard_space(points - self._positions[indices])
        self._vertices = indices
        self._to = self._state.x[indices] + away
        # In rad/s, of the firmest pull: stronger than the skin, and stable at the longest substep.
        finger_rate = 350.0
        self._stiffness = firm * self._model.skin.mass[indices] * finger_rate**2

    def end_drag(self) -> None:
        """Remove the springs of `drag`; the skin swings back."""
        self._vertices = np.zeros(0, np.int64)
        self._to = np.zeros((0, 3))
        self._stiffness = np.zeros(0)

    @property
    def is_held(self) -> bool:
        """Whether a finger holds the skin."""
        return len(self._vertices) > 0

    def add_to(self, state: State) -> None:
        """Add the springs to `state.hold` and `state.pull`."""
        if self.is_held:
            drawn = self._to - state.carried[self._vertices]
            state.hold[self._vertices] += self._stiffness
            state.pull[self._vertices] += self._stiffness[:, None] * drawn

    def _in_standard_space(self, vectors: Floats64) -> Floats64:
        """Convert vectors (n, 3) on the turned head to the standard space [mm]."""
        standard = self._model.space.vectors_to_standard(vectors)
        return np.asarray(standard @ self._bones.head.rotation)
