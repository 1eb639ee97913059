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


def distance(points: Points) -> Values:
    """Approximate signed distance to the nose alone [mm], shape (n,)."""
    half = np.abs(points * [1.0, 0.0, 0.0]) + points * [0.0, 1.0, 1.0]
    ridge = tapered_capsule(half, (0, 5, 85.9), (0, -17, 100.6), 5.2, 6.2)
    lower_ridge = tapered_capsule(half, (0, -15, 99.4), (0, -31, 110.6), 6.3, 7.9)
    side_wall = tapered_capsule(half, (0, 4, 79), (0, -31, 90.8), 8.2, 13.0)
    tip = sphere(half, (0, -34.6, 113.6), 7.1)
    lobe = sphere(half, (3.7, -35.6, 113.4), 6.3)
    wing = ellipsoid(half, (10.9, -39.2, 102.0), (5.4, 6.6, 10.3), turn_deg=22)
    triangle = ellipsoid(half, (7.6, -38.6, 108.6), (4.3, 4.7, 6.2), turn_deg=30)
    columella = tapered_capsule(half, (0, -42.2, 101), (0, -41.2, 113.9), 3.0, 3.1)

    result = smooth_minimum(ridge, lower_ridge, 6.0)
    result = smooth_minimum(result, side_wall, 9.0)
    result = smooth_minimum(result, tip, 7.0)
    result = smooth_minimum(result, lobe, 5.0)
    result = smooth_minimum(result, triangle, 5.0)
    result = smooth_minimum(result, wing, 6.0)
    return smooth_minimum(result, columella, 3.0)


def nostril_dish(points: Points) -> Values:
    """A shallow hollow in the underside where the nostril rows are laid [mm]."""
    half = np.abs(points * [1.0, 0.0, 0.0]) + points * [0.0, 1.0, 1.0]
    return ellipsoid(half, (7.3, -47.4, 106.4), (3.5, 3.8, 5.2), turn_deg=-26)


def fillet(points: Points) -> Values:
    """Width of the fillet between nose and face [mm]."""
    bridge = smooth_step(-40.0, -18.0, points[:, 1])
    root = smooth_step(-8.0, 10.0, points[:, 1])
    middle = np.exp(-((points[:, 0] / 5.0) ** 2))
    return 4.0 + 10.0 * bridge - 6.5 * root + 4.5 * middle * (1.0 - bridge)
