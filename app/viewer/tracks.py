"""The rows of the timeline, a track each: which keys each has, and which of them are meant."""

from __future__ import annotations

import bisect
import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from operator import attrgetter

from ..script import Channel, Pose, Script
from .control_rows import readable
from .keyframes import POSES, SAME, KeyPlace, keys_by_track

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
    keys = keys_by_track(script)
    places = [KeyPlace(name, key.time) for name in names for key in keys[name]]
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
    """What there is to say about keys at one time: a title, then the values that they hold."""
    name, lines, easings = "", list[str](), set[str]()
    for track, keys in sorted(keys_by_track(script).items()):  # the poses come first
        for key in keys:
            if KeyPlace(track, key.time) not in places:
                continue
            easings.add(key.easing)
            if isinstance(key, Pose):
                name = key.name or ""
                lines += [_value(*each) for each in key.values.items() if each[1]] or ["neutral"]
            else:
                lines.append(_value(track, key.value))
    time = f"{min(place.time for place in places):.2f} s"
    title = ", ".join(filter(None, (name, time, *sorted(easings - {"smooth"}))))
    more = [f"and {len(lines) - MOST_LINES} more"] if len(lines) > MOST_LINES else []
    return "\n".join([title, *lines[:MOST_LINES], *more])


def _value(name: str, value: float) -> str:
    return f"{readable(name)} {value:.2f}"
