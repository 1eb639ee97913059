"""Compute curves of ARKit's shapes over time, with which an avatar follows a simulated face.

Muscles, eyes and head of a simulated face follow their controls with different delays. The shapes
of an avatar follow their weights without delay, so the curves of weights are delayed instead.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import scipy

from risorius.geometry.arrays import Floats32, Floats64

from ..motion.curves import ARKIT_LAYER, solved
from ..playback import LEAD_TIME
from ..recordings.conversion import lead_of
from ..recordings.names import ARKIT_SHAPES
from ..scenes import Scene


def as_seen(times: Floats64, curves: Mapping[str, Floats64]) -> dict[str, Floats64]:
    """Delay curves of controls as the visible face does: name -> values at `times`, (N,).

    times: [s], (N,).
    """
    return {
        name: np.interp(times - lead_of(name, LEAD_TIME), times, values)
        for name, values in curves.items()
    }


def shape_curves(
    scene: Scene,
    times: Floats64,
    activations: Mapping[str, Floats64],
    controls: Mapping[str, Floats64],
) -> Floats64:
    """Return the visible amount of each ARKit shape in N frames, in Apple's order, (N, 52).

    times: [s], (N,).
    activations: control of the lowest layer -> sums in each frame, (N,).
    controls: control -> set values in each frame, (N,).
    Raises UserError for a scene without muscles.
    """
    curves = as_seen(times, solved(scene, ARKIT_LAYER, activations, controls))
    still = np.zeros(len(times))
    return np.stack([curves.get(name, still) for name in ARKIT_SHAPES], axis=1)


def nearest_weights(targets: Floats32, displacements: Floats64, curves: Floats64) -> Floats64:
    """Fit weights, 0 to 1, (N, K), so that sums of targets approximate a motion.

    Different weights may fit equally well. Then those nearest to the curves are taken, so that
    weights keep the meaning of their names.

    targets: displacements by each shape, (K, V, 3). displacements: displacements of the vertices
    from rest in each frame, in the same unit, (N, V, 3). curves: expected weights, (N, K).
    """
    # Weight of the curves, relative to the mean square of a target. With a tenth of this value,
    # weights differ from the curves by 0.6; with ten times this value, the fit is a fifth worse.
    trust = 0.03
    rows = targets.reshape(len(targets), -1).astype(np.float64)
    products = rows @ rows.T
    least = trust * np.trace(products) / len(products)
    corner = np.linalg.cholesky(products + least * np.eye(len(products)))
    frames = displacements.reshape(len(displacements), -1)
    wanted = frames @ rows.T + least * curves
    reduced = scipy.linalg.solve_triangular(corner, wanted.T, lower=True).T
    found = []
    for frame in reduced:
        fit = scipy.optimize.lsq_linear(corner.T, frame, (0.0, 1.0), "bvls")
        found.append(fit.x)
    weights: Floats64 = np.clip(found, 0.0, 1.0)
    return weights
