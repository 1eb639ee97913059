"""Weight and inertia of the soft tissue, for those who ask for them: cheeks follow a nod.

Skin is simulated in coordinates of the cranium. While the head turns, these are accelerated, and
the skin feels it as a load; a tilted head also feels gravity from another side. The rest shape is
how a face hangs upright, so an upright head feels no gravity:

    load = m h [ R^T g - g - R^T P'' r ]      m skin mass, h heaviness, P = (R, shift) head pose

P'' is the second difference of the head pose over the last ticks. Coriolis loads are left out (a
few per cent: skin moves slowly inside the head).

Source: mechanics in accelerated coordinates. `heaviness` stands for the ligaments that carry most
of a cheek's weight and that this model lacks: all of it would make skin sag by 20 mm and more.
"""

from __future__ import annotations

import numpy as np

from .landmarks import Array
from .skull import REST, Pose
from .tissue import AREAL_MASS

GRAVITY = np.array([0.0, -9810.0, 0.0])  # mm/s2 in the standard space


class Weight:
    """The loads of gravity and inertia on a face, tick by tick."""

    def __init__(self, areas: Array, heaviness: float, *, gravity: bool, inertia: bool) -> None:
        self._mass = heaviness * AREAL_MASS * areas
        self._gravity, self._inertia = gravity, inertia
        self.forget()

    def forget(self) -> None:
        """Start again from an upright head that does not move."""
        self._pose = REST
        self._turning, self._moving = np.zeros((3, 3)), np.zeros(3)

    def add(self, pose: Pose, dt: float, x: Array, force: Array) -> None:
        """Add to `force` (V, 3) the load on skin at `x` (V, 3) [mm] while the head comes to `pose`.

        dt: time since the pose of the last call [s].
        """
        turning = (pose.rotation - self._pose.rotation) / dt
        moving = (pose.shift - self._pose.shift) / dt
        if self._inertia and (turning.any() or self._turning.any()):
            spin = pose.rotation.T @ (turning - self._turning) / dt
            push = pose.rotation.T @ (moving - self._moving) / dt
            force -= self._mass[:, None] * (x @ spin.T + push)
        if self._gravity and pose is not REST:
            force += self._mass[:, None] * (pose.rotation.T @ GRAVITY - GRAVITY)
        self._pose, self._turning, self._moving = pose, turning, moving
