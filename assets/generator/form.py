"""The whole face as one implicit surface: plain head, relief, lips, nose and lids."""

import numpy as np

from . import lips, nose
from .fields import (
    Points,
    Values,
    bump,
    cast,
    ellipsoid,
    smooth_maximum,
    smooth_minimum,
    smooth_step,
)
from .sections import base_radius, direction_coordinates, rays

EYE_CENTRE = np.array([31.2, 0.2, 70.8])  # [mm] the left eye
EYE_RADIUS = 13.0  # [mm] 1 mm above anatomy: fills the fissure between the lids
LID_RADII = (15.2, 14.7, 15.1)  # [mm] the lids are an ellipsoid around the eyeball
LID_FILLET = 3.8  # [mm]
RADIAL_SLOPE = 0.8  # radii are measured along slanted rays; this makes them about distances

# x, y [mm] of the nasolabial fold, from the wing of the nose past the corner of the mouth
FOLD = (
    (15.6, -36.5), (21.4, -40.8), (26.2, -46.6), (29.9, -52.8), (33.0, -59.2), (35.1, -65.8),
    (35.8, -72.6), (35.0, -79.4),
)  # fmt: skip
# The sternomastoid, from behind the jaw down to the pit of the throat: height [mm], angle [deg].
NECK_MUSCLE = ((-170, 24), (-156, 33), (-140, 47), (-122, 66), (-104, 84), (-86, 96), (-70, 103))
RELIEF_BEHIND, RELIEF_IN_FRONT = 40.0, 56.0  # [mm] z: small forms are drawn on the face alone


def relief(x: Values, y: Values) -> Values:
    """Small forms of 0.5 to 1.3 mm on the plain head; x is the distance from the mid-plane."""
    philtrum_part = np.exp(-(((y + 52.0) / 5.5) ** 4))
    philtrum = philtrum_part * (-0.9 * bump(x, 0.0, 2.2) + 0.6 * bump(x, 4.2, 1.7))

    sides, heights = np.array(FOLD[::-1]).T
    beside = x - np.interp(y, heights, sides)
    fold_part = np.exp(-(((y + 54.0) / 18.0) ** 4))
    fold = fold_part * (-0.7 * bump(beside, -0.5, 3.0) + 1.1 * bump(beside, 8.0, 7.0))

    brow = 0.6 * bump(x, 38.0, 12.0) * bump(y, 21.0, 5.5)
    lid_fold = 1.1 * bump(x, 37.0, 11.0) * bump(y, 13.0, 3.6)
    cheek = 2.5 * bump(x, 42.0, 13.0) * bump(y, -22.0, 11.0)
    hollows = -1.5 * bump(x, 47.0, 9.0) * bump(y, -58.0, 13.0)
    hollows -= 1.2 * bump(x, 60.0, 8.0) * bump(y, 22.0, 14.0)
    chin = 0.6 * bump(x, 7.0, 7.0) * bump(y, -100.0, 8.0)
    corner = -1.1 * bump(x, 27.3, 3.4) * bump(y, -66.3, 3.6)
    corner += 0.9 * bump(x, 32.5, 4.6) * bump(y, -68.5, 9.0)
    return philtrum + fold + brow + lid_fold + cheek + hollows + chin + corner


def neck_relief(angle: Values, height: Values, radius: Values) -> Values:
    """The muscle that turns the head, the hollow in front of it, and the larynx [mm]."""
    heights, degrees = np.array(NECK_MUSCLE).T
    behind = radius * (np.abs(angle) - np.radians(np.interp(height, heights, degrees)))
    from_middle = radius * np.abs(angle)
    muscle = 4.4 * bump(behind, 0.0, 8.5) - 2.0 * bump(behind, -14.0, 9.0)
    larynx = bump(height, -143.0, 8.0) + 0.6 * smooth_step(-143.0, -152.0, height)
    throat = 4.0 * larynx * bump(from_middle, 0.0, 8.0) * smooth_step(-128.0, -140.0, height)
    along = smooth_step(-84.0, -112.0, height) * smooth_step(-166.0, -138.0, height)
    return muscle * along + throat


def head_distance(points: Points) -> Values:
    """Plain head with relief and lips, without nose and lids [mm], shape (n,)."""
    angle, height, radius = direction_coordinates(points)
    x, y = np.abs(points[:, 0]), points[:, 1]
    surface = base_radius(angle, height)
    in_front = smooth_step(RELIEF_BEHIND, RELIEF_IN_FRONT, points[:, 2])
    surface = surface + in_front * (relief(x, y) + lips.displacement(x, y))
    surface = surface + neck_relief(angle, height, surface)
    return (radius - surface) * RADIAL_SLOPE


def lid_distance(points: Points) -> Values:
    """The skin over the eyeball, as if closed [mm], shape (n,)."""
    half = np.abs(points * [1.0, 0.0, 0.0]) + points * [0.0, 1.0, 1.0]
    centre = (float(EYE_CENTRE[0]), float(EYE_CENTRE[1]), float(EYE_CENTRE[2]))
    return ellipsoid(half, centre, LID_RADII)


def distance(points: Points) -> Values:
    """The whole face [mm], negative inside, shape (n,)."""
    result = smooth_minimum(head_distance(points), nose.distance(points), nose.fillet(points))
    result = smooth_minimum(result, lid_distance(points), LID_FILLET)
    return smooth_maximum(result, -nose.nostril_dish(points), 2.5)


def from_axis(angle: Values, height: Values) -> Points:
    """Where rays from outside toward the head's axis meet the face, shape (n, 3)."""
    origins, directions = rays(angle, height)
    outside = base_radius(angle, height) + 36.0
    return cast(distance, origins + outside[:, None] * directions, -directions, reach=50.0)


def from_front(x: Values, y: Values) -> Points:
    """Where rays along -z meet the face, shape (n, 3)."""
    origins = np.stack([x, y, np.full_like(x, 130.0)], axis=1)
    return cast(distance, origins, np.tile([0.0, 0.0, -1.0], (len(x), 1)), reach=100.0)


def from_below(x: Values, z: Values) -> Points:
    """Where rays along +y meet the underside of the nose, shape (n, 3)."""
    origins = np.stack([x, np.full_like(x, -54.0), z], axis=1)
    return cast(distance, origins, np.tile([0.0, 1.0, 0.0], (len(x), 1)), reach=26.0, step=0.5)
