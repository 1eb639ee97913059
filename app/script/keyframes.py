"""Changes of a script's keys: set, move, copy, delete, rename. Each function returns a new script.

Track and time identify a key. All whole poses together are one track. No track has two keys at the
same time, so a key that is moved to the time of another key replaces it. The new script shares
unchanged tracks with the old one.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from ..control_names.limits import ControlValues, Limits
from ..errors import UserError
from . import LARGEST_NUMBER, SCRIPT_DECIMALS, Channel, Key, Pose, Script, rounded
from .easings import easing_named
from .key_sets import KeySet, is_any_of

POSE_TRACK = ""  # the track of whole poses; any other track has its control's name
FRAME_TIME = 1.0 / 30.0  # [s] to which times are rounded; films of the window have such frames
EQUAL_TOLERANCE = 1e-6  # values, or times [s], that differ by less are equal

# The keys of a track as arrays: times [s], then values and easings, or the poses.
KeyColumns = tuple[npt.NDArray[Any], ...]
ScriptAndKeys = tuple[Script, KeySet]  # a script, and some of its keys


def all_keys(script: Script) -> KeySet:
    """Return the tracks and times of all keys of a script, the poses first."""
    poses = {POSE_TRACK: np.array([pose.time for pose in script.poses])}
    return KeySet(poses | {name: track.times for name, track in script.tracks.items()})


def on_frame(time: float) -> float:
    """Return the time of the nearest frame [s]."""
    return rounded(round(time / FRAME_TIME) * FRAME_TIME)


def key_time(script: Script, time: float) -> float:
    """Return the time of a key within half a frame [s], or else of the nearest frame."""
    near = all_keys(script).nearest(time, 0.5 * FRAME_TIME)
    return near.first if near else on_frame(time)


def time_beyond(script: Script, time: float, direction: int) -> float:
    """Return the next key time [s], or the previous one for direction -1; else `time`."""
    all_times = all_keys(script).times.values()
    if direction > 0:
        later = (
            times[np.searchsorted(times, time + EQUAL_TOLERANCE, "right") :][:1]
            for times in all_times
        )
        return float(min(np.concatenate([*later, []]), default=time))
    earlier = (times[: np.searchsorted(times, time - EQUAL_TOLERANCE)][-1:] for times in all_times)
    return float(max(np.concatenate([*earlier, []]), default=time))


def pose_at(script: Script, time: float) -> Pose | None:
    """Return the pose at exactly this time [s], or None."""
    return next((pose for pose in script.poses if abs(pose.time - time) < EQUAL_TOLERANCE), None)


# Changes


def moved(
    script: Script, chosen: KeySet, seconds: float, source: Script | None = None
) -> ScriptAndKeys:
    """Move keys later by `seconds`, none before 0; return the script and the keys there.

    source: the script whose keys are copied; None: the keys are moved.
    """
    shift = max(seconds, -chosen.first) if chosen else 0.0
    changed = {}
    arrived = {}
    before = _columns(script, chosen)
    for name, columns in _columns(source or script, chosen).items():
        is_chosen = is_any_of(columns[0], chosen.times[name])
        times, *rest = _chosen_keys(columns, is_chosen)
        arrived[name] = np.round(times + shift, SCRIPT_DECIMALS)
        nothing = _chosen_keys(columns, np.arange(0))
        there = before.get(name, nothing) if source else _chosen_keys(columns, ~is_chosen)
        changed[name] = _merged_keys(there, (arrived[name], *rest))
    ends = [float(times[-1]) for times in arrived.values() if len(times)]
    return _extended_to(_with_tracks(script, changed), *ends), KeySet(arrived)


def without_keys(script: Script, chosen: KeySet) -> Script:
    """Delete keys; raise UserError if no key would be left."""
    columns = _columns(script, chosen)
    left = _with_tracks(
        script,
        {
            name: _chosen_keys(each, ~is_any_of(each[0], chosen.times[name]))
            for name, each in columns.items()
        },
    )
    if not (left.poses or left.tracks):
        raise UserError("a script needs at least one key, so these stay")
    return left


def eased(script: Script, chosen: KeySet, easing: str) -> Script:
    """Change the easing of keys."""
    changed = {}
    for name, columns in _columns(script, chosen).items():
        is_chosen = is_any_of(columns[0], chosen.times[name])
        last = columns[-1].copy()  # the easings, or the poses, which hold their easings
        if name == POSE_TRACK:
            last[is_chosen] = [replace(pose, easing=easing) for pose in last[is_chosen]]
        else:
            last[is_chosen] = easing_named(easing)
        changed[name] = (*columns[:-1], last)
    return _with_tracks(script, changed)


def raised(
    script: Script, chosen: KeySet, amount: float, limits: Limits, posed: Iterable[str]
) -> Script:
    """Raise the values of keys within limits; in poses, only the controls `posed` are raised."""
    poses = script.poses
    tracks = dict(script.tracks)
    for name, times in chosen.times.items():
        if name == POSE_TRACK:
            chosen_times = set(times.tolist())
            poses = tuple(
                pose.raised(posed, amount, limits) if pose.time in chosen_times else pose
                for pose in poses
            )
        else:
            low, high = limits[name]
            if name in script.posed_names:  # a track may then add up to the whole range
                low, high = low - high, high - low
            track = tracks[name]
            tracks[name] = track.raised(is_any_of(track.times, times), amount, low, high)
    return replace(script, poses=poses, tracks=tracks)


def with_duration(script: Script, seconds: float) -> Script:
    """Change the duration [s] of a script, which still includes all named poses."""
    ends = [pose.time for pose in script.key_poses]
    return replace(script, duration=min(max(on_frame(seconds), FRAME_TIME, *ends), LARGEST_NUMBER))


def differing(script: Script, time: float, values: ControlValues) -> list[str]:
    """Return the controls whose values differ from the script's values at `time` [s]."""
    is_away = np.abs(values.numbers - script.values(time, values.limits).numbers) > EQUAL_TOLERANCE
    return [name for name, differs in zip(values, is_away.tolist(), strict=True) if differs]


def keyed(script: Script, time: float, values: ControlValues) -> Script:
    """Add a key, so that the script has these values at `time` [s].

    The key is a pose: the values minus the values of the tracks. If a pose cannot reach a value
    (a track closes an eye that shall be open), the track also gets a key. In a script without
    poses, such as a recording, the tracks that differ get keys, or all tracks if none differs.
    """
    time = rounded(time)
    plain = script.posed(time)
    added = {name: track.value(time) for name, track in script.tracks.items()}
    changed = differing(script, time, values)
    if script.tracks and not script.poses:
        keys = {name: values[name] for name in sorted(changed or script.tracks)}
        return _with_track_keys(_extended_to(script, time), time, keys)
    wanted = plain | {name: values[name] - added.get(name, 0.0) for name in changed}
    possible = values.limits.pose(wanted)
    posed = {name: rounded(possible[name]) for name in wanted}
    rest = {name: values[name] - posed[name] for name in changed if name in script.tracks}
    keys = {
        name: value for name, value in rest.items() if abs(value - added[name]) > EQUAL_TOLERANCE
    }
    present = pose_at(script, time)
    nonzero = {name: value for name, value in posed.items() if value}
    if present:
        pose = replace(present, values=nonzero)
    else:
        pose = Pose(time, nonzero, _easing_at(script.poses, time), None)
    poses = _merged_keys(_pose_columns(script.poses), _pose_columns([pose]))
    with_pose = _with_tracks(script, {POSE_TRACK: poses})
    return _extended_to(_with_track_keys(with_pose, time, keys), time)


def with_keys_of(
    script: Script, time: float, values: ControlValues, names: Iterable[str]
) -> Script:
    """Add keys for these controls and no others, so that the script has their values at `time` [s].

    If there is a pose at this time, it takes the controls that have no track. Other controls get a
    key in a track, which is added to the poses. A new track is 0 at the poses before and after, so
    that earlier and later motion does not change.
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
    earlier = [pose.time for pose in script.poses if pose.time < time - EQUAL_TOLERANCE]
    later = [pose.time for pose in script.poses if pose.time > time + EQUAL_TOLERANCE]
    for end in (*earlier[-1:], *later[:1]):
        script = _with_track_keys(script, end, new)
    return _extended_to(_with_track_keys(script, time, keys), time)


def _with_track_keys(script: Script, time: float, values: Mapping[str, float]) -> Script:
    """Add a key at `time` [s] to each of these tracks; make missing tracks."""
    changed = {}
    for name, value in values.items():
        track = script.tracks.get(name, Channel([], []))
        present = np.flatnonzero(np.abs(track.times - time) < EQUAL_TOLERANCE)
        later = np.flatnonzero(track.times > time)
        key_time = float(track.times[present[0]]) if len(present) else time
        after = present if len(present) else later
        easing = track.easing(after[0]).name if len(after) else "smooth"
        key = Key(key_time, rounded(value), easing)
        changed[name] = _merged_keys(
            _channel_columns(track), _channel_columns(Channel.from_keys([key]))
        )
    return _with_tracks(script, changed)


def _easing_at(poses: Iterable[Pose], time: float) -> str:
    """Return the easing of a new pose: the easing of the pose after it."""
    return next((pose.easing for pose in poses if pose.time > time), "smooth")


# Construction


def _columns(script: Script, chosen: KeySet) -> dict[str, KeyColumns]:
    """Return all keys of each track that has a chosen key."""
    columns = {POSE_TRACK: _pose_columns(script.poses)} if POSE_TRACK in chosen.times else {}
    return columns | {
        name: _channel_columns(track)
        for name, track in script.tracks.items()
        if name in chosen.times
    }


def _channel_columns(track: Channel) -> KeyColumns:
    return track.times, track.values, track.easings


def _pose_columns(poses: Sequence[Pose]) -> KeyColumns:
    column = np.empty(len(poses), object)
    column[:] = poses
    return np.array([pose.time for pose in poses]), column


def _chosen_keys(columns: KeyColumns, which: npt.NDArray[Any]) -> KeyColumns:
    """Select keys; which: flags or indices."""
    return tuple(column[which] for column in columns)


def _merged_keys(there: KeyColumns, arriving: KeyColumns) -> KeyColumns:
    """Merge keys in the order of time; an arriving key replaces an old key at the same time."""
    left = _chosen_keys(there, ~is_any_of(there[0], arriving[0], EQUAL_TOLERANCE))
    if not len(left[0]):
        return arriving
    both = tuple(np.concatenate(pair) for pair in zip(left, arriving, strict=True))
    return _chosen_keys(both, np.argsort(both[0], kind="stable"))


def _with_tracks(script: Script, changed: Mapping[str, KeyColumns]) -> Script:
    """Replace the keys of some tracks; remove a track without keys."""
    poses = script.poses
    tracks = dict(script.tracks)
    for name, columns in changed.items():
        if name == POSE_TRACK:
            pairs = zip(*(column.tolist() for column in columns), strict=True)
            poses = tuple(replace(pose, time=time) for time, pose in pairs)
        elif len(columns[0]):
            tracks[name] = Channel(*columns)
        else:
            tracks.pop(name)
    return replace(script, poses=poses, tracks=tracks)


def _extended_to(script: Script, *times: float) -> Script:
    """Extend a script that ends before one of these times [s]."""
    return replace(script, duration=max([script.duration, *times]))
