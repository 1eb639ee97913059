"""The rows of the timeline, a track each: which keys each has, and which of them are meant."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..script import EASING_NAMES, Channel, Pose, Script
from ..vocabulary import readable
from .keyframes import POSES, places_of
from .places import Places

TRACKS = "Tracks"
MOST_LINES = 7  # of a key's values that are told


@dataclass(frozen=True)
class Track:
    """One row: the keys of the poses, of a track, or of all tracks together."""

    label: str
    places: Places
    channel: Channel | None = None  # that it shows alone
    names: tuple[tuple[float, str], ...] = ()  # of poses, by time [s]
    held: tuple[tuple[float, float], ...] = ()  # from, to [s]: two poses in a row are the same
    is_whole: bool = False  # poses, which are keys of all controls
    is_sum: bool = False  # of the rows below it, which may be folded

    @property
    def height(self) -> float:
        """Of the row, in ordinary ones: above the keys of poses is room for names."""
        return 1.75 if self.is_whole else 1.0

    @property
    def end(self) -> float:
        """The time of its last key [s]."""
        return max((float(times[-1]) for times in self.places.times.values()), default=0.0)


def visible_tracks(script: Script, *, is_open: bool) -> tuple[Track, ...]:
    """The poses, then the tracks: one row for all of them, and if it is open one for each."""
    tracks, times = [], places_of(script).times
    if script.poses or not script.tracks:
        names = tuple((pose.time, pose.name) for pose in script.poses if pose.name)
        poses = Places({POSES: times.pop(POSES, np.empty(0))})
        tracks.append(Track("Poses", poses, names=names, held=_held(script.poses), is_whole=True))
    if script.tracks:
        tracks.append(Track(TRACKS, Places(times), is_sum=True))
    if is_open:
        tracks += [
            Track(readable(name), Places({name: times[name]}), channel)
            for name, channel in script.tracks.items()
        ]
    return tuple(tracks)


def _held(poses: Sequence[Pose]) -> tuple[tuple[float, float], ...]:
    """Where two poses in a row are the same."""
    pairs = itertools.pairwise(poses)
    return tuple((one.time, other.time) for one, other in pairs if one.values == other.values)


def described(script: Script, places: Places) -> str:
    """What there is to say about keys at one time: a title, then the values that they hold."""
    name, lines, easings = "", list[str](), set[str]()
    for track, times in sorted(places.times.items()):  # the poses come first
        if track == POSES:
            for pose in (pose for pose in script.poses if pose.time in times):
                name = pose.name or ""
                lines += [_value(*each) for each in pose.values.items() if each[1]] or ["neutral"]
                easings.add(pose.easing)
        else:
            channel = script.tracks[track]
            for index in np.searchsorted(channel.times, times):
                lines.append(_value(track, channel.values[index]))
                easings.add(EASING_NAMES[channel.easings[index]])
    title = ", ".join(filter(None, (name, f"{places.first:.2f} s", *sorted(easings - {"smooth"}))))
    more = [f"and {len(lines) - MOST_LINES} more"] if len(lines) > MOST_LINES else []
    return "\n".join([title, *lines[:MOST_LINES], *more])


def _value(name: str, value: float) -> str:
    return f"{readable(name)} {value:.2f}"
