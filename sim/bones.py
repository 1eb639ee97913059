"""Where jaw, head and eyeballs are, for the activations reached.

Source: Kähler et al. 2001: the mandible is a rigid part that carries muscles and skin.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .coordinates import FaceSpace
from .landmarks import Array
from .skull import REST, RigidMotion, Skull

Activation = Callable[[str], float]  # of a control, by its name


class Bones:
    """The bones of a face in motion; what did not move is not worked out anew."""

    jaw: tuple[float, float, float] = (0.0, 0.0, 0.0)  # values: open, forward, sideways
    mandible: RigidMotion = REST
    head: RigidMotion = REST

    def __init__(self, skull: Skull, space: FaceSpace) -> None:
        self._skull, self._space = skull, space
        self._head_values = (0.0, 0.0, 0.0)
        self.turn: Array = np.eye(4)  # of the head, for column vectors [head units]

    def follow(self, now: Activation) -> None:
        """Jaw and head go where the controls are now."""
        jaw = now("jaw_open"), now("jaw_forward"), now("jaw_sideways")
        if jaw != self.jaw:
            self.jaw = jaw
            self.mandible = self._skull.mandible_motion(*jaw)
        head = now("head_pitch"), now("head_yaw"), now("head_roll")
        if head != self._head_values:
            self._head_values = head
            self.head = self._skull.head_motion(*head)
            self.turn = np.eye(4) if self.head is REST else self.head.matrix(self._space)

    def gaze(self, now: Activation) -> Array:
        """Where each eyeball looks: to the subject's left and up, -1 to 1, shape (eyes, 2)."""
        sides = [ball.side.value for ball in self._skull.eyeballs]
        ways = ("horizontal", "vertical")
        gaze = [[now(f"gaze_{way}_{side}") for way in ways] for side in sides]
        return np.array(gaze, dtype=np.float64).reshape(-1, 2)

    def transforms(self, now: Activation) -> dict[str, Array]:
        """Motion of each bone from rest to now, name -> (4, 4) for column vectors [head units]."""
        transforms = {
            "neck": np.eye(4),
            "cranium": self.head.matrix(self._space),
            "mandible": self.head.after(self.mandible).matrix(self._space),
        }
        for ball, gaze in zip(self._skull.eyeballs, self.gaze(now), strict=True):
            motion = self._skull.eye_motion(ball, *gaze)
            transforms[f"eye_{ball.side.value}"] = self.head.after(motion).matrix(self._space)
        return transforms

    def pivots(self) -> dict[str, Array]:
        """What each bone turns about at rest, name of `transforms` -> (3,) [head units]."""
        middle = self._skull.condyles.mean(axis=0)
        points = {"cranium": middle + self._skull.head.joint, "mandible": middle}
        points.update({f"eye_{ball.side.value}": ball.centre for ball in self._skull.eyeballs})
        return {name: self._space.to_head(point) for name, point in points.items()}
