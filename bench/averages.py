"""Averages of measured values; without values they are NaN, and numpy does not warn."""

import numpy as np

from risorius.geometry.arrays import Floats64


def mean(values: Floats64) -> float:
    """The mean of values of any shape."""
    return float(values.mean()) if values.size else float("nan")


def median(values: Floats64) -> float:
    """The median of values of any shape."""
    return float(np.median(values)) if values.size else float("nan")


def root_mean_square(values: Floats64) -> float:
    """The root of the mean square of values of any shape."""
    return float(np.sqrt(mean(values**2)))
