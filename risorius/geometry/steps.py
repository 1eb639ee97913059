"""Smooth steps between 0 and 1."""

import numpy as np

from .arrays import Floats64


def smoothstep(values: Floats64, low: float = 0.0, high: float = 1.0) -> Floats64:
    """Rise from 0 at `low` to 1 at `high`, with slope 0 at both ends."""
    t = np.clip((values - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)
