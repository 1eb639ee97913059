"""Smooth functions of arrays: joins without a kink, and rows of length 1.

Source of the smooth minimum: Quílez, "smooth minimum" (polynomial form), a well-known recipe.
"""

from typing import Any

import numpy as np
import numpy.typing as npt

Points = npt.NDArray[np.float64]
Values = npt.NDArray[np.float64]
Grid = npt.NDArray[Any]  # values of single or double precision


def smooth_minimum(first: Grid, second: Grid, radius: float | Values) -> Grid:
    """Join two fields; `radius` [mm] is the width of the fillet between them."""
    overlap = np.maximum(radius - np.abs(first - second), 0.0) / radius
    joined: Grid = np.minimum(first, second) - overlap * overlap * radius * 0.25
    return joined


def smooth_maximum(first: Grid, second: Grid, radius: float | Values) -> Grid:
    """Intersect two fields; subtract one by passing its negative."""
    return -smooth_minimum(-first, -second, radius)


def smooth_step(low: float, high: float, values: Values) -> Values:
    """Rise from 0 at `low` to 1 at `high` without a kink."""
    t = np.clip((values - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def bump(values: Values, centre: float, width: float) -> Values:
    """A bell of height 1 around `centre`, down to 1/e at `width`."""
    return np.exp(-(((values - centre) / width) ** 2))


def unit(vectors: Points) -> Points:
    """Scale rows to length 1; zero rows stay zero."""
    scaled: Points = vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-12)
    return scaled
