"""The plain head - without nose, lips and lids - as one smooth radius over a capsule.

A direction is measured from a vertical axis up to CROWN, and from the axis' upper end above it, so
that the crown of the head is a dome without a pole in the way. At every height the head is cut as a
superellipse (Lamé's curve): how far it reaches forward, sideways and backward, and how square it
is, are curves over the height. Under the line of the jaw it falls away, onto a neck made likewise.
The numbers are placed by eye toward adult means of well-known distances (see `assets.norms`).
"""

from __future__ import annotations

from functools import cache

import numpy as np
import scipy

from .fields import Points, Values, smooth_maximum, smooth_step

AXIS_Z = 15.0  # [mm] the vertical axis stands here, on x = 0
CROWN = 40.0  # [mm] height of the axis' upper end
REFERENCE = 70.0  # [mm] radius of the capsule on which heights above CROWN are measured
TOP = CROWN + REFERENCE * np.pi / 2
SMOOTHING = 12.0  # chosen: hides the unsteady hand, keeps brow and chin

Table = tuple[tuple[float, float], ...]

# y, z [mm] of the profile in front; in the face below nose and lips
FRONT: Table = (
    (109.0, 15), (107, 34), (101, 51), (91.5, 66), (81, 77.2), (70, 86), (60, 91.4), (50, 94.8),
    (40, 96.8), (33, 97.8), (26, 98.0), (20, 97.6), (15, 96.4), (10, 94.2), (4, 91.2), (-2, 89.2),
    (-10, 89.2), (-18, 90.5), (-26, 92.8), (-34, 96.0), (-40, 98.8), (-46, 101.4), (-52, 103.4),
    (-58, 104.4), (-64, 104.2), (-70, 102.7), (-76, 99.8), (-80, 97.6), (-84, 96.9), (-88, 97.6),
    (-93, 99.2), (-98, 99.9), (-103, 99.0), (-108, 96.6), (-114, 93.5), (-124, 90), (-140, 86),
    (-175, 80),
)  # fmt: skip
# y, x [mm] of the outline beside the axis, hidden by the neck below the angle of the jaw
SIDE: Table = (
    (109.0, 0), (106.5, 24), (101, 39.5), (92, 53.5), (83, 61.8), (72, 68.2), (60, 71.6),
    (50, 72.8), (33, 73.0), (15, 71.6), (0, 71.2), (-14, 71.0), (-26, 70.6), (-40, 70.0),
    (-52, 67.2), (-66, 64.2), (-78, 60.2), (-90, 54.0), (-102, 47.0), (-120, 44.0), (-175, 38),
)  # fmt: skip
# y, z [mm] of the profile behind
BACK: Table = (
    (109.0, 15), (107.0, -18), (100, -46), (86, -68), (64, -85.5), (45, -91.5), (20, -92.5),
    (-12, -88.5), (-40, -79.5), (-75, -67.5), (-100, -63), (-145, -60), (-175, -58),
)  # fmt: skip
# height [mm], exponent of the superellipse: 2 is an ellipse, more is squarer
SQUARENESS: Table = (
    (150, 2.0), (90, 2.02), (50, 2.06), (20, 2.12), (0, 2.13), (-26, 2.13), (-46, 2.05),
    (-66, 1.95), (-85, 1.9), (-110, 1.9), (-175, 2.0),
)  # fmt: skip
# angle [deg], height [mm] of the lower border of the jaw, continued around the back of the head
JAW_LINE: Table = (
    (0, -108), (14, -107), (28, -104.5), (43, -100), (58, -95), (72, -89), (84, -81), (96, -70),
    (110, -60), (130, -62), (180, -75),
)  # fmt: skip
JAW_SLOPE, SLOPE_BEHIND = 2.4, 1.1  # how steeply the face falls away under it
JAW_ROUNDING = 20.0  # [mm]
# y [mm], radius forward, sideways and backward [mm]
NECK = (
    (-60, 50, 46, 77), (-100, 46, 44, 77), (-118, 42.5, 43.5, 76), (-132, 38.5, 44.5, 75.5),
    (-146, 35, 46.5, 75.5), (-160, 34, 49, 76), (-175, 34, 52, 77),
)  # fmt: skip
NECK_FILLET = 11.0  # [mm]


def direction_coordinates(points: Points) -> tuple[Values, Values, Values]:
    """Split points into angle about the axis [rad], height along the capsule [mm], radius [mm]."""
    beside, ahead = points[:, 0], points[:, 2] - AXIS_Z
    above = np.maximum(points[:, 1] - CROWN, 0.0)
    horizontal = np.hypot(beside, ahead)
    angle = np.arctan2(beside, ahead)
    elevation = np.arctan2(above, np.maximum(horizontal, 1e-9))
    height = np.where(points[:, 1] < CROWN, points[:, 1], CROWN + REFERENCE * elevation)
    return angle, height, np.hypot(horizontal, above)


def rays(angle: Values, height: Values) -> tuple[Points, Points]:
    """Axis points and outward unit directions for capsule coordinates, each of shape (n, 3)."""
    elevation = np.maximum(height - CROWN, 0.0) / REFERENCE
    level = np.cos(elevation)
    directions = np.stack([level * np.sin(angle), np.sin(elevation), level * np.cos(angle)], axis=1)
    origins = np.zeros_like(directions)
    origins[:, 1] = np.minimum(height, CROWN)
    origins[:, 2] = AXIS_Z
    return origins, directions


def _curve(heights: Values, values: Values) -> scipy.interpolate.BSpline:
    order = np.argsort(heights)
    return scipy.interpolate.make_smoothing_spline(heights[order], values[order], lam=SMOOTHING)


def _outline(table: Table, axis: int) -> scipy.interpolate.BSpline:
    """The radius over the height along a line in one direction from the axis."""
    points = np.zeros((len(table), 3))
    points[:, 2] = AXIS_Z
    points[:, [1, axis]] = table
    # Mirrored beyond the top, so that the dome is level there.
    _, height, radius = direction_coordinates(points)
    beyond = height < TOP - 1.0
    return _curve(np.r_[height, 2.0 * TOP - height[beyond]], np.r_[radius, radius[beyond]])


@cache
def _curves() -> tuple[scipy.interpolate.BSpline, ...]:
    """Front, side and back of the head, its squareness, the jaw line, and three of the neck."""
    tables = [np.array(table, dtype=np.float64).T for table in (SQUARENESS, JAW_LINE, NECK)]
    squareness, jaw, neck = tables
    around = np.r_[jaw[0], -jaw[0][1:]]  # the line is level in the mid-plane
    return (
        _outline(FRONT, 2),
        _outline(SIDE, 0),
        _outline(BACK, 2),
        _curve(*squareness),
        _curve(around, np.r_[jaw[1], jaw[1][1:]]),
        *(_curve(neck[0], radii) for radii in neck[1:]),
    )


def _superellipse(angle: Values, ahead: Values, beside: Values, power: Values | float) -> Values:
    across, along = np.abs(np.sin(angle)) / beside, np.abs(np.cos(angle)) / ahead
    return np.asarray((across**power + along**power) ** (-1.0 / power), dtype=np.float64)


def base_radius(angle: Values, height: Values) -> Values:
    """Radius of the plain head [mm] over capsule coordinates."""
    return np.asarray(_gridded().ev(np.abs(angle), height), dtype=np.float64)


@cache
def _gridded() -> scipy.interpolate.RectBivariateSpline:
    """The radius sampled on a grid: ten times faster to look up."""
    angles, heights = np.linspace(-0.3, np.pi + 0.3, 181), np.linspace(-175.0, TOP, 326)
    grid = np.meshgrid(angles, heights, indexing="ij")
    samples = _radius(grid[0].ravel(), grid[1].ravel())
    return scipy.interpolate.RectBivariateSpline(angles, heights, samples.reshape(grid[0].shape))


def _radius(angle: Values, height: Values) -> Values:
    front, side, back, squareness, jaw, *neck = _curves()
    is_front = np.abs(angle) < np.pi / 2
    ahead = np.where(is_front, front(height), back(height))
    head = _superellipse(angle, ahead, side(height), squareness(height))
    slope = JAW_SLOPE + (SLOPE_BEHIND - JAW_SLOPE) * smooth_step(0.7, 1.7, np.abs(angle))
    below = slope * np.maximum(jaw(np.degrees(np.abs(angle))) - height, 0.0)
    head = head + JAW_ROUNDING - np.hypot(below, JAW_ROUNDING)
    throat, beside, nape = (curve(np.minimum(height, CROWN)) for curve in neck)
    column = _superellipse(angle, np.where(is_front, throat, nape), beside, 2.0)
    column = column - np.maximum(height + 60.0, 0.0)  # nothing of the neck is in the face
    return smooth_maximum(np.maximum(head, 5.0), column, NECK_FILLET)
