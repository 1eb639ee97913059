"""The rows of the timeline, a track each: which keys each has, and which of them are meant."""

from __future__ import annotations

import bisect
import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from operator import attrgetter

from ..script import Channel, Pose, Script
from .control_rows import readable
from .keys import POSES, SAME, KeyPlace

TRACKS = "Tracks"
MOST_LINES = 7  # of a key's values that are told


@dataclass(frozen=True)
class Track:
    """One row: the keys of the poses, of a track, or of all tracks together."""

    label: str
    places: tuple[KeyPlace, ...]  # in the order of time
    names: tuple[tuple[float, str], ...] = ()  # of poses, by time [s]
    held: tuple[tuple[float, float], ...] = ()  # from, to [s]: nothing moves in between
    is_whole: bool = False  # poses, which are keys of all controls
    is_sum: bool = False  # of the rows below it, which may be folded

    @property
    def height(self) -> float:
        """Of the row, in ordinary ones: names stand above the keys."""
        return 1.75 if self.names else 1.0

    def near(self, time: float, reach: float) -> frozenset[KeyPlace]:
        """The keys at the time nearest to this one, none if that is further than `reach` [s]."""
        found = self.between(time - reach, time + reach)
        nearest = min((place.time for place in found), key=lambda t: abs(t - time), default=0.0)
        return frozenset(place for place in found if place.time == nearest)

    def between(self, first: float, last: float) -> Sequence[KeyPlace]:
        """The keys from one time to another [s]."""
        begin = bisect.bisect_left(self.places, first, key=attrgetter("time"))
        return self.places[begin : bisect.bisect_right(self.places, last, key=attrgetter("time"))]


def visible_tracks(script: Script, *, is_open: bool) -> tuple[Track, ...]:
    """The poses, then the tracks: one row for all of them, and if it is open one for each."""
    tracks = []
    if script.poses or not script.tracks:
        names = tuple((pose.time, pose.name) for pose in script.poses if pose.name)
        held = _held(script.poses)
        tracks.append(Track("Poses", _places(script, (POSES,)), names, held, is_whole=True))
    if script.tracks:
        tracks.append(Track(TRACKS, _places(script, tuple(script.tracks)), is_sum=True))
    if is_open:
        tracks += [
            Track(readable(name), _places(script, (name,)), held=_still(track))
            for name, track in script.tracks.items()
        ]
    return tuple(tracks)


def _places(script: Script, names: Sequence[str]) -> tuple[KeyPlace, ...]:
    items = ((name, script.poses if name == POSES else script.tracks[name].keys) for name in names)
    places = [KeyPlace(name, item.time) for name, keys in items for item in keys]
    return tuple(sorted(places, key=attrgetter("time")))


def _held(poses: Sequence[Pose]) -> tuple[tuple[float, float], ...]:
    """Where two poses in a row are the same."""
    pairs = itertools.pairwise(poses)
    return tuple((one.time, other.time) for one, other in pairs if one.values == other.values)


def _still(track: Channel) -> tuple[tuple[float, float], ...]:
    """Where two keys in a row have the same value."""
    pairs = itertools.pairwise(track.keys)
    return tuple((a.time, b.time) for a, b in pairs if abs(a.value - b.value) < SAME)


def described(script: Script, places: frozenset[KeyPlace]) -> str:
    """What there is to say about keys at one time: name and time, then what they hold."""
    time = min(place.time for place in places)
    lines = []
    for place in sorted(places):
        if place.track == POSES:
            pose = next(pose for pose in script.poses if pose.time == place.time)
            lines += [_value(name, value) for name, value in pose.values.items() if value]
            lines = lines or ["neutral"]
        else:
            keys = script.tracks[place.track].keys
            value = next(key.value for key in keys if key.time == place.time)
            lines.append(_value(place.track, value))
    more = [f"and {len(lines) - MOST_LINES} more"] if len(lines) > MOST_LINES else []
    return "\n".join([_title(script, places, time), *lines[:MOST_LINES], *more])


def _value(name: str, value: float) -> str:
    return f"{readable(name)} {value:.2f}"


def _title(script: Script, places: frozenset[KeyPlace], time: float) -> str:
    """The pose's name if it has one, the time, and how the key is approached if not as usual."""
    name, easings = "", set()
    for pose in script.poses:
        if KeyPlace(POSES, pose.time) in places:
            name = pose.name or ""
            easings.add(pose.easing)
    for control, track in script.tracks.items():
        easings |= {key.easing for key in track.keys if KeyPlace(control, key.time) in places}
    special = sorted(easings - {"smooth"})
    return ", ".join(part for part in (name, f"{time:.2f} s", *special) if part)
