"""Wrinkles from the physics: the more the simulated skin is shortened, the deeper are its folds.

    simulated mesh ─> refine.Shortening ─> amount at each vertex ─> refine: rows ┐
    assets: map of furrows over the texture ─────────────────────────────────────┴> render

The furrows keep their places on the skin, because their map lies over the texture; only the amounts
change from frame to frame.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from risorius import refine
from risorius.geometry.arrays import Floats64
from risorius.geometry.gradients import TextureGradients

from ..scenes import Drawable

WRINKLE_ATTRIBUTE = "wrinkles"  # attributes of refined meshes
GRADIENT_ATTRIBUTE = "texture_gradients"
Amounts = npt.NDArray[np.float32]


class Wrinkling(NamedTuple):
    """Wrinkles of the skin in one frame: amounts, and directions of furrows and of fine shape.

    amounts: depth of furrows in both slots of each vertex, 0 to 1, shape (V, 2); below 0, to -1,
        where skin of a lid is stretched, and its shade is gone.
    gradients: gradients of texture coordinates u and v along the skin [1/mm], shape (U, 6).
    """

    amounts: Amounts
    gradients: Amounts


class Compression:
    """Measures how far a scene's skin is compressed across its wrinkles."""

    def __init__(self, scene: Drawable) -> None:
        wrinkles = scene.skin.wrinkles
        assert wrinkles is not None
        assert scene.skin.uv is not None
        face_uv = scene.faces if scene.skin.face_uv is None else scene.skin.face_uv
        self._gradients = TextureGradients(scene.faces, scene.skin.uv, face_uv)
        self._readiness = np.linalg.norm(wrinkles.across, axis=2)
        whole = np.minimum(self._readiness, 1.0)
        self._resting = wrinkles.resting[:, None] * whole
        self._folds = wrinkles.folds[:, None] * whole
        self._lids = wrinkles.lids[:, None] * whole
        self._has_folds = bool(self._folds.any())
        self._has_fine_shape = scene.skin.fine_shape is not None
        self._shortening = refine.Shortening(scene.faces, scene.rest_positions, wrinkles.across)

    def measure(self, positions: Floats64, strength: float = 1.0) -> Wrinkling | None:
        """Return the wrinkles of the skin at these positions, (V, 3).

        The result is None if there are no wrinkles, and no fine shape, which needs the gradients.
        strength: as in `amounts`.
        """
        amounts = np.zeros((len(positions), 2), np.float32)
        if strength != 0.0 or self._has_folds:
            amounts = self.amounts(positions, strength)
        if not self._has_fine_shape and not amounts.any():
            return None
        return Wrinkling(amounts, self._gradients.measure(positions))

    def amounts(self, positions: Floats64, strength: float = 1.0) -> Amounts:
        """Return the depth of both furrow directions at each vertex, -1 to 1, shape (V, 2).

        `Wrinkles.across` has two directions for each vertex. Depths change smoothly, so furrows do
        not pop up. strength: factor on all furrows except folds, such as those of the lids.
        """
        lost = self._shortening.measure(positions)
        # The numbers were chosen by eye. Skin yields a little before it folds, and the depth of a
        # fold has a limit.
        onset = 0.015  # loss of length at which furrows begin
        beyond = np.square(np.maximum(self._readiness * lost - onset, 0.0))
        half_depth_loss = 0.09  # loss of length at which furrows have half of their greatest depth
        amounts = beyond / (beyond + (half_depth_loss - onset) ** 2)
        # Gain of length at which furrows of age are half as deep, because stretched skin is smooth.
        half_depth_gain = 0.1
        left = 1.0 / (1.0 + np.square(np.minimum(lost, 0.0) / half_depth_gain))
        shown = np.maximum(amounts, self._resting * left)
        if strength != 1.0:
            shown = np.maximum(strength * shown, self._folds * left)
        least_gain = 0.08  # that shows: lids move a little in most poses, and bumps take time
        gained = np.square(np.minimum(lost + least_gain, 0.0))
        half_open_gain = 0.4  # gain of length of a lid that is half shut
        shown -= self._lids * gained / (gained + half_open_gain**2)
        return np.asarray(shown, np.float32)
