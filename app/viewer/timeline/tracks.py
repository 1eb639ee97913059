"""The rows of the timeline, a track each: which keys each has, and which of them are meant."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from ...controls.vocabulary import readable
from ...script import EASING_NAMES, Channel, Pose, Script
from ...script.keyframes import POSES, places_of
from ...script.places import Places

TRACKS, ALL = "Tracks", "Whole poses"  # names of rows
MOST_LINES = 7  # of a key's values that are told


@dataclass(frozen=True)
class Track:
    """One row: the keys of the poses, of tracks together, or those that move one control."""

    name: str  # no other row has it
    label: str
    places: Places
    channel: Channel = field(default_factory=partial(Channel, (), ()))  # of one control
    control: str = ""  # which that is
    track: str = ""  # that its keys are in
    parents: tuple[str, ...] = ()  # the names of the rows that it is folded into
    names: tuple[tuple[float, str], ...] = ()  # of poses, by time [s]
    held: tuple[tuple[float, float], ...] = ()  # from, to [s]: two poses in a row are the same
    is_whole: bool = False  # poses, which are keys of all controls
    is_sum: bool = False  # of the rows below it, which may be folded
    number: int = 0  # among all rows

    @property
    def height(self) -> float:
        """Of the row, in ordinary ones: above the keys of poses is room for names."""
        return 1.75 if self.is_whole else 1.0


def all_tracks(script: Script, groups: Mapping[str, Sequence[str]]) -> tuple[Track, ...]:
    """The poses and each control that they name, then the tracks by the groups of controls."""
    rows, times = list[Track](), places_of(script).times
    if script.poses or not script.tracks:
        names = tuple((pose.time, pose.name) for pose in script.poses if pose.name)
        poses = Places({POSES: times.pop(POSES, np.empty(0))})
        whole = Track(ALL, "Poses", poses, names=names, held=_held(script.poses), is_whole=True)
        rows.append(replace(whole, is_sum=bool(script.posed_names)))
        for name in script.posed_names:
            channel = script.posed_channel(name)
            row = Track(f"pose {name}", readable(name), poses, channel, name, POSES, (ALL,))
            rows.append(row)
    if script.tracks:
        rows.append(Track(TRACKS, TRACKS, Places(times), is_sum=True))
    for title, controls in groups.items():
        inside = {name: times[name] for name in controls if name in script.tracks}
        parents: tuple[str, ...] = (TRACKS,)
        if 0 < len(inside) < len(script.tracks):
            group = Track(f"{TRACKS}: {title}", title, Places(inside), parents=parents, is_sum=True)
            rows.append(group)
            parents = TRACKS, group.name
        for name in inside:
            alone, channel = Places({name: times[name]}), script.tracks[name]
            rows.append(Track(f"track {name}", readable(name), alone, channel, name, name, parents))
    return tuple(replace(row, number=number) for number, row in enumerate(rows))


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
