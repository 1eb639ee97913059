"""Changes of a script's keys: set, move, copy, delete, rename. Each gives a new script.

A key is known by its track and its time. The whole poses count as one track; no track has two keys
at one time, so a key that arrives where another is takes its place.
"""

from __future__ import annotations

import bisect
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from operator import attrgetter
from typing import Any, NamedTuple, TypeVar

from ..errors import UserError
from ..scenes import clamped
from ..script import LARGEST, Channel, Key, Limits, Pose, Script, rounded

POSES = ""  # the track of whole poses; any other is called as its control is
FRAME = 1.0 / 30.0  # [s] to which times are rounded, as in the films that the window makes
SAME = 1e-6  # of a value or a time [s]: no difference


class KeyPlace(NamedTuple):
    """Where a key is: the track, and the time [s] in it."""

    track: str
    time: float


Places = Collection[KeyPlace]
AnyKey = Pose | Key
Item = TypeVar("Item", bound=AnyKey)


def keys_by_track(script: Script) -> dict[str, Sequence[AnyKey]]:
    """All keys that a script has; the poses come first."""
    return {POSES: script.poses} | {name: track.keys for name, track in script.tracks.items()}


def places_of(script: Script) -> frozenset[KeyPlace]:
    """Where all keys of a script are."""
    tracks = keys_by_track(script).items()
    return frozenset(KeyPlace(name, key.time) for name, keys in tracks for key in keys)


def on_frame(time: float) -> float:
    """The time of the nearest frame [s]."""
    return rounded(round(time / FRAME) * FRAME)


def key_time(script: Script, time: float) -> float:
    """Where a key set at `time` goes: to one that is less than half a frame away, or a frame."""
    times = {place.time for place in places_of(script)}
    near = min(times, key=lambda each: abs(each - time), default=time)
    return near if abs(near - time) < 0.5 * FRAME else on_frame(time)


def pose_at(script: Script, time: float) -> Pose | None:
    """The pose at just this time, if there is one."""
    return next((pose for pose in script.poses if abs(pose.time - time) < SAME), None)


# Changes


def moved(script: Script, places: Places, seconds: float) -> tuple[Script, frozenset[KeyPlace]]:
    """The script with keys later by `seconds` (none before 0), and where they are then."""
    return _placed(_left(script, places), script, places, seconds)


def copied(script: Script, places: Places, seconds: float) -> tuple[Script, frozenset[KeyPlace]]:
    """The script with copies of keys later by `seconds` (none before 0), and where these are."""
    return _placed(script, script, places, seconds)


def without(script: Script, places: Places) -> Script:
    """The script without these keys; UserError where none would be left."""
    left = _left(script, places)
    if not places_of(left):
        raise UserError("a script needs at least one key, so these stay")
    return left


def renamed(script: Script, time: float, name: str) -> Script:
    """The script with another name for the pose at this time; "" for none."""
    poses = [
        replace(pose, name=name.strip() or None) if pose.time == time else pose
        for pose in script.poses
    ]
    return _reaching(replace(script, poses=tuple(poses)), time)


def eased(script: Script, places: Places, easing: str) -> Script:
    """The script with these keys approached in another way."""
    chosen = frozenset(places)
    return _each(script, lambda place, key: replace(key, easing=easing) if place in chosen else key)


def lasting(script: Script, seconds: float) -> Script:
    """The script with another duration, which leaves out no named pose."""
    ends = [pose.time for pose in script.key_poses]
    return replace(script, duration=min(max(on_frame(seconds), FRAME, *ends), LARGEST))


def keyed(script: Script, time: float, values: Mapping[str, float], limits: Limits) -> Script:
    """The script with a key that shows these values at `time` [s].

    The key is a pose, which holds what the tracks do not add; where a pose cannot (a track closes
    the eye, and it shall be open) the track gets a key, too. In a script of tracks alone, as
    recordings are, those get keys that differ; all of them where nothing does.
    """
    time = rounded(time)
    plain = script.posed(time)
    added = {name: track.value(time) for name, track in script.tracks.items()}
    before = clamped(limits, script.at(time))
    changed = [name for name in values if abs(values[name] - before.get(name, 0.0)) > SAME]
    if script.tracks and not script.poses:
        return _with_track_keys(
            _reaching(script, time), time, {name: values[name] for name in changed or script.tracks}
        )
    wanted = plain | {name: values[name] - added.get(name, 0.0) for name in changed}
    posed = {name: rounded(value) for name, value in clamped(limits, wanted).items()}
    rest = {name: values[name] - posed[name] for name in changed if name in script.tracks}
    differing = {name: value for name, value in rest.items() if abs(value - added[name]) > SAME}
    present = pose_at(script, time)
    pose = Pose(
        present.time if present else time,
        {name: value for name, value in posed.items() if value},
        present.easing if present else _easing_at(script.poses, time),
        present.name if present else None,
    )
    with_pose = replace(script, poses=tuple(_merged(script.poses, [pose])))
    return _reaching(_with_track_keys(with_pose, time, differing), time)


def _with_track_keys(script: Script, time: float, values: Mapping[str, float]) -> Script:
    """The script with a key in each of these tracks, which are made where they are not there."""
    tracks = dict(script.tracks)
    for name, value in values.items():
        keys = tracks[name].keys if name in tracks else ()
        before = next((key for key in keys if abs(key.time - time) < SAME), None)
        easing = before.easing if before else _easing_at(keys, time)
        key = Key(before.time if before else time, rounded(value), easing)
        tracks[name] = Channel.of(_merged(keys, [key]))
    return replace(script, tracks=tracks)


def _easing_at(keys: Iterable[Pose] | Iterable[Key], time: float) -> str:
    """How a new key is approached: as the one after it is."""
    return next((key.easing for key in keys if key.time > time), "smooth")


# How they are made


def _each(script: Script, change: Callable[[KeyPlace, AnyKey], AnyKey | None]) -> Script:
    """The script with each key as `change` gives it back, without those that it does not."""
    changed = {
        name: [change(KeyPlace(name, key.time), key) for key in keys]
        for name, keys in keys_by_track(script).items()
    }
    return _with(script, {name: filter(None, keys) for name, keys in changed.items()})


def _left(script: Script, places: Places) -> Script:
    """The script without these keys, of which there may be none left."""
    gone = frozenset(places)
    return _each(script, lambda place, key: None if place in gone else key)


def _placed(
    base: Script, source: Script, places: Places, seconds: float
) -> tuple[Script, frozenset[KeyPlace]]:
    """`base` with the keys of `source` at these places, later by `seconds`; and these alone."""
    shift = max(seconds, -min((place.time for place in places), default=0.0))
    chosen = frozenset(places)

    def arrive(place: KeyPlace, key: AnyKey) -> AnyKey | None:
        """The key as it is then, if it is meant."""
        return replace(key, time=rounded(key.time + shift)) if place in chosen else None

    arriving = _each(source, arrive)
    there, coming = keys_by_track(base), keys_by_track(arriving)
    merged = {
        name: _merged(there.get(name, ()), coming.get(name, ())) for name in keys_by_track(source)
    }
    arrived = places_of(arriving)
    return _reaching(_with(base, merged), *(place.time for place in arrived)), arrived


def _merged(there: Iterable[Item], arriving: Iterable[Item]) -> list[Item]:
    """Both in the order of time; what arrives takes the place of what is there."""
    result: list[Item] = list(arriving)
    taken_times = sorted(item.time for item in result)
    result += [item for item in there if not _is_among(item.time, taken_times)]
    result.sort(key=attrgetter("time"))
    return result


def _is_among(time: float, times: list[float]) -> bool:
    """Whether one of these times, which are in order, is the same [s]."""
    after = bisect.bisect_left(times, time - SAME)
    return after < len(times) and times[after] <= time + SAME


def _with(script: Script, tracks: Mapping[str, Iterable[Any]]) -> Script:
    """The script with other keys; a track without any is none."""
    keys = {name: tuple(each) for name, each in tracks.items()}
    channels = {name: Channel.of(each) for name, each in keys.items() if each and name != POSES}
    return replace(script, poses=keys.get(POSES, ()), tracks=channels)


def _reaching(script: Script, *times: float) -> Script:
    """The script, made longer where it ends before one of these times [s]."""
    return replace(script, duration=max([script.duration, *times]))
