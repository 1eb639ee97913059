"""Easings: the curve of a value from one key to the next, given by the slopes at both ends.

The curve is the cubic Hermite curve from 0 to 1 with these slopes. No slope is above 3 mean speeds,
so no curve turns back. An easing may also hold: the value stays at the previous key, then jumps.

Source: Fritsch and Carlson, "Monotone piecewise cubic interpolation", 1980.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator
from typing import NamedTuple, TypeVar

import numpy as np

from risorius.geometry.arrays import Floats64, Unsigned8

Value = TypeVar("Value", float, Floats64)

STEEPEST_TENTHS = 30  # largest slope, in tenths of the mean speed


class Easing(NamedTuple):
    """The slopes of a curve at the previous and the current key, in tenths of the mean speed.

    is_held: the value stays at the previous key until the current one; slopes have no effect.
    """

    start: int
    end: int
    is_held: bool = False

    @property
    def slopes(self) -> tuple[float, float]:
        """Both slopes [mean speeds]."""
        return self.start / 10, self.end / 10

    @property
    def name(self) -> str:
        """The word for the easing, or its slopes, such as "0.5,2"."""
        return NAME_OF_EASING.get(self) or free_easing(*self.slopes)

    def progress(self, fraction: float) -> float:
        """Return the fraction of the value's change at a fraction of the time; both are 0 to 1."""
        if self.is_held:
            return fraction // 1.0
        return hermite(fraction, *self.slopes)


EASINGS = {
    "linear": Easing(10, 10),  # constant speed
    "smooth": Easing(0, 0),  # the default, because no muscle starts or stops at once
    "ease-in": Easing(0, 20),  # starts softly, arrives at speed
    "ease-out": Easing(20, 0),  # starts at speed, arrives softly
    "hold": Easing(0, 0, True),
}
ALLOWED_EASINGS = f"{', '.join(EASINGS)}, or two slopes from 0 to 3 in tenths, such as '0.5,2'"
NAME_OF_EASING = {easing: name for name, easing in EASINGS.items()}


def hermite(fraction: Value, start: Value, end: Value) -> Value:
    """Evaluate the cubic Hermite curve from 0 to 1 with these slopes at fractions of the time."""
    rest = 1.0 - fraction
    return fraction * fraction * (3.0 - 2.0 * fraction) + fraction * rest * (
        start * rest - end * fraction
    )


def shares_of(fractions: Floats64, rows: Unsigned8) -> Floats64:
    """Return how far changes have advanced, (N,), at fractions of their times, (N,); both 0 to 1.

    rows: easings, (N, 3).
    """
    start = rows[:, 0] / 10
    end = rows[:, 1] / 10
    return np.where(rows[:, 2], fractions // 1.0, hermite(fractions, start, end))


def free_easing(start: float, end: float) -> str:
    """Return the possible slopes that are nearest to these [mean speeds], such as "0.5,2"."""
    most = STEEPEST_TENTHS / 10
    return ",".join(f"{min(max(0.0, round(slope, 1)), most):g}" for slope in (start, end))


@functools.lru_cache(maxsize=1024)
def easing_named(name: str) -> Easing:
    """Return the easing of a word or of two slopes; raise ValueError for another text."""
    if name in EASINGS:
        return EASINGS[name]
    start, end = map(float, name.split(","))
    if free_easing(start, end) != name:
        raise ValueError(f"easing: was '{name}', must be {ALLOWED_EASINGS}")
    return Easing(round(10 * start), round(10 * end))


def easing_names() -> Iterator[str]:
    """Yield all texts that name an easing."""
    yield from EASINGS
    tenths = range(STEEPEST_TENTHS + 1)
    for start in tenths:
        for end in tenths:
            yield free_easing(start / 10, end / 10)
