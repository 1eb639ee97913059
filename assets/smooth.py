"""Small functions of arrays: a rise without a kink, and rows of length 1."""

import numpy as np
import numpy.typing as npt

from ..geometry.arrays import Floats64

Points = npt.NDArray[np.float64]


def smooth_step(low: float, high: float, values: Floats64) -> Floats64:
    """Rise from 0 at `low` to 1 at `high` without a kink."""
    t = np.clip((values - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def unit(vectors: Points) -> Points:
    """Scale rows to length 1; zero rows stay zero."""
    scaled: Points = vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-12)
    return scaled
