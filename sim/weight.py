"""Weight and inertia of the soft tissue, for those who ask for them: cheeks follow a nod.

Skin is simulated in coordinates of the cranium. While the head turns, these are accelerated, and
the skin feels it as a load; a tilted head also feels gravity from another side. The rest shape is
how a face hangs upright, so an upright head feels no gravity:

    load = m h [ R^T g - g - R^T P'' r ]      m skin mass, h heaviness, P = (R, shift) head motion

P'' is the second difference of the head motion over the last ticks. Coriolis loads are left out (a
few per cent: skin moves slowly inside the head).

Source: mechanics in accelerated coordinates. `heaviness` stands for the ligaments that carry most
of a cheek's weight and that this model lacks: all of it would make skin sag by 20 mm and more.
"""

from __future__ import annotations

import numpy as np

from .landmarks import Array
from .skull import REST, RigidMotion
from .tissue import AREAL_MASS

GRAVITY = np.array([0.0, -9810.0, 0.0])  # mm/s2 in the standard space


class Weight:
    """The loads of gravity and inertia on a face, tick by tick."""

    def __init__(self, areas: Array, heaviness: float, *, gravity: bool, inertia: bool) -> None:
        self._mass = heaviness * AREAL_MASS * areas
        self.gravity, self._inertia = gravity, inertia
        self.forget()

    def forget(self) -> None:
        """Start again from an upright head that does not move."""
        self._motion = REST
        self._turning, self._moving = np.zeros((3, 3)), np.zeros(3)

    def add(self, motion: RigidMotion, dt: float, x: Array, force: Array) -> None:
        """Add to `force` (V, 3) the load on skin at `x` (V, 3) [mm] of a head at `motion`.

        dt: time since the motion of the last call [s].
        """
        turning = (motion.rotation - self._motion.rotation) / dt
        moving = (motion.shift - self._motion.shift) / dt
        if self._inertia and (turning.any() or self._turning.any()):
            spin = motion.rotation.T @ (turning - self._turning) / dt
            push = motion.rotation.T @ (moving - self._moving) / dt
            force -= self._mass[:, None] * (x @ spin.T + push)
        if self.gravity and motion is not REST:
            force += self._mass[:, None] * (motion.rotation.T @ GRAVITY - GRAVITY)
        self._motion, self._turning, self._moving = motion, turning, moving
