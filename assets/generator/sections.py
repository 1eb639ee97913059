"""The plain head - without nose, lips and lids - as one smooth radius over a capsule.

Half of the head is given as horizontal sections: at height y, points (x, z) from the mid-plane to
the side. A thin-plate spline through them gives the radius for every direction; the direction is
measured from a vertical axis up to CROWN, and from the axis' upper end above it, so that the crown
of the head is a dome without a pole in the way.
The numbers are placed by eye toward adult means of well-known distances (see `assets.report`).
"""

from functools import cache

import numpy as np
import numpy.typing as npt
from scipy.interpolate import RBFInterpolator, RectBivariateSpline

from .fields import Points, Values

AXIS_Z = 15.0  # [mm] the vertical axis stands here, on x = 0
CROWN = 40.0  # [mm] height of the axis' upper end
REFERENCE = 70.0  # [mm] radius of the capsule on which the spline lives
SMOOTHING = 4.0  # chosen: hides +-0.3 mm of unsteady hand, keeps the brow

SECTIONS: tuple[tuple[float, tuple[tuple[float, float], ...]], ...] = (
    (117.5, ((0, 4),)),
    (114.5, ((0, 33), (14, 28), (23, 13), (25.5, -1), (24, -22))),
    (108, ((0, 52), (17, 48), (30, 35), (38.5, 17), (41.5, -2), (40, -22))),
    (96, ((0, 70.5), (20, 67), (36, 56.5), (47.5, 40), (54.5, 21), (57.5, 2), (57, -20))),
    (86, ((0, 80.7), (20, 77.7), (37.5, 67.5), (51, 49.5), (59.5, 28), (64, 5), (64, -18))),
    (72, ((0, 89.6), (20, 87), (38.5, 77), (52.5, 60), (61.8, 39), (68, 14), (69.5, -12))),
    (50, ((0, 97), (20, 95), (38.5, 86.5), (52, 70.5), (61, 52), (68, 32), (72, 8), (73, -14))),
    (33, ((0, 98.6), (14, 98), (29, 94.3), (43, 86), (53, 72.5), (60, 56), (66.5, 36), (71.5, 12))),
    (33, ((73, -14),)),
    (21, ((0, 97.3), (12, 96.8), (26, 94.3), (38, 89.1), (47, 81.6), (53.7, 70), (58.9, 55))),
    (21, ((65, 36), (70.3, 12), (72, -14))),
    (16, ((0, 96.6), (9, 95.2), (18, 92.3), (28, 91.0), (38, 87.5), (47, 80.6))),
    (11, ((0, 94.6), (9, 93.0), (18, 89.5), (28, 87.9), (38, 85.0), (46, 79.3), (52.7, 68))),
    (11, ((58.3, 54), (64.8, 36), (69.6, 12), (71, -14))),
    (6, ((0, 91.3), (9, 90), (18, 84.4), (28, 82), (38, 81), (46, 76.8))),
    (0, ((0, 87), (8, 86.3), (16, 80.5), (30, 79), (43.8, 75.6), (49.3, 71.8), (55.7, 61.8))),
    (0, ((60.6, 51.5), (65.6, 36), (69.6, 12), (70, -14))),
    (-8, ((10, 87), (17, 82.2), (26, 82.8), (34, 82.8), (42, 80.3), (47.5, 75.9))),
    (-14, ((0, 88), (10, 87.5), (18, 84.2), (26, 84.4), (34, 84.4), (43, 81.3), (50.2, 75))),
    (-14, ((56.6, 65.5), (61.7, 53), (66.8, 36), (69.8, 12), (69, -14))),
    (-26, ((0, 92), (14, 90.7), (24, 89.8), (35, 88), (45.7, 82), (53.5, 72.3), (60, 59))),
    (-26, ((65.4, 40), (68.8, 14), (67, -14))),
    (-40, ((0, 98.3), (16, 96.4), (25, 93.8), (36, 88), (46.6, 78.5), (54.5, 66), (60.2, 50.8))),
    (-40, ((65, 34), (67, 14), (64, -12))),
    (-52, ((0, 102.2), (12, 101.2), (22, 98), (32, 91.4), (42.8, 81), (51.5, 67), (57.8, 49.3))),
    (-52, ((61.8, 32), (63.4, 14), (60, -12))),
    (-66, ((0, 102.8), (12, 101), (22, 96.5), (28, 92.6), (36, 85.7), (45, 73), (51.6, 57))),
    (-66, ((55.6, 41.8), (57.8, 28), (58.4, 13), (55.5, -10))),
    (-85.5, ((0, 96.5), (12, 95.5), (24, 89.6), (34.3, 79.8), (43, 67.6), (49.2, 53))),
    (-85.5, ((53.2, 38.4), (54.6, 24), (53.6, 11), (50, -8))),
    (-99, ((0, 99.6), (10, 98.6), (20, 92.8), (30, 82.4), (39.6, 67), (46.6, 50.6), (49.4, 35))),
    (-99, ((46.8, 20), (45.2, 8), (44, -10))),
    (-108.5, ((0, 98.3), (10, 96.8), (20, 89.4), (29.5, 78), (37, 63), (37.6, 46), (36.5, 28))),
    (-108.5, ((41, 9), (44.5, -10))),
    (-114.5, ((0, 93.8), (11, 91.2), (20, 82.8))),
    (-113, ((28.5, 69.5), (32, 53), (34.5, 36), (41, 11), (45.5, -10))),
    (-119.5, ((0, 81.5), (12, 77.5), (22, 67), (29.5, 52))),
    (-125.5, ((0, 63), (14, 58.5), (25.5, 47), (34.5, 34), (43, 13), (48, -10))),
    (-138, ((0, 52), (15.5, 48.5), (29, 40), (39.5, 25.5), (46.5, 7), (50.5, -10))),
    (-155, ((0, 49), (15.5, 46.5), (30, 38.5), (42, 24), (49.5, 6), (53.5, -10))),
    (-170, ((0, 49), (16, 46.5), (31.5, 38.5), (44, 24), (52, 6), (56, -10))),
)
# The back of the head, coarser: its outline is seen from the side.
BACK_OF_HEAD = (
    (0, 105, -54), (40, 98, -50), (0, 66, -88), (45, 55, -73), (66, 45, -50), (0, 20, -93),
    (45, 15, -77), (65, 5, -50), (0, -12, -90), (0, -40, -80), (40, -40, -62), (52, -60, -40),
    (0, -75, -66), (0, -100, -61), (42, -100, -44), (0, -145, -63), (44, -150, -46),
)  # fmt: skip


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


def _section_points() -> Points:
    rows = [(x, y, z) for y, section in SECTIONS for x, z in section]
    half = np.array(rows + list(BACK_OF_HEAD), dtype=np.float64)
    mirrored = half[half[:, 0] > 0.0] * [-1.0, 1.0, 1.0]
    return np.vstack([half, mirrored])


def _on_reference(angle: Values, height: Values) -> npt.NDArray[np.float64]:
    origins, directions = rays(angle, height)
    return origins + REFERENCE * directions


@cache
def _radius_spline() -> RectBivariateSpline:
    """The thin-plate spline sampled on a grid: a hundred times faster to look up."""
    angle, height, radius = direction_coordinates(_section_points())
    plate = RBFInterpolator(
        _on_reference(angle, height), radius, kernel="thin_plate_spline", smoothing=SMOOTHING
    )
    angles = np.linspace(-0.3, np.pi + 0.3, 121)
    heights = np.linspace(-175.0, CROWN + REFERENCE * np.pi / 2, 261)
    grid_angle, grid_height = np.meshgrid(angles, heights, indexing="ij")
    samples = plate(_on_reference(grid_angle.ravel(), grid_height.ravel()))
    return RectBivariateSpline(angles, heights, samples.reshape(grid_angle.shape))


def base_radius(angle: Values, height: Values) -> Values:
    """Radius of the plain head [mm] over capsule coordinates."""
    return np.asarray(_radius_spline().ev(np.abs(angle), height), dtype=np.float64)
