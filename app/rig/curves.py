"""Curves of ARKit's shapes over time, by which named shapes follow a simulated face.

Muscles, eyes and head follow their controls with different delays. The shapes of an avatar follow
their weights at once, so their curves are delayed in the same way.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import scipy

from risorius.geometry.arrays import Floats32, Floats64

from ..motion.curves import ARKIT_SHAPES, solved
from ..playback import LEAD
from ..recordings.conversion import lead_of
from ..recordings.names import ARKIT
from ..scenes import Scene


def as_seen(times: Floats64, curves: Mapping[str, Floats64]) -> dict[str, Floats64]:
    """Return values of controls at these times [s], (N,) each, delayed as in the visible face."""
    return {
        name: np.interp(times - lead_of(name, LEAD), times, values)
        for name, values in curves.items()
    }


def shape_curves(
    scene: Scene,
    times: Floats64,
    activations: Mapping[str, Floats64],
    controls: Mapping[str, Floats64],
) -> Floats64:
    """Return the visible amount of each of ARKit's shapes in N frames, in Apple's order, (N, 52).

    activations: sums for controls of the lowest layer, (N,) each. controls: set values of controls,
    (N,) each. Raises UserError for a scene without muscles.
    """
    curves = as_seen(times, solved(scene, ARKIT_SHAPES, activations, controls))
    still = np.zeros(len(times))
    return np.stack([curves.get(name, still) for name in ARKIT], axis=1)


def nearest_weights(targets: Floats32, displacements: Floats64, curves: Floats64) -> Floats64:
    """Return the weights from 0 to 1, (N, K), whose sums of targets are nearest to a motion.

    Many weights give equally near sums. Of these, the weights nearest to the curves are taken, so
    that weights keep the meaning of their names.

    targets: shape (K, V, 3). displacements: of the vertices from rest in each frame, in the same
    unit, shape (N, V, 3). curves: the expected weights, shape (N, K).
    """
    # Importance of the curves, relative to the mean square of a target. With a tenth of it,
    # weights differ from the curves by 0.6; with ten times as much, the fit is a fifth worse.
    trust = 0.03
    rows = targets.reshape(len(targets), -1).astype(np.float64)
    products = rows @ rows.T
    least = trust * np.trace(products) / len(products)
    corner = np.linalg.cholesky(products + least * np.eye(len(products)))
    wanted = displacements.reshape(len(displacements), -1) @ rows.T + least * curves
    reduced = scipy.linalg.solve_triangular(corner, wanted.T, lower=True).T
    found = [scipy.optimize.lsq_linear(corner.T, each, (0.0, 1.0), "bvls").x for each in reduced]
    weights: Floats64 = np.clip(found, 0.0, 1.0)
    return weights
