"""Changes of a script's keys: set, move, copy, delete, rename. Each gives a new script.

A key is known by its track and its time. The whole poses count as one track. No track has two keys
at one time, so a key that arrives at another replaces it. Tracks that are not changed are shared by
both scripts.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from ..control_names.limits import ControlValues, Limits
from ..errors import UserError
from . import DECIMALS, LARGEST, Channel, Key, Pose, Script, rounded
from .easings import easing_named
from .places import Places, among

POSES = ""  # the track of whole poses; any other has its control's name
FRAME = 1.0 / 30.0  # [s] to which times are rounded, like frames of the window's films
SAME = 1e-6  # of a value or a time [s]: no difference

# The keys of a track as arrays: times [s], then values and easings, or the poses.
Columns = tuple[npt.NDArray[Any], ...]
Values = Mapping[str, float]
Placed = tuple[Script, Places]  # a script, and places of some of its keys


def places_of(script: Script) -> Places:
    """The places of all keys of a script; the poses come first."""
    poses = {POSES: np.array([pose.time for pose in script.poses])}
    return Places(poses | {name: track.times for name, track in script.tracks.items()})


def on_frame(time: float) -> float:
    """The time of the nearest frame [s]."""
    return rounded(round(time / FRAME) * FRAME)


def key_time(script: Script, time: float) -> float:
    """The time for a key set at `time`: that of a key within half a frame, or of a frame."""
    near = places_of(script).near(time, 0.5 * FRAME)
    return near.first if near else on_frame(time)


def time_beyond(script: Script, time: float, direction: int) -> float:
    """The next time with a key, or with -1 the previous one; else `time` [s]."""
    all_times = places_of(script).times.values()
    if direction > 0:
        later = (times[np.searchsorted(times, time + SAME, "right") :][:1] for times in all_times)
        return float(min(np.concatenate([*later, []]), default=time))
    earlier = (times[: np.searchsorted(times, time - SAME)][-1:] for times in all_times)
    return float(max(np.concatenate([*earlier, []]), default=time))


def pose_at(script: Script, time: float) -> Pose | None:
    """The pose at just this time, if there is one."""
    return next((pose for pose in script.poses if abs(pose.time - time) < SAME), None)


# Changes


def moved(script: Script, places: Places, seconds: float, source: Script | None = None) -> Placed:
    """The script with keys later by `seconds` (none before 0), and their new places.

    source: the script whose keys are copied; None: the keys are moved.
    """
    shift = max(seconds, -places.first) if places else 0.0
    changed = {}
    arrived = {}
    before = _columns(script, places)
    for name, columns in _columns(source or script, places).items():
        is_chosen = among(columns[0], places.times[name])
        times, *rest = _picked(columns, is_chosen)
        arrived[name] = np.round(times + shift, DECIMALS)
        nothing = _picked(columns, np.arange(0))
        there = before.get(name, nothing) if source else _picked(columns, ~is_chosen)
        changed[name] = _joined(there, (arrived[name], *rest))
    ends = [float(times[-1]) for times in arrived.values() if len(times)]
    return _reaching(_with(script, changed), *ends), Places(arrived)


def without(script: Script, places: Places) -> Script:
    """The script without these keys; raises UserError if none would be left."""
    columns = _columns(script, places)
    left = _with(
        script,
        {
            name: _picked(each, ~among(each[0], places.times[name]))
            for name, each in columns.items()
        },
    )
    if not (left.poses or left.tracks):
        raise UserError("a script needs at least one key, so these stay")
    return left


def eased(script: Script, places: Places, easing: str) -> Script:
    """The script with another easing for these keys."""
    changed = {}
    for name, columns in _columns(script, places).items():
        is_chosen = among(columns[0], places.times[name])
        last = columns[-1].copy()  # the easings, or the poses with theirs
        if name == POSES:
            last[is_chosen] = [replace(pose, easing=easing) for pose in last[is_chosen]]
        else:
            last[is_chosen] = easing_named(easing)
        changed[name] = (*columns[:-1], last)
    return _with(script, changed)


def raised(
    script: Script, places: Places, amount: float, limits: Limits, posed: Iterable[str]
) -> Script:
    """The script with these keys raised within limits; poses only in the controls `posed`."""
    poses = script.poses
    tracks = dict(script.tracks)
    for name, times in places.times.items():
        if name == POSES:
            at = set(times.tolist())
            poses = tuple(p.raised(posed, amount, limits) if p.time in at else p for p in poses)
        else:
            low, high = limits[name]
            if name in script.posed_names:  # a track may add anything to these
                low, high = low - high, high - low
            track = tracks[name]
            tracks[name] = track.raised(among(track.times, times), amount, low, high)
    return replace(script, poses=poses, tracks=tracks)


def lasting(script: Script, seconds: float) -> Script:
    """The script with another duration, which still includes all named poses."""
    ends = [pose.time for pose in script.key_poses]
    return replace(script, duration=min(max(on_frame(seconds), FRAME, *ends), LARGEST))


def differing(script: Script, time: float, values: ControlValues) -> list[str]:
    """The controls whose values differ from the script's at `time` [s]."""
    is_away = np.abs(values.numbers - script.values(time, values.limits).numbers) > SAME
    return [name for name, differs in zip(values, is_away.tolist(), strict=True) if differs]


def keyed(script: Script, time: float, values: ControlValues) -> Script:
    """The script with a key that shows these values at `time` [s].

    The key is a pose: the values minus those of the tracks. If a pose cannot reach a value (a track
    closes the eye, but it shall be open), the track also gets a key. In a script of tracks alone,
    such as a recording, tracks that differ get keys, or all tracks if none differs.
    """
    time = rounded(time)
    plain = script.posed(time)
    added = {name: track.value(time) for name, track in script.tracks.items()}
    changed = differing(script, time, values)
    if script.tracks and not script.poses:
        keys = {name: values[name] for name in sorted(changed or script.tracks)}
        return _with_track_keys(_reaching(script, time), time, keys)
    wanted = plain | {name: values[name] - added.get(name, 0.0) for name in changed}
    possible = values.limits.pose(wanted)
    posed = {name: rounded(possible[name]) for name in wanted}
    rest = {name: values[name] - posed[name] for name in changed if name in script.tracks}
    keys = {name: value for name, value in rest.items() if abs(value - added[name]) > SAME}
    present = pose_at(script, time)
    nonzero = {name: value for name, value in posed.items() if value}
    if present:
        pose = replace(present, values=nonzero)
    else:
        pose = Pose(time, nonzero, _easing_at(script.poses, time), None)
    poses = _joined(_pose_columns(script.poses), _pose_columns([pose]))
    with_pose = _with(script, {POSES: poses})
    return _reaching(_with_track_keys(with_pose, time, keys), time)


def keyed_alone(script: Script, time: float, values: ControlValues, names: Iterable[str]) -> Script:
    """The script with keys of these controls alone, which show their values at `time` [s].

    A pose at this time takes the controls that no track moves. The others get a key in a track,
    which is added to the poses. A new track is 0 at the poses before and after, so that the motion
    beyond them does not change.
    """
    time = rounded(time)
    posed = script.posed(time)
    present = pose_at(script, time)
    changed = dict(present.values) if present else {}
    keys = {}
    for name in sorted(names):
        if present and name not in script.tracks:
            changed[name] = values[name]
        else:
            keys[name] = values[name] - posed.get(name, 0.0)
    if present:
        nonzero = {name: value for name, value in changed.items() if value}
        pose = replace(present, values=nonzero)
        poses = tuple(pose if each is present else each for each in script.poses)
        script = replace(script, poses=poses)
    new = {name: 0.0 for name in keys if name not in script.tracks}
    earlier = [pose.time for pose in script.poses if pose.time < time - SAME]
    later = [pose.time for pose in script.poses if pose.time > time + SAME]
    for end in (*earlier[-1:], *later[:1]):
        script = _with_track_keys(script, end, new)
    return _reaching(_with_track_keys(script, time, keys), time)


def _with_track_keys(script: Script, time: float, values: Values) -> Script:
    """The script with a key in each of these tracks; missing ones are made."""
    changed = {}
    for name, value in values.items():
        track = script.tracks.get(name, Channel([], []))
        present = np.flatnonzero(np.abs(track.times - time) < SAME)
        later = np.flatnonzero(track.times > time)
        key_time = float(track.times[present[0]]) if len(present) else time
        after = present if len(present) else later
        easing = track.easing(after[0]).name if len(after) else "smooth"
        key = Key(key_time, rounded(value), easing)
        changed[name] = _joined(_channel_columns(track), _channel_columns(Channel.of([key])))
    return _with(script, changed)


def _easing_at(poses: Iterable[Pose], time: float) -> str:
    """The easing of a new pose: that of the pose after it."""
    return next((pose.easing for pose in poses if pose.time > time), "smooth")


# Construction


def _columns(script: Script, places: Places) -> dict[str, Columns]:
    """All keys of the tracks with any of these places."""
    columns = {POSES: _pose_columns(script.poses)} if POSES in places.times else {}
    return columns | {
        name: _channel_columns(track)
        for name, track in script.tracks.items()
        if name in places.times
    }


def _channel_columns(track: Channel) -> Columns:
    return track.times, track.values, track.easings


def _pose_columns(poses: Sequence[Pose]) -> Columns:
    column = np.empty(len(poses), object)
    column[:] = poses
    return np.array([pose.time for pose in poses]), column


def _picked(columns: Columns, which: npt.NDArray[Any]) -> Columns:
    """Some keys; which: a mask, or their numbers."""
    return tuple(column[which] for column in columns)


def _joined(there: Columns, arriving: Columns) -> Columns:
    """Both in the order of time; an arriving key replaces one at the same time."""
    left = _picked(there, ~among(there[0], arriving[0], SAME))
    if not len(left[0]):
        return arriving
    both = tuple(np.concatenate(pair) for pair in zip(left, arriving, strict=True))
    return _picked(both, np.argsort(both[0], kind="stable"))


def _with(script: Script, changed: Mapping[str, Columns]) -> Script:
    """The script with other keys in some tracks; a track without keys is removed."""
    poses = script.poses
    tracks = dict(script.tracks)
    for name, columns in changed.items():
        if name == POSES:
            pairs = zip(*(column.tolist() for column in columns), strict=True)
            poses = tuple(replace(pose, time=time) for time, pose in pairs)
        elif len(columns[0]):
            tracks[name] = Channel(*columns)
        else:
            tracks.pop(name)
    return replace(script, poses=poses, tracks=tracks)


def _reaching(script: Script, *times: float) -> Script:
    """The script, extended if it ends before one of its keys."""
    return replace(script, duration=max([script.duration, *times]))
