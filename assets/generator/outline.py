"""The free border of the skin and the lines in the mid-plane: where the mesh of one half ends."""

import numpy as np
import scipy

from .fields import Points
from .form import from_axis
from .sections import CROWN, REFERENCE

# The rim in capsule coordinates: angle about the axis [deg], height along the capsule [mm]. It
# runs around the neck as a collar does, higher at the nape than in front.
RIM = (
    (180, -140), (150, -142), (120, -147), (90, -152), (60, -156), (30, -158.5), (0, -159.5),
)  # fmt: skip
DENSE = 900


def rim_curve() -> Points:
    """Return the rim of the left half from the nape to the front of the neck, densely sampled."""
    control = np.array(RIM, dtype=np.float64)
    spacing = np.hypot(np.diff(control[:, 0]), np.diff(control[:, 1]))
    parameter = np.r_[0.0, np.cumsum(spacing)]
    spline = scipy.interpolate.CubicSpline(
        parameter, control, bc_type=((1, (-1.0, 0.0)), (1, (-1.0, 0.0)))
    )
    samples = spline(np.linspace(0.0, parameter[-1], DENSE))
    curve = from_axis(np.radians(samples[:, 0]), samples[:, 1])
    curve[[0, -1], 0] = 0.0
    return curve


def midline_curve(start_height: float, end_height: float) -> Points:
    """Return the front profile between two heights along the capsule, densely sampled."""
    heights = np.linspace(start_height, end_height, DENSE)
    curve = from_axis(np.zeros(DENSE), heights)
    curve[:, 0] = 0.0
    return curve


def crown_curve(end: Points) -> Points:
    """Return the mid-plane line behind the pole: down the back of the head to `end`."""
    pole = CROWN + REFERENCE * np.pi / 2
    heights = np.linspace(pole - 0.05, RIM[0][1], DENSE)
    curve = from_axis(np.full(DENSE, np.pi), heights)
    curve[:, 0] = 0.0
    curve[-1] = end
    return curve


def resampled(curve: Points, size: Points) -> Points:
    """Points along a curve whose spacing follows `size` [mm] (one value per curve point)."""
    lengths = np.linalg.norm(np.diff(curve, axis=0), axis=1)
    steps = lengths / (0.5 * (size[1:] + size[:-1]))
    count = np.r_[0.0, np.cumsum(steps)]
    segments = max(1, round(float(count[-1])))
    wanted = np.linspace(0.0, count[-1], segments + 1)
    return np.stack([np.interp(wanted, count, curve[:, axis]) for axis in range(3)], axis=1)
