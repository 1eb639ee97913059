"""The lips: the curves that bound them and how far they stand out of the plain head.

Everything is a function of the distance from the mid-plane, t = |x| / HALF_WIDTH, and across the
lip of s = 0 at the line between the lips .. 1 at the border of the red.
"""

import numpy as np
import scipy

from .fields import Values, bump

HALF_WIDTH = 25.5  # [mm] mid-plane to corner; chosen within one deviation of adult means
SEAM_HEIGHT = -66.0  # [mm]

# (s, outward displacement [mm]): the lip rolls in at s = 0, crests, and ends in a slight ledge.
UPPER = (
    (0, 0.08, 0.25, 0.5, 0.78, 1, 1.25, 1.7, 2.3, 2.9),
    (1.0, 1.8, 2.8, 3.5, 3.8, 3.7, 3.0, 1.7, 0.55, 0),
)
LOWER = (
    (0, 0.08, 0.2, 0.4, 0.62, 0.82, 1, 1.3, 1.75, 2.3, 2.9),
    (1.0, 2.5, 3.7, 4.7, 5.0, 4.7, 4.0, 2.7, 1.2, 0.3, 0),
)


def _relative(x: Values, limit: float = 1.0) -> Values:
    return np.clip(np.abs(x) / HALF_WIDTH, 0.0, limit)


def seam_height(x: Values) -> Values:
    """Height y of the line between the lips [mm]: a dip in the middle, corners lifted."""
    t = _relative(x, 1.3)
    return SEAM_HEIGHT - 0.7 * np.exp(-((t / 0.33) ** 4)) + 0.3 * bump(t, 0.62, 0.3) + 0.3 * t**3


def upper_border(x: Values) -> Values:
    """Height y of the upper border of the red [mm], with Cupid's bow."""
    t = _relative(x)
    height = 8.1 * (1 - t**2.0) ** 0.85 + 1.0 * bump(t, 0.22, 0.15) - 0.6 * bump(t, 0.0, 0.12)
    return seam_height(x) + height * (1 - t**9)


def lower_border(x: Values) -> Values:
    """Height y of the lower border of the red [mm]."""
    t = _relative(x)
    return seam_height(x) - 9.6 * (1 - t**2.2) ** 0.95


def displacement(x: Values, y: Values) -> Values:
    """How far the lips stand out of the plain head [mm]."""
    inside = np.clip(1 - (np.abs(x) / HALF_WIDTH) ** 3, 0.0, 1.0)
    seam = seam_height(x)
    above = (y - seam) / np.maximum(upper_border(x) - seam, 0.6)
    below = (seam - y) / np.maximum(seam - lower_border(x), 0.6)
    upper, lower = (scipy.interpolate.PchipInterpolator(*table) for table in (UPPER, LOWER))
    rolled = upper(np.clip(above, 0.0, 2.9)), lower(np.clip(below, 0.0, 2.9))
    displaced = np.where(y >= seam, rolled[0] * inside**1.3, rolled[1] * inside**1.9)
    return np.asarray(displaced, dtype=np.float64)
