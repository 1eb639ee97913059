"""The left nostril: a ring on the underside of the nose, and a shallow cap that closes it.

The cap rises gently at the back and at the wing and steeply at the front and the septum, so that
all of it that can be seen looks down: without cast shadows only such a nostril is dark.
"""

import numpy as np

from .fields import Points
from .form import from_below

COLUMNS = 9
CENTRE = (7.5, 106.4)  # [mm] x, z
HALF_WIDTH, HALF_LENGTH = 3.1, 4.7  # [mm]
TURN_DEG = 26.0  # the nostrils converge toward the tip


def nostril_ring() -> Points:
    """Return the ring on the underside, counter-clockwise in (x, z), shape (COLUMNS, 3)."""
    angle = 2.0 * np.pi * np.arange(COLUMNS) / COLUMNS
    narrowing = 1.0 - 0.18 * np.sin(angle)  # narrower in front
    x = HALF_WIDTH * np.cos(angle) * narrowing
    z = HALF_LENGTH * np.sin(angle)
    cosine, sine = np.cos(np.radians(TURN_DEG)), np.sin(np.radians(TURN_DEG))
    return from_below(CENTRE[0] + cosine * x - sine * z, CENTRE[1] + sine * x + cosine * z)


def nostril_cap(ring: Points) -> tuple[Points, Points]:
    """Return the inner ring and the closing centre point above a ring."""
    centre = ring.mean(axis=0)
    forward = np.clip((ring[:, 2] - ring[:, 2].min()) / (2.0 * HALF_LENGTH), 0.0, 1.0)
    inner = centre + (ring - centre) * [0.76, 1.0, 0.76] + [-0.4, 0.7, 0.4]
    inner[:, 1] += 1.4 * forward
    end = centre + np.array([-0.8, 2.5, 1.0])
    return inner, end
