"""Wrinkles that come from the physics: how far the simulated skin is shortened, so far it folds.

    simulated mesh ─> refine.Shortening ─> amount at each vertex ─> rows of the refined mesh
                                                                          │
                     assets: map of furrows over the texture ─────────> render

The furrows stick to the skin, because their map does; only the amounts change from frame to frame.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from risorius import refine, render

from .scenes import Scene

Amounts = npt.NDArray[np.float32]

# Chosen by eye. Skin gives way a little before it folds, and a fold does not deepen for ever.
ONSET, HALF = 0.015, 0.09  # loss of length at which furrows begin, and beyond which they are half


class Wrinkling:
    """The wrinkles of a scene that has them."""

    def __init__(self, scene: Scene, renderer: render.Renderer) -> None:
        wrinkles = scene.wrinkles
        assert wrinkles is not None
        self.map = renderer.load_wrinkles(wrinkles.map, wrinkles.steepest)
        self._readiness = np.linalg.norm(wrinkles.across, axis=2)
        self._resting = wrinkles.resting * np.minimum(self._readiness, 1.0)
        self._shortening = refine.Shortening(scene.faces, scene.rest_positions, wrinkles.across)

    def amounts(self, positions: npt.NDArray[np.float64]) -> Amounts:
        """How far each vertex wrinkles in either slot, 0 (not at all) to 1, shape (V, 2).

        It begins and ends without a kink: nothing pops.
        """
        lost = self._readiness * self._shortening.measure(positions)
        beyond = np.square(np.maximum(lost - ONSET, 0.0))
        amounts = beyond / (beyond + (HALF - ONSET) ** 2)
        shown: Amounts = np.maximum(amounts, self._resting).astype(np.float32)
        return shown


def on_rows(amounts: Amounts, refiner: refine.Refiner) -> Amounts | None:
    """The amounts for what `refiner` made last, shape (N, 2); None where nothing wrinkles."""
    if not amounts.any():
        return None
    vertices, weights = refiner.origins()
    corners = [np.take(amounts, vertices[:, i], axis=0) * weights[:, i : i + 1] for i in range(3)]
    rows: Amounts = corners[0] + corners[1] + corners[2]
    return rows


def wrinkling_of(scene: Scene, renderer: render.Renderer) -> Wrinkling | None:
    """Ready the scene's wrinkles for the renderer; None where it has none."""
    return None if scene.wrinkles is None else Wrinkling(scene, renderer)
