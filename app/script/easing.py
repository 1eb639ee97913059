"""Easing curves between two keyframes: pure functions of a fraction 0..1, each from 0 to 1.

They take numbers and arrays of numbers alike.
"""

from __future__ import annotations

from collections.abc import Callable


def linear(fraction: float) -> float:
    """Constant speed."""
    return fraction


def smooth(fraction: float) -> float:
    """Starts and stops softly (cubic); the default, since no muscle starts or stops at once."""
    return fraction * fraction * (3.0 - 2.0 * fraction)


def ease_in(fraction: float) -> float:
    """Starts softly, arrives at speed."""
    return fraction * fraction


def ease_out(fraction: float) -> float:
    """Starts at speed, arrives softly."""
    return 1.0 - (1.0 - fraction) ** 2


def hold(fraction: float) -> float:
    """Stays at the previous key until the next one is reached, then jumps."""
    return fraction // 1.0


EASINGS: dict[str, Callable[[float], float]] = {
    "linear": linear,
    "smooth": smooth,
    "ease-in": ease_in,
    "ease-out": ease_out,
    "hold": hold,
}
