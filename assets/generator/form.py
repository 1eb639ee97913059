"""The whole face as one implicit surface: plain head, relief, lips, nose and lids."""

from __future__ import annotations

from functools import cache

import numpy as np
import scipy

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
LID_FILLET, LID_FILLET_BELOW = 3.8, 6.5  # [mm] a crease above the eye, a soft bag below
RADIAL_SLOPE = 0.8  # radii are measured along slanted rays; this makes them about distances

# x, y [mm] of the nasolabial fold, from the wing of the nose past the corner of the mouth
FOLD = (
    (15.6, -36.5), (21.4, -40.8), (26.2, -46.6), (29.9, -52.8), (33.0, -59.2), (35.1, -65.8),
    (35.8, -72.6), (35.0, -79.4),
)  # fmt: skip
FOLD_DEPTH = (0.3, 0.8, 1.0, 1.0, 0.8, 0.5, 0.3, 0.1)  # along it, as a share
# The sternomastoid, from behind the jaw down to the pit of the throat: height [mm], angle [deg].
NECK_MUSCLE = ((-170, 24), (-156, 33), (-140, 47), (-122, 66), (-104, 84), (-86, 96), (-70, 103))
STRIP = 12.4  # [mm] half of what a vertex of the neck stands for: edges have 15 to 32 mm there
RELIEF_BEHIND, RELIEF_IN_FRONT = 40.0, 56.0  # [mm] z: small forms are drawn on the face alone
FOLD_SIDE = tuple((x + 8.5, y - 1.0) for x, y in FOLD)

Stroke = tuple[float, tuple[tuple[float, float, float], ...]]

# Strokes in the front view, laid over the plain head: half width [mm]; x, y, height [mm] along it.
IN_FRONT: tuple[Stroke, ...] = (
    (11.5, ((17, 1, -5.8), (37, 1, -4.6))),  # the orbit
    (6.5, ((14.8, 4, -2.4), (17.5, 8, -1.0))),  # its inner hollow
    (7.5, ((6, 17, 0.4), (17, 19, 1.5), (32, 20, 1.7), (45, 17, 1.5), (53, 9, 1.0))),  # brow
    (4.6, ((28, 14.5, 0.4), (38, 13, 1.5), (45.5, 9, 1.2))),  # fullness over the outer lid
    (14.0, ((30, -27, 1.5), (45, -28, 2.2))),  # cheek
    (3.6, ((16, -10, -0.2), (23, -15, -0.4), (31, -18, -0.2))),  # below the lower lid
    (3.0, tuple((x - 0.5, y, -0.55 * w) for (x, y), w in zip(FOLD, FOLD_DEPTH, strict=True))),
    (7.0, tuple((x, y, 1.0 * w) for (x, y), w in zip(FOLD_SIDE, FOLD_DEPTH, strict=True))),
    (3.2, ((0, -48.5, -0.7), (0, -58.0, -0.9))),  # philtrum
    (2.6, ((4.2, -49, 0.1), (5.4, -58, 0.4))),  # its ridges
    (7.0, ((0, -99, 0.4), (9, -99, 0.5))),  # chin
    (3.4, ((0, -84.5, -0.6), (13, -83, -0.6))),  # below the lower lip
    (5.5, ((28.6, -66.6, -1.0),)),  # corner of the mouth
)
# Strokes on the side: half width [mm]; angle about the axis [deg], height along it, height [mm].
BESIDE: tuple[Stroke, ...] = (
    (11.0, ((34, -23, 1.0), (48, -20, 2.6), (62, -17, 2.2), (76, -15, 0.3))),  # cheekbone
    (18.0, ((48, -54, -1.0), (64, -55, -1.5))),  # hollow below
    (13.0, ((56, 20, -1.8), (74, 22, -2.2))),  # temple
)
ARC = 1.3  # [mm] of the surface per degree


@cache
def _relief() -> tuple[
    scipy.interpolate.RectBivariateSpline, scipy.interpolate.RectBivariateSpline
]:
    """What the strokes add in front and beside [mm], sampled on grids: quicker to look up."""
    return _drawn(IN_FRONT, 90.0, 1.0), _drawn(BESIDE, 180.0, ARC)


def _drawn(
    table: tuple[Stroke, ...], farthest: float, scale: float
) -> scipy.interpolate.RectBivariateSpline:
    """The strokes of a table up to `farthest` across; scale: [mm] for each unit across."""
    across, up = np.arange(-6.0, farthest + 6.0), np.arange(-180.0, 160.0)
    grid = np.meshgrid(across, up, indexing="ij")
    samples = _strokes(table, scale, grid[0].ravel(), grid[1].ravel())
    return scipy.interpolate.RectBivariateSpline(across, up, samples.reshape(grid[0].shape))


def _strokes(table: tuple[Stroke, ...], scale: float, across: Values, up: Values) -> Values:
    """All strokes of a table at places on their plane [mm]: bells of even spacing along lines."""
    total = np.zeros_like(across)
    for width, line in table:
        x, y, height = np.array(line, dtype=np.float64).T
        x = scale * x
        length = np.r_[0.0, np.cumsum(np.hypot(np.diff(x), np.diff(y)))]
        count = max(1, round(1.6 * length[-1] / width) + 1)
        along = np.linspace(0.0, length[-1], count)
        spacing = length[-1] / max(count - 1, 1)
        share = spacing / (width * np.sqrt(np.pi)) if count > 1 else 1.0
        for a, b, h in zip(*(np.interp(along, length, v) for v in (x, y, height)), strict=True):
            total += share * h * np.exp(-((scale * across - a) ** 2 + (up - b) ** 2) / width**2)
    return total


def neck_relief(angle: Values, height: Values, radius: Values, strip: float = 0.0) -> Values:
    """The muscle that turns the head, the hollow in front of it, and the larynx [mm].

    strip: half the width [mm] over which all that is averaged.
    """

    def across(values: Values, centre: float, width: float) -> Values:
        """A bell, as wide as it is and averaged over the strip."""
        wide = float(np.hypot(width, strip))
        return width / wide * bump(values, centre, wide)

    heights, degrees = np.array(NECK_MUSCLE).T
    behind = radius * (np.abs(angle) - np.radians(np.interp(height, heights, degrees)))
    from_middle = radius * np.abs(angle)
    muscle = 3.4 * across(behind, 0.0, 9.5) - 1.4 * across(behind, -14.0, 10.0)
    larynx = bump(height, -143.0, 8.0) + 0.6 * smooth_step(-143.0, -152.0, height)
    throat = 1.8 * larynx * across(from_middle, 0.0, 8.0) * smooth_step(-128.0, -140.0, height)
    along = smooth_step(-84.0, -112.0, height) * smooth_step(-166.0, -138.0, height)
    return muscle * along + throat


def head_distance(points: Points, strip: float = 0.0) -> Values:
    """Plain head with relief and lips, without nose and lids [mm], shape (n,)."""
    angle, height, radius = direction_coordinates(points)
    x, y = np.abs(points[:, 0]), points[:, 1]
    surface = base_radius(angle, height)
    front, beside = _relief()
    in_front = smooth_step(RELIEF_BEHIND, RELIEF_IN_FRONT, points[:, 2])
    surface = surface + in_front * (front.ev(x, y) + lips.displacement(x, y))
    surface = surface + beside.ev(np.degrees(np.abs(angle)), height)
    surface = surface + neck_relief(angle, height, surface, strip)
    result: Values = (radius - surface) * RADIAL_SLOPE
    return result


def lid_distance(points: Points) -> Values:
    """The skin over the eyeball, as if closed [mm], shape (n,)."""
    half = np.abs(points * [1.0, 0.0, 0.0]) + points * [0.0, 1.0, 1.0]
    centre = (float(EYE_CENTRE[0]), float(EYE_CENTRE[1]), float(EYE_CENTRE[2]))
    return ellipsoid(half, centre, LID_RADII)


def distance(points: Points, strip: float = 0.0) -> Values:
    """The whole face [mm], negative inside, shape (n,)."""
    head = head_distance(points, strip)
    result = smooth_minimum(head, nose.distance(points), nose.fillet(points))
    below = smooth_step(-5.0, -11.0, points[:, 1])
    fillet = LID_FILLET + (LID_FILLET_BELOW - LID_FILLET) * below
    result = smooth_minimum(result, lid_distance(points), fillet)
    return smooth_maximum(result, -nose.nostril_dish(points), 2.5)


def broad_distance(points: Points) -> Values:
    """The whole face with what a coarse neck can show: a cord that a single vertex meets is a knob.

    The mesh is laid out on the form as it is, and lifted onto this one.
    """
    return distance(points, STRIP)


def broadened(points: Points) -> Points:
    """Points of the form, lifted as far as the broad one is from it, shape (n, 3)."""
    lift = (head_distance(points) - head_distance(points, STRIP)) / RADIAL_SLOPE
    angle, height, _ = direction_coordinates(points)
    return points + lift[:, None] * rays(angle, height)[1]


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
    origins = np.stack([x, np.full_like(x, -48.5), z], axis=1)
    return cast(distance, origins, np.tile([0.0, 1.0, 0.0], (len(x), 1)), reach=20.0, step=0.5)


def fold_side(heights: Values) -> tuple[Values, Values]:
    """The nasolabial fold's distance from the middle at heights [mm], and its slope, (n,) each.

    Without a corner: furrows that followed one would show it. Beyond its ends it goes straight on.
    """
    sides, known = np.array(FOLD[::-1]).T
    course = scipy.interpolate.CubicSpline(known, sides)
    within = np.clip(heights, known[0], known[-1])
    slopes = course(within, 1)
    return course(within) + slopes * (heights - within), slopes
