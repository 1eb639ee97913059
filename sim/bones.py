"""The moving bones of one face: controls move the bones, and the bones move the skin."""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import Floats64
from ..geometry.read_only import read_only
from .controls import Controls
from .face_model import FaceModel
from .skull import HEAD_CONTROLS, REST_MOTION


class Bones:
    """Cranium, mandible and eyeballs; only bones that moved are computed again.

    mandible_weight: how far each vertex follows the mandible, 0 to 1, shape (V,); the head has it,
        or it is guessed.
    head_weight: how far each vertex follows the head's pose, 0 to 1, shape (V,); 0 at the base of
        the neck.
    jaw: current values of the jaw: open, forward, sideways. lips_closed: how far lips are now kept
    together over an open jaw, 0 to 1. weight: the mandible's weights for this value of lips_closed,
    shape (V,).
    """

    def __init__(self, model: FaceModel, controls: Controls) -> None:
        self._skull = model.skull
        self._space = model.space
        self.mandible_weight = read_only(model.skull.mandible_weight)
        self._closed_weight = model.closed_weight
        self.head_weight = read_only(model.turns[:, 0])
        sides = [ball.side.value for ball in model.skull.eyeballs]
        names = [f"gaze_{way}_{side}" for side in sides for way in ("horizontal", "vertical")]
        self._controls = controls
        places = controls.places_in_reached
        self._mouth = places(("jaw_open", "jaw_forward", "jaw_sideways", "lips_closed"))
        self._head = places(HEAD_CONTROLS)
        self._gaze = places(names)
        self.jaw = (0.0, 0.0, 0.0)
        self._head_values = [0.0, 0.0, 0.0]
        self.mandible = self.head = REST_MOTION  # seen from the cranium, and from the neck
        self.turn: Floats64 = read_only(np.eye(4))  # of the head, for column vectors [head units]

    def follow(self) -> None:
        """Move jaw, lips and head to the current values of the controls."""
        reached = self._controls.reached
        *values, self.lips_closed = reached[self._mouth].tolist()
        if (jaw := tuple(values)) != self.jaw:
            self.jaw = jaw
            self.mandible = self._skull.mandible_motion(*jaw)
        self.weight = self.mandible_weight
        if self.lips_closed > 0.0:
            closed = self.lips_closed * (self._closed_weight - self.weight)
            self.weight = read_only(self.weight + closed)
        if (head := reached[self._head].tolist()) != self._head_values:
            self._head_values = head
            self.head = self._skull.head_motion(*head)
            turn = np.eye(4) if self.head is REST_MOTION else self.head.matrix(self._space)
            self.turn = read_only(turn)

    def gaze(self) -> Floats64:
        """The direction of each eyeball: to the subject's left and up, -1 to 1, shape (eyes, 2)."""
        return self._controls.reached[self._gaze].reshape(-1, 2)

    def looks(self) -> Floats64:
        """The unit vector along which each eyeball looks, in the standard space, (eyes, 3)."""
        skull = self._skull
        most = np.radians(skull.eyes.gaze_deg)
        factors = np.array([ball.gaze_factor for ball in skull.eyeballs])
        left, up = most * factors * self.gaze().T
        across = np.cos(up)
        return np.stack([np.sin(left) * across, np.sin(up), np.cos(left) * across], axis=1)

    def transforms(self) -> dict[str, Floats64]:
        """Motion of each bone from rest to now, name -> (4, 4) for column vectors [head units]."""
        transforms = {
            "neck": np.eye(4),
            "cranium": self.head.matrix(self._space),
            "mandible": self.head.after(self.mandible).matrix(self._space),
        }
        for ball, gaze in zip(self._skull.eyeballs, self.gaze(), strict=True):
            motion = self._skull.eye_motion(ball, *gaze)
            transforms[f"eye_{ball.side.value}"] = self.head.after(motion).matrix(self._space)
        return transforms

    def pivots(self) -> dict[str, Floats64]:
        """The pivot of each bone at rest, name of `transforms` -> (3,) [head units]."""
        middle = self._skull.condyles.mean(axis=0)
        points = {"cranium": middle + self._skull.head.joint, "mandible": middle}
        points.update({f"eye_{ball.side.value}": ball.centre for ball in self._skull.eyeballs})
        return {name: self._space.to_head(point) for name, point in points.items()}
