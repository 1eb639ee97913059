"""The nose: a smooth union of ridge, side walls, tip, its lobes, wings, soft triangles, columella.

The soft triangles join wing and tip, which would be three balls without them.

The fillet between nose and face must vary: crisp at the wing, wide at the side of the ridge.
"""

import numpy as np

from .fields import (
    Points,
    Values,
    ellipsoid,
    smooth_minimum,
    smooth_step,
    sphere,
    tapered_capsule,
)

NEAR = np.array([[-36.0, -64.0, 70.0], [36.0, 24.0, 140.0]])  # [mm] beyond, no fillet reaches
FAR = 40.0  # [mm]


def distance(points: Points) -> Values:
    """Approximate signed distance to the nose alone [mm], or FAR; shape (n,)."""
    near = ((points > NEAR[0]) & (points < NEAR[1])).all(axis=1)
    result = np.full(len(points), FAR)
    left = np.column_stack([np.abs(points[near, 0]), points[near, 1:]])
    result[near] = _distance(left)
    return result


def _distance(half: Points) -> Values:
    ridge = tapered_capsule(half, (0, 6, 87.4), (0, -20, 101.4), 4.7, 6.0)
    lower_ridge = tapered_capsule(half, (0, -18, 100.4), (0, -31, 108.8), 6.0, 7.2)
    side_wall = tapered_capsule(half, (0, 2, 81.5), (0, -32, 94.0), 7.4, 13.4)
    tip = sphere(half, (0, -35.2, 112.2), 6.6)
    lobe = sphere(half, (3.5, -35.6, 111.2), 5.7)
    wing = ellipsoid(half, (11.8, -37.8, 101.0), (4.9, 6.3, 8.4), turn_deg=24)
    triangle = ellipsoid(half, (8.2, -36.6, 105.8), (3.8, 4.4, 6.2), turn_deg=30)
    columella = tapered_capsule(half, (2.0, -42.4, 101), (1.7, -41.7, 110.4), 2.2, 2.2)

    result = smooth_minimum(ridge, lower_ridge, 6.0)
    result = smooth_minimum(result, side_wall, 12.0)
    result = smooth_minimum(result, tip, 7.0)
    result = smooth_minimum(result, lobe, 5.0)
    wing = smooth_minimum(wing, triangle, 4.5)
    result = smooth_minimum(result, wing, 4.0)
    return smooth_minimum(result, columella, 3.0)


def nostril_dish(points: Points) -> Values:
    """A shallow hollow in the underside where the nostril rows are laid [mm]."""
    half = np.abs(points * [1.0, 0.0, 0.0]) + points * [0.0, 1.0, 1.0]
    return ellipsoid(half, (7.7, -45.9, 106.0), (3.9, 5.4, 6.2), turn_deg=-24)


def fillet(points: Points) -> Values:
    """Width of the fillet between nose and face [mm]."""
    bridge = smooth_step(-40.0, -18.0, points[:, 1])
    root = smooth_step(-8.0, 10.0, points[:, 1])
    middle = np.exp(-((points[:, 0] / 5.0) ** 2))
    return 4.0 + 10.0 * bridge - 4.5 * root + 4.5 * middle * (1.0 - bridge)
