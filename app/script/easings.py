"""Easings: the way of a value from one key to the next, by its slopes at both ends.

The way is the cubic Hermite curve from 0 to 1 with these slopes. No slope is above 3 mean speeds,
so no curve turns back. A way may also hold: the value stays at the previous key, then jumps.

Source: Fritsch and Carlson, "Monotone piecewise cubic interpolation", 1980.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator
from typing import NamedTuple, TypeVar

import numpy as np

from risorius.geometry.arrays import Floats64, Unsigned8

Value = TypeVar("Value", float, Floats64)

STEEPEST_TENTHS = 30  # of a slope


class Easing(NamedTuple):
    """The slopes at the previous key and this one, in tenths of the mean speed; or a held way."""

    start: int
    end: int
    is_held: bool = False

    @property
    def slopes(self) -> tuple[float, float]:
        """Both slopes [mean speeds]."""
        return self.start / 10, self.end / 10

    @property
    def name(self) -> str:
        """The word for it, or its slopes as "0.5,2"."""
        return _WORDS.get(self) or free_easing(*self.slopes)

    def of(self, fraction: float) -> float:
        """The share of the way, 0 to 1, at a fraction of the time, 0 to 1."""
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
ALLOWED = f"{', '.join(EASINGS)}, or two slopes from 0 to 3 in tenths, as '0.5,2'"
_WORDS = {easing: name for name, easing in EASINGS.items()}


def hermite(fraction: Value, start: Value, end: Value) -> Value:
    """The cubic Hermite curve from 0 to 1 with these slopes, at fractions of the time."""
    rest = 1.0 - fraction
    return fraction * fraction * (3.0 - 2.0 * fraction) + fraction * rest * (
        start * rest - end * fraction
    )


def shares_of(fractions: Floats64, rows: Unsigned8) -> Floats64:
    """Shares of the way between keys at fractions of the time, (N,); rows: easings, (N, 3)."""
    start = rows[:, 0] / 10
    end = rows[:, 1] / 10
    return np.where(rows[:, 2], fractions // 1.0, hermite(fractions, start, end))


def free_easing(start: float, end: float) -> str:
    """The slopes nearest to these [mean speeds] that an easing may have, as "0.5,2"."""
    most = STEEPEST_TENTHS / 10
    return ",".join(f"{min(max(0.0, round(slope, 1)), most):g}" for slope in (start, end))


@functools.lru_cache(maxsize=1024)
def easing_named(name: str) -> Easing:
    """The easing of a word or of two slopes; raises ValueError for another text."""
    if name in EASINGS:
        return EASINGS[name]
    start, end = map(float, name.split(","))
    if free_easing(start, end) != name:
        raise ValueError(f"easing: was '{name}', must be {ALLOWED}")
    return Easing(round(10 * start), round(10 * end))


def easing_names() -> Iterator[str]:
    """All texts that name an easing."""
    yield from EASINGS
    tenths = range(STEEPEST_TENTHS + 1)
    for start in tenths:
        for end in tenths:
            yield free_easing(start / 10, end / 10)
