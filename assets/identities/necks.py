"""Even out the necks of persons.

The scans behind the modes end at the neck, and vertices there lie far apart. If the modes move one
of them farther than its neighbours, the neck has a bump or a crease.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import scipy

from ...geometry.arrays import Floats64
from ...geometry.sides import edges_of, side_lengths
from ...geometry.steps import smoothstep
from ..loading import load


def evened_neck(vertices: Floats64) -> Floats64:
    """Smooth how far a person's neck is moved from the built-in head's; vertices [mm], (V, 3)."""
    known = load("head").vertices
    means, shares = _neck()
    moved = vertices - known
    rounds = 12  # in which the motion spreads over about three rows of vertices; chosen by eye
    for _ in range(rounds):
        moved = moved + shares * (means @ moved - moved)
    return np.asarray(known + moved)


@lru_cache(maxsize=1)
def _neck() -> tuple[scipy.sparse.csr_array, Floats64]:
    """Return a matrix of means over neighbours, (V, V), and how much each vertex takes, (V, 1).

    Near neighbours count more, by the reciprocal of the distance.
    """
    head = load("head")
    x = head.vertices
    edges = edges_of(head.faces)
    first, second = edges.T
    near = 1.0 / side_lengths(x, edges)
    rows = np.concatenate([first, second])
    columns = np.concatenate([second, first])
    weights = scipy.sparse.csr_array((np.tile(near, 2), (rows, columns)), (len(x), len(x)))
    means = scipy.sparse.diags_array(1.0 / np.maximum(weights.sum(axis=1), 1e-9)) @ weights
    below = below_jaw(x, x[head.anatomy["menton"]])
    shares = smoothstep(below, 0.0, 25.0) * smoothstep(below, 75.0, 50.0)  # collars fit below
    return means.tocsr(), shares[:, None]


def below_jaw(points: Floats64, chin: Floats64) -> Floats64:
    """Return how far points (n, 3) lie below the lower jaw's edge [mm], (n,); chin: (3,)."""
    jaw_slope = 0.35  # slope of the lower jaw's edge, which rises to the back
    jaw_depth = 20.0  # [mm]; z at which this edge ends
    behind_chin = chin[2] - np.maximum(points[:, 2], jaw_depth)
    return np.asarray(chin[1] - points[:, 1] + jaw_slope * behind_chin)
