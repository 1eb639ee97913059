"""Calibration: the neutral face of a recorded person, and gains of the channels.

Trackers do not measure 0 on a face at rest: on most faces a phone measures a quarter of a frown.
Calibration subtracts the neutral value n of a channel v, and leaves the greatest value, 1, as it
is:

    v -> (v - n) / (1 - n),  then times the gain

Angles have no greatest value, so n is only subtracted. Mirroring comes last. The same object serves
whole takes, whose values are arrays, and single frames, whose values are numbers.
"""

from __future__ import annotations

import fnmatch
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np

from risorius.geometry.arrays import Floats64

from ..control_names import SIGNED_CONTROLS, twin_of
from ..errors import UserError
from .names import ANGLE_NAMES, ARKIT_SHAPES, HEAD_ANGLES, VISEME_NAMES, angle_of, shape_of
from .take import Take

Value = TypeVar("Value", float, Floats64)

HIGHEST_GAIN = 10.0
FIRST_SECONDS = 1.0  # [s] of a take in which the head is held straight
BLINK_GAIN = 1.15  # blinks are recorded with peaks of 0.86 to 0.94
OPENFACE_GAIN = 1.4  # OpenFace hardly ever reports intensity E, 5 of 5


@dataclass(frozen=True)
class Calibration:
    """Changes of a recorded face's channels, before they move the simulated face.

    neutral: channel -> its value in the neutral face, in its own unit; 0 for others.
    gains: channel -> its factor.
    default_gain: factor of all other channels except angles.
    mirror: whether to swap left and right.
    """

    neutral: Mapping[str, float] = field(default_factory=dict)
    gains: Mapping[str, float] = field(default_factory=dict)
    default_gain: float = 1.0
    mirror: bool = False

    def apply(self, channels: Mapping[str, Value]) -> dict[str, Value]:
        """Return the calibrated channels, arrays of shape (T,) or numbers like the input."""
        calibrated = {name: self._value(name, value) for name, value in channels.items()}
        if not self.mirror:
            return calibrated
        return {
            twin_of(name): -value if name in SIGNED_CONTROLS else value
            for name, value in calibrated.items()
        }

    def _value(self, name: str, value: Value) -> Value:
        """Subtract a channel's neutral value, and multiply by its gain."""
        neutral = self.neutral.get(name, 0.0)
        if name in ANGLE_NAMES:
            return (value - neutral) * self.gains.get(name, 1.0)
        # Least range of a channel above the neutral value; less would amplify noise to motion.
        least_range = 0.2
        scale = self.gains.get(name, self.default_gain) / max(1.0 - neutral, least_range)
        return (value - neutral) * scale


def calibration_for(
    take: Take,
    *,
    neutral: str | None = None,
    gains: Iterable[str] = (),
    mirror: bool = False,
) -> Calibration:
    """Return the calibration of a take; its kind determines neutral face and gains by default.

    neutral: "first:SECONDS", "percentile" or "none". gains: factors as "NAME=x", where NAME may be
    a pattern such as mouth*. Raises UserError for any other value.
    """
    own, default = gains_of(gains, take.channels, kind=take.kind)
    return Calibration(neutral_of(take, neutral), own, default, mirror)


def neutral_of(take: Take, method: str | None = None) -> dict[str, float]:
    """Return the neutral face of a take: channel -> value.

    method: "first:SECONDS", the median of the first seconds; "percentile", the median of the first
    second for angles of the head, and the 5th percentile for channels that do not rest at 0; or
    "none". None means "percentile", except for takes under two seconds (no neutral face) and for
    calibrated takes (only angles of the head). Raises UserError for another method.
    """
    if method == "none":
        return {}
    names = [name for name in take.channels if name not in VISEME_NAMES]
    if method is not None and method.startswith("first"):
        return _median_of_first(take, names, _seconds_in(method))
    if method not in (None, "percentile"):
        raise UserError(f"--neutral {method}: allowed are first:SECONDS, percentile and none")
    shortest_take = 2.0  # [s]; a shorter take may show no neutral face
    if method is None and take.duration < shortest_take:
        return {}
    neutral = _median_of_first(take, [n for n in names if n in HEAD_ANGLES], FIRST_SECONDS)
    if method is None and take.is_calibrated:
        return neutral
    low_percentile = 5.0  # taken as the neutral value
    # Channels that are 0 in a face at rest, or are a share of another channel.
    never_neutral = ("eyeLook*", "eyeBlink*", "jawOpen", "mouthClose", "AU43*", "AU45*", "AU46*")
    for name in names:
        if name not in ANGLE_NAMES and not any(_fitting([name], each) for each in never_neutral):
            neutral[name] = float(np.percentile(take.channels[name], low_percentile))
    return neutral


def neutral_now(channels: Mapping[str, float]) -> dict[str, float]:
    """Return the neutral face of a person who is neutral in this frame."""
    return {name: value for name, value in channels.items() if name not in VISEME_NAMES}


def _median_of_first(take: Take, names: Iterable[str], seconds: float) -> dict[str, float]:
    first = take.times <= seconds
    return {name: float(np.median(take.channels[name][first])) for name in names}


def _seconds_in(method: str) -> float:
    """Return the number in first:SECONDS."""
    text = method.removeprefix("first").removeprefix(":")
    try:
        seconds = float(text) if text else FIRST_SECONDS
    except ValueError:
        seconds = math.nan
    if not 0.0 <= seconds < math.inf:
        raise UserError(f"--neutral {method}: '{text}' is not a time; write first:1 for one second")
    return seconds


def gains_of(
    settings: Iterable[str], channels: Iterable[str], *, kind: str = ""
) -> tuple[dict[str, float], float]:
    """Return the gains of `--gain NAME=x ...` by channel, and the gain of all other channels.

    NAME is a channel, a pattern (mouth*, *Left), or all; later settings replace earlier ones. kind:
    kind of recording, which determines default gains. Raises UserError for a name that fits no
    channel.
    """
    names = list(channels)
    is_openface = kind.startswith("OpenFace")
    pattern, usual = ("AU*", OPENFACE_GAIN) if is_openface else ("eyeBlink*", BLINK_GAIN)
    gains = dict.fromkeys(_fitting(names, pattern), usual)
    default = 1.0
    for setting in settings:
        name, value = _gain_in(setting)
        if name == "all":
            default = value
            gains.clear()
            continue
        name = shape_of(name) or angle_of(name) or name  # NAME may be spelled as in a file: JawOpen
        fitting = _fitting(names, name)
        if not fitting and not _fitting(ARKIT_SHAPES, name):
            raise UserError(
                f"--gain {setting}: no channel of this recording is called '{name}'; "
                "write a channel's name, a pattern such as mouth*, or all"
            )
        gains.update(dict.fromkeys(fitting, value))
    return gains, default


def _gain_in(setting: str) -> tuple[str, float]:
    """Return name and number of NAME=x."""
    name, _, text = setting.partition("=")
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not name or not 0.0 <= value <= HIGHEST_GAIN:
        raise UserError(
            f"--gain {setting}: write NAME=x, where x is a number from 0 to {HIGHEST_GAIN:g}"
        )
    return name, value


def _fitting(names: Iterable[str], pattern: str) -> list[str]:
    return [name for name in names if fnmatch.fnmatchcase(name, pattern)]
