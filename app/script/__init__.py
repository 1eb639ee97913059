"""Animation scripts: keyframes of controls over time, in a TOML file.

A script is a list of poses and of tracks. A track moves a single control, and its values are added
to the poses, for example for a blink, a glance, or a whole recording. `docs/scripts.md` describes
the file. Before its first key and after its last key a channel is constant. This module holds
poses, tracks of keys, and their values at any time.
"""

from __future__ import annotations

import bisect
import difflib
import functools
from array import array
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated

import numpy as np
import numpy.typing as npt

from risorius.geometry.arrays import Flags, Floats64
from risorius.schema import REST_KEY, OneOf, Record, Within, called

from ..control_names import meant_by
from ..control_names.limits import ControlValues, Limits
from ..errors import UserError
from .easings import ALLOWED_EASINGS, Easing, easing_named, easing_names, hermite, shares_of

Easings = npt.NDArray[np.uint8]  # rows of easings.Easing

SCRIPT_DECIMALS = 6  # to which numbers from sliders and clocks are rounded
LONGEST_SCRIPT_FILE = 2**25  # [bytes], about three quarters of an hour of a recorded face
POSE_SECONDS = 1.0  # duration of a script that is one pose
LARGEST_NUMBER = 86_400.0  # largest number in a script; as a time [s] it is a day
Number = Annotated[float, Within(-LARGEST_NUMBER, LARGEST_NUMBER)]
Moment = Annotated[float, Within(0.0, LARGEST_NUMBER)]
EasingName = Annotated[str, OneOf(easing_names, ALLOWED_EASINGS)]


@dataclass(frozen=True)
class Key(Record):
    """One keyframe of one channel: at `time` [s] it has `value`, approached by `easing`."""

    time: Moment
    value: Number
    easing: EasingName = "smooth"


@dataclass(frozen=True, eq=False)
class Channel:
    """The keys of one control, in the order of time; there is at least one.

    A recorded take has half a million keys, so they are kept in read-only arrays.

    times: times of the keys [s], shape (K,). values: values of the keys, shape (K,). easings: the
    easing towards each key, a row of `Easing`, shape (K, 3), or the name of one easing for all.
    """

    times: Floats64
    values: Floats64
    easings: Easings

    def __init__(
        self, times: npt.ArrayLike, values: npt.ArrayLike, easings: npt.ArrayLike | str = "linear"
    ) -> None:
        if isinstance(easings, str):
            easings = np.tile(np.array(easing_named(easings)), (len(np.asarray(times)), 1))
        for name, part, kind in (
            ("times", times, np.float64),
            ("values", values, np.float64),
            ("easings", easings, np.uint8),
        ):
            own = np.asarray(part, kind)
            if own.flags.writeable:  # its owner might change it
                own = own.copy()
                own.flags.writeable = False
            object.__setattr__(self, name, own)

    @classmethod
    def from_keys(cls, keys: Iterable[Key]) -> Channel:
        """Make a channel of keys, which must be in the order of time."""
        keys = tuple(keys)
        return cls(
            [key.time for key in keys],
            [key.value for key in keys],
            np.array([easing_named(key.easing) for key in keys]).reshape(-1, 3),
        )

    @property
    def keys(self) -> tuple[Key, ...]:
        """The keys as objects; each call makes them anew, so use it for few keys."""
        parts = zip(self.times.tolist(), self.values.tolist(), self.easing_rows(), strict=True)
        return tuple(Key(time, value, easing.name) for time, value, easing in parts)

    def easing(self, number: int) -> Easing:
        """Return the easing of the key with this number."""
        start, end, is_held = self.easings[number].tolist()
        return Easing(start, end, bool(is_held))

    def easing_rows(self) -> list[Easing]:
        """Return the easings of all keys."""
        return [Easing(start, end, bool(held)) for start, end, held in self.easings.tolist()]

    def __len__(self) -> int:
        return len(self.times)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Channel):
            return NotImplemented
        return self is other or (
            np.array_equal(self.times, other.times)
            and np.array_equal(self.values, other.values)
            and np.array_equal(self.easings, other.easings)
        )

    @functools.cached_property
    def _parts(self) -> tuple[array[float], array[float], bytes]:
        """Times, values and easings in Python sequences, which are faster for single reads."""
        times = array("d", self.times.tobytes())
        values = array("d", self.values.tobytes())
        return times, values, self.easings.tobytes()

    def value(self, time: float) -> float:
        """Return the eased value at `time` [s]; it is constant before and after all keys."""
        times, values, easings = self._parts
        previous, following, fraction = _span_around(times, time)
        start = values[previous]
        slope, arrival, is_held = easings[3 * following : 3 * following + 3]
        eased = fraction // 1.0 if is_held else hermite(fraction, slope / 10, arrival / 10)
        return start + (values[following] - start) * eased

    @functools.cached_property
    def ends(self) -> tuple[float, float]:
        """The lowest and the highest value of all keys."""
        return float(self.values.min()), float(self.values.max())

    def raised(self, chosen: Flags, amount: float, low: float, high: float) -> Channel:
        """Return the channel with chosen keys raised, within limits; chosen: flags, shape (K,)."""
        higher = raised_within(self.values, amount, low, high)
        return Channel(self.times, np.where(chosen, higher, self.values), self.easings)

    def values_at(self, times: Floats64) -> Floats64:
        """Return the values at many times [s]; times and values have shape (N,)."""
        after = np.searchsorted(self.times, times, "right")
        before = np.maximum(after - 1, 0)
        following = np.minimum(after, len(self) - 1)
        seconds = np.where(before < following, self.times[following] - self.times[before], 1.0)
        fractions = np.where(before < following, (times - self.times[before]) / seconds, 0.0)
        start = self.values[before]
        eased = shares_of(fractions, self.easings[following])
        values: Floats64 = start + (self.values[following] - start) * eased
        return values

    def outline(self, start: float, end: float, count: int) -> tuple[Floats64, Floats64]:
        """Return times [s] and values of points that draw the curve between two times, (N,) each.

        The curve is as exact as `count` columns can show. With at most `count` keys it has all keys
        and jumps; with more keys it has the lowest and the highest key of each column.
        """
        edges = np.linspace(start, end, count + 1)
        first, last = np.searchsorted(self.times, (start, end))
        keys = self.times[first:last]
        values = self.values[first:last]
        if len(keys) <= count:
            # A key with "hold" is a jump, which also needs a point just before it.
            just_before = np.nextafter(keys, -np.inf)
            times = np.unique(np.concatenate([edges, keys, just_before]))
            return times, self.values_at(times)
        begins = np.unique(np.searchsorted(keys, edges[:-1]))
        begins = begins[begins < len(keys)]
        lowest = np.minimum.reduceat(values, begins)
        highest = np.maximum.reduceat(values, begins)
        times = np.repeat(keys[begins], 2)
        return times, np.stack([lowest, highest], axis=1).ravel()


@dataclass(frozen=True)
class Pose(Record):
    """A pose of all controls at `time` [s], approached by `easing`; unnamed controls are 0."""

    time: Moment
    values: Annotated[Mapping[str, Number], called(REST_KEY)] = field(default_factory=dict)
    easing: EasingName = "smooth"
    name: str | None = None  # a named pose gets a picture on a contact sheet

    def raised(self, names: Iterable[str], amount: float, limits: Limits) -> Pose:
        """Return the pose with some values raised, within their limits."""
        higher = {}
        for name in names:
            value = self.values.get(name, 0.0)
            higher[name] = float(raised_within(value, amount, *limits[name]))
        new = {name: value for name, value in higher.items() if value or name in self.values}
        return replace(self, values={**self.values, **new})


@dataclass(frozen=True)
class Script:
    """A performance: the values of each control over `duration` seconds."""

    title: str
    duration: float
    source: str = field(compare=False)  # its file, for error texts
    scene: str = "face"
    camera: str | None = None
    sound: Path | None = None  # the absolute path of its sound file
    alive: bool = False  # whether idle life moves controls that the script does not name
    poses: tuple[Pose, ...] = ()  # in the order of time
    tracks: dict[str, Channel] = field(default_factory=dict)
    preface: str = ""  # the comments at the beginning of the file
    is_converted: bool = field(default=False, compare=False)  # whether source is a recording

    @functools.cached_property
    def posed_names(self) -> tuple[str, ...]:
        """The controls that any pose names."""
        return tuple(sorted({name for pose in self.poses for name in pose.values}))

    @functools.cached_property
    def names(self) -> tuple[str, ...]:
        """All controls that the script moves: those of poses, then those of tracks only."""
        return tuple(dict.fromkeys((*self.posed_names, *self.tracks)))

    @functools.cached_property
    def _pose_times(self) -> tuple[float, ...]:
        return tuple(pose.time for pose in self.poses)

    @functools.cached_property
    def _pose_rows(self) -> Floats64:
        """The values of the `posed_names`, a row for each pose."""
        return np.array(
            [[pose.values.get(name, 0.0) for name in self.posed_names] for pose in self.poses]
        )

    @functools.cached_property
    def _placed_tracks(self) -> tuple[tuple[int, Channel], ...]:
        """For each track, the index in `names` of the control to which it adds."""
        return tuple((self.names.index(name), track) for name, track in self.tracks.items())

    def posed(self, time: float) -> dict[str, float]:
        """Return the values of the poses, without tracks, at `time` [s], by name."""
        return dict(zip(self.posed_names, self._posed(time).tolist(), strict=True))

    def _posed(self, time: float) -> Floats64:
        """Return the values of the poses at `time` [s], in the order of `posed_names`."""
        if not self.posed_names:
            return np.zeros(0)
        before, after, fraction = _span_around(self._pose_times, time)
        start = self._pose_rows[before]
        end = self._pose_rows[after]
        easing = easing_named(self.poses[after].easing)
        posed: Floats64 = start + (end - start) * easing.progress(fraction)
        return posed

    def posed_channel(self, name: str) -> Channel:
        """Return the motion of a control by the poses, without tracks, as a channel."""
        keys = (Key(each.time, each.values.get(name, 0.0), each.easing) for each in self.poses)
        return Channel.from_keys(keys)

    @property
    def key_poses(self) -> tuple[Pose, ...]:
        """The poses that have a name."""
        return tuple(pose for pose in self.poses if pose.name is not None)

    def at(self, time: float) -> dict[str, float]:
        """Return the value of every control that the script names, at `time` [s]."""
        return dict(zip(self.names, self._sums(time).tolist(), strict=True))

    def values(self, time: float, limits: Limits) -> ControlValues:
        """Return the values of all controls of a scene at `time` [s], within their limits."""
        return limits.posed(limits.places(self.names), self._sums(time))

    def _sums(self, time: float) -> Floats64:
        """Return the sums of poses and tracks at `time` [s], in the order of `names`."""
        sums = np.zeros(len(self.names))
        sums[: len(self.posed_names)] = self._posed(time)
        for place, track in self._placed_tracks:
            sums[place] += track.value(time)
        return sums

    def check(self, limits: Limits) -> None:
        """Raise UserError for controls that the scene lacks, and for absurd values.

        Values of tracks may be negative, because only the sum with the poses is cut off. But no key
        of a track may be further from 0 than the whole range of the control.
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
            for place in np.flatnonzero(np.abs(channel.values) > high - low)[:1]:
                when = f" at {channel.times[place]:g} s" if len(channel) > 1 else ""
                value = channel.values[place]
                self._check_value(f"track '{name}'", value, when, low - high, high - low)

    def _check_value(self, what: str, value: float, when: str, low: float, high: float) -> None:
        if not low <= value <= high:
            raise UserError(
                f"{self.source}: {what} is {value:g}{when}; it must be from {low:g} to {high:g}"
            )


def _span_around(times: Sequence[float], time: float) -> tuple[int, int, float]:
    """Return the indices of the times before and after `time` [s], and the fraction between them.

    Before the first time both indices are the first, after the last time both are the last.
    """
    after = bisect.bisect_right(times, time)
    if after in (0, len(times)):
        outermost = min(after, len(times) - 1)
        return outermost, outermost, 0.0
    previous = times[after - 1]
    following = times[after]
    return after - 1, after, (time - previous) / (following - previous)


def raised_within(values: npt.ArrayLike, amount: float, low: float, high: float) -> Floats64:
    """Raise values by an amount within limits; values beyond the limits may stay there."""
    now = np.asarray(values, np.float64)
    higher = np.clip(now + amount, np.minimum(now, low), np.maximum(now, high))
    return np.round(higher, SCRIPT_DECIMALS)


def rounded(number: float) -> float:
    """Round a time or a value for a script, to remove meaningless digits."""
    return round(float(number), SCRIPT_DECIMALS)


def suggestion(name: str, allowed: Iterable[str], scene: str) -> str:
    """Return the end of an error message: similar names, synonyms, or how to list all names."""
    known = list(allowed)
    near = difflib.get_close_matches(name, known, n=3) or meant_by(name, known)[:3]
    if near:
        return f"did you mean {' or '.join(near)}?"
    option = "" if scene == "face" else f" --scene {scene}"
    return f"`risorius controls{option}` lists every control"
