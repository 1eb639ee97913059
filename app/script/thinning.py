"""Reduction of many samples to few keys: straight lines that follow a recorded channel."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from risorius.geometry.arrays import Flags, Floats64
from risorius.jit import njit

from . import SCRIPT_DECIMALS, Channel

LINE_TOLERANCE = 2e-3  # largest error of a line between keys, which is invisible


def thinned(
    times: npt.ArrayLike, values: npt.ArrayLike, tolerance: float = LINE_TOLERANCE
) -> Channel:
    """Return linear keys at some samples; the error at each sample is at most `tolerance`.

    times: times of the samples [s], shape (T,), T at least 1, rising. They are rounded to
    microseconds, and samples that are then no later than the sample before are left out. values:
    shape (T,), finite. Values of keys are rounded by at most a twentieth of the tolerance, to keep
    files short. tolerance: largest error of a value, above 0.

    The next key is the farthest sample that a straight line can reach, as in Imai and Iri,
    "Computational-geometric methods for polygonal approximations of a curve" (1986). One pass
    narrows the possible directions.
    """
    moments = np.array(times, np.float64).round(SCRIPT_DECIMALS)
    is_later = np.diff(moments, prepend=-np.inf) > 0.0
    moments = moments[is_later]
    samples = np.array(values, np.float64)[is_later]
    decimals = math.ceil(-math.log10(0.1 * tolerance))
    ends = samples.round(decimals) + 0.0  # turns -0.0 into 0.0
    kept = _mark_corners(moments, samples, ends, tolerance)
    return Channel(moments[kept], ends[kept], "linear")


@njit
def _mark_corners(times: Floats64, values: Floats64, ends: Floats64, tolerance: float) -> Flags:
    """Return which samples become keys, shape (T,); a key has the value in `ends`."""
    count = len(times)
    is_corner = np.zeros(count, np.bool_)
    start = 0
    is_corner[0] = True
    while start < count - 1:
        low = -np.inf
        high = np.inf
        farthest = start + 1
        for index in range(start + 1, count):
            seconds = times[index] - times[start]
            if low <= (ends[index] - ends[start]) / seconds <= high:
                farthest = index
            low = max(low, (values[index] - tolerance - ends[start]) / seconds)
            high = min(high, (values[index] + tolerance - ends[start]) / seconds)
            if low > high:
                break
        start = farthest
        is_corner[start] = True
    return is_corner
