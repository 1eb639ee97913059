"""What a script is: poses and tracks of keys, and their values at any time."""

from __future__ import annotations

import bisect
import difflib
import functools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from operator import attrgetter
from pathlib import Path
from typing import TypeVar

from ..errors import UserError
from .easing import EASINGS

Limits = Mapping[str, tuple[float, float]]  # the lowest and highest value of each control

DECIMALS = 6  # of numbers that come from sliders and clocks


@dataclass(frozen=True)
class Key:
    """One keyframe of one channel: at `time` [s] it has `value`, approached by `easing`."""

    time: float
    value: float
    easing: str = "smooth"


@dataclass(frozen=True)
class Channel:
    """The keys of one control, in the order of time."""

    keys: tuple[Key, ...]

    def value(self, time: float) -> float:
        """The eased value at `time` [s]; constant before the first and after the last key."""
        previous, following, share = _between(self.keys, time)
        return previous.value + (following.value - previous.value) * share


@dataclass(frozen=True)
class Pose:
    """A whole pose at `time` [s]: what it does not name is 0; approached by `easing`."""

    time: float
    values: Mapping[str, float] = field(default_factory=dict)
    easing: str = "smooth"
    name: str | None = None  # one that has a name gets a picture on a contact sheet


@dataclass(frozen=True)
class Script:
    """A performance: what each control does over `duration` seconds."""

    title: str
    duration: float
    source: str = field(compare=False)  # the file it came from, for error texts
    scene: str = "face"
    camera: str | None = None
    sound: Path | None = None  # the file of what is heard with it, its whole path
    poses: tuple[Pose, ...] = ()  # in the order of time
    tracks: dict[str, Channel] = field(default_factory=dict)
    preface: str = ""  # the lines of comment with which the file begins

    @functools.cached_property
    def posed_names(self) -> tuple[str, ...]:
        """The controls that any pose names."""
        return tuple(sorted({name for pose in self.poses for name in pose.values}))

    def posed(self, time: float) -> dict[str, float]:
        """What the poses alone make of each control that they name, at `time` [s]."""
        values = dict.fromkeys(self.posed_names, 0.0)
        if self.poses:
            previous, following, share = _between(self.poses, time)
            for name in {**previous.values, **following.values}:
                before = previous.values.get(name, 0.0)
                values[name] = before + (following.values.get(name, 0.0) - before) * share
        return values

    @property
    def key_poses(self) -> tuple[Pose, ...]:
        """The poses that have a name."""
        return tuple(pose for pose in self.poses if pose.name is not None)

    def at(self, time: float) -> dict[str, float]:
        """The value of every channel that the script names, at `time` [s]."""
        values = self.posed(time)
        for name, channel in self.tracks.items():
            values[name] = values.get(name, 0.0) + channel.value(time)
        return values

    def check(self, limits: Limits) -> None:
        """Raise UserError if the script names what the scene does not have, or asks too much.

        What tracks add to poses may be negative, and is cut off with them; no single key may be
        further from 0 than can have an effect.
        """
        for name in (*self.posed_names, *self.tracks):
            if name not in limits:
                hint = suggestion(name, limits, self.scene)
                raise UserError(f"{self.source}: unknown name '{name}'; {hint}")
        for pose in self.poses:
            when = f" at {pose.time:g} s" if len(self.poses) > 1 else ""
            for name, value in pose.values.items():
                self._check_value(name, value, when, *limits[name])
        for name, channel in self.tracks.items():
            low, high = limits[name]
            for key in channel.keys:
                when = f" at {key.time:g} s" if len(channel.keys) > 1 else ""
                self._check_value(f"track '{name}'", key.value, when, low - high, high - low)

    def _check_value(self, what: str, value: float, when: str, low: float, high: float) -> None:
        if not low <= value <= high:
            raise UserError(
                f"{self.source}: {what} is {value:g}{when}; it must be from {low:g} to {high:g}"
            )


Timed = TypeVar("Timed", Key, Pose)


def _between(keys: Sequence[Timed], time: float) -> tuple[Timed, Timed, float]:
    """The keys before and after `time` [s], and the eased share of the way between them.

    Before the first and after the last key both are that one.
    """
    after = bisect.bisect_right(keys, time, key=attrgetter("time"))
    if after in (0, len(keys)):
        outermost = keys[0 if after == 0 else -1]
        return outermost, outermost, 0.0
    previous, following = keys[after - 1], keys[after]
    share = (time - previous.time) / (following.time - previous.time)
    return previous, following, EASINGS[following.easing](share)


def rounded(number: float) -> float:
    """A time or a value as programs write it into scripts: no digits that nobody meant."""
    return round(float(number), DECIMALS)


def suggestion(name: str, allowed: Iterable[str], scene: str) -> str:
    """The end of an error text: the names that were probably meant, or where to find all."""
    near = difflib.get_close_matches(name, list(allowed), n=3)
    if near:
        return f"did you mean {' or '.join(near)}?"
    option = "" if scene == "face" else f" --scene {scene}"
    return f"`risorius controls{option}` lists every control"
