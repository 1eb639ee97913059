"""Easing curves between two keyframes: pure functions of a fraction 0..1, each from 0 to 1.

They take numbers and arrays of numbers alike. Whoever wants another curve gives the slopes at both
ends, in mean speeds; as no slope is above 3, it never turns back (Fritsch and Carlson, "Monotone
piecewise cubic interpolation", 1980). All named ones but hold are such curves as well.
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


def sloped(start: float, end: float) -> Callable[[float], float]:
    """The cubic curve that leaves and arrives with these slopes, each 0 to STEEPEST."""

    def curve(fraction: float) -> float:
        rest = 1.0 - fraction
        return smooth(fraction) + fraction * rest * (start * rest - end * fraction)

    return curve


def free_easing(start: float, end: float) -> str:
    """The name of the easing whose slopes are nearest to these, as "0.5,2"."""
    return ",".join(f"{min(max(0.0, round(slope, 1)), STEEPEST):g}" for slope in (start, end))


STEEPEST = 3.0
SLOPES = {"linear": (1.0, 1.0), "smooth": (0.0, 0.0), "ease-in": (0.0, 2.0), "ease-out": (2.0, 0.0)}
_FREE = {(a / 10, b / 10) for a in range(31) for b in range(31)}  # in steps that a mouse can choose
ALL_EASINGS = EASINGS | {free_easing(*slopes): sloped(*slopes) for slopes in sorted(_FREE)}
SLOPES |= {free_easing(*slopes): slopes for slopes in _FREE}
ALLOWED = f"{', '.join(EASINGS)}, or two slopes from 0 to 3 in tenths, as '0.5,2'"
