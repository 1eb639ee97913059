"""From control values to what each muscle feels.

A muscle has its own control; one whose halves usually act together (the lips, procerus) also has
a control for both. They add up. The pull is a power of the activation:

    pull = activation ^ drive_power

because a muscle that contracts by half is also only half as stiff, so that the skin would go less
than half way; with the power, half an activation gives half the motion. One power
does not suit every muscle: the muscle's own `drive` multiplies it.

Source: own; the power was fitted to the motion of skin at half activations.
"""

from __future__ import annotations

import numpy as np

from .controls import Controls
from .landmarks import Array
from .rig import Rig


class MuscleDrive:
    """From control values to the activation and the pull of each muscle."""

    def __init__(self, rig: Rig, names: tuple[str, ...], controls: Controls) -> None:
        self._controls = controls
        halved = {muscle.name for muscle in rig.muscles if muscle.halves}
        self._own = np.array([controls.index(name) for name in names], dtype=np.int64)
        wholes = [name.removesuffix("_left").removesuffix("_right") for name in names]
        drive = {muscle.name: muscle.drive for muscle in rig.muscles}
        self._power = rig.tissue.drive_power * np.array([drive[w] for w in wholes], np.float64)
        self._has_whole = np.array([whole in halved for whole in wholes], dtype=np.bool_)
        self._whole = np.array(
            [controls.index(w if w in halved else n) for w, n in zip(wholes, names, strict=True)],
            dtype=np.int64,
        )

    def activation(self) -> Array:
        """Activation 0..1 of each muscle, shape (M,): its own control plus that of both halves."""
        reached = self._controls.activation
        whole = np.where(self._has_whole, reached[self._whole], 0.0)
        return np.minimum(np.maximum(reached[self._own] + whole, 0.0), 1.0)

    def pull(self, activation: Array) -> Array:
        """What the fibres feel: a power that makes the skin's motion about linear, shape (M,)."""
        return activation**self._power
