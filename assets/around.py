"""Places on the built-in head as angle, height and radius, and the neck there.

A direction is measured from a vertical axis up to CROWN, and from the axis' upper end above it, so
that the crown of the head is a dome without a pole in the way.
"""

import numpy as np

from .smooth import Points, Values, bump, smooth_step

AXIS_Z = 15.0  # [mm] the vertical axis stands here, on x = 0
CROWN = 40.0  # [mm] height of the axis' upper end
REFERENCE = 70.0  # [mm] radius of the capsule on which heights above CROWN are measured
# height [mm], angle [deg] along the muscle that turns the head
NECK_MUSCLE = ((-170, 24), (-156, 33), (-140, 47), (-122, 66), (-104, 84), (-86, 96), (-70, 103))
STRIP = 12.4  # [mm] half of what a vertex of the neck stands for: edges have 15 to 32 mm there


def direction_coordinates(points: Points) -> tuple[Values, Values, Values]:
    """Split points into angle about the axis [rad], height along the capsule [mm], radius [mm]."""
    beside, ahead = points[:, 0], points[:, 2] - AXIS_Z
    above = np.maximum(points[:, 1] - CROWN, 0.0)
    horizontal = np.hypot(beside, ahead)
    angle = np.arctan2(beside, ahead)
    elevation = np.arctan2(above, np.maximum(horizontal, 1e-9))
    height = np.where(points[:, 1] < CROWN, points[:, 1], CROWN + REFERENCE * elevation)
    return angle, height, np.hypot(horizontal, above)


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
