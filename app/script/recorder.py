"""Recording of controls that a user moves while a script plays; the result is a new script.

A control is recorded from the moment when it differs from the script until the recording ends.
Other controls, and all keys before and after the recording, do not change.
"""

from __future__ import annotations

from array import array
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ..control_names.limits import ControlValues
from . import Channel, Key, Script, rounded
from .keyframes import FRAME_TIME, differing
from .thinning import thinned

RELEASE_TIME = 0.1  # [s] at the recording's end in which a control returns to the script


class Recorder:
    """Records the values of all controls at each step, from a time of a script on.

    held: values that the user holds in place of the script's; the caller sets them.
    """

    def __init__(
        self, played: Script, start: float, held: Mapping[str, float] | None = None
    ) -> None:
        """played: the script that plays meanwhile. start: [s]. held: values held at the start."""
        self._played = played
        self.held = dict(held or {})
        self._kept = dict[str, float]()  # held values that are recorded
        self.start = self.time = rounded(start)
        # For each moved control: times [s] and values of its track, from the last key on.
        self.samples: dict[str, tuple[array[float], array[float]]] = {}
        thinned([0.0, 1.0], [0.0, 1.0])  # compiled now, before anything moves

    def add(self, time: float, values: ControlValues) -> None:
        """Record the values of all controls at a time [s], unless the time is recorded already."""
        if time <= self.time:
            return
        before, self.time = self.time, time
        posed = self._played.posed(time)
        at_first = self._played.posed(before)
        for name in differing(self._played, time, values):
            if name not in self.samples:
                if before:
                    first = self._track_value(name, before)
                else:
                    first = values[name] - at_first.get(name, 0.0)
                self.samples[name] = array("d", [before]), array("d", [first])
        for name, (times, track) in self.samples.items():
            value = values[name] - posed.get(name, 0.0)  # a track adds to the poses
            if value != track[-1]:
                if times[-1] < before:
                    times.append(before)
                    track.append(track[-1])
                times.append(time)
                track.append(value)
        self._kept = dict(self.held)

    @property
    def missed(self) -> dict[str, float]:
        """The held values that have changed since the last recorded time."""
        return {name: each for name, each in self.held.items() if self._kept.get(name) != each}

    def script(self) -> Script | None:
        """Return the script with the recording so far, or None if nothing was recorded."""
        if not self.samples:
            return None
        tracks = {
            name: self._joined(name, thinned(*samples))
            for name, samples in sorted(self.samples.items())
        }
        end = max(self._played.duration, rounded(self.time))
        return replace(self._played, duration=end, tracks={**self._played.tracks, **tracks})

    def _track_value(self, name: str, time: float) -> float:
        """Return the value of the script's track of a control, 0 if there is no track."""
        track = self._played.tracks.get(name)
        return track.value(time) if track is not None else 0.0

    def _joined(self, name: str, taken: Channel) -> Channel:
        """Insert a recorded part into the script's track, and return to the track's old values."""
        old = self._played.tracks.get(name, Channel([], []))
        start = rounded(taken.times[0])
        end = rounded(self.time)
        is_last = end >= self._played.duration - FRAME_TIME
        head = [key for key in old.keys if key.time < start]
        tail = [key for key in old.keys if key.time > end]
        keys = list(taken.keys)
        if tail or not is_last:
            free = rounded(max(end - RELEASE_TIME, 0.5 * (start + end)))
            keys = [key for key in keys if key.time < free]
            keys.append(Key(free, taken.value(free), "linear"))
            keys.append(Key(end, self._track_value(name, end), "linear"))
        if start:
            last = head[-1].time if head else start
            keys[:1] = _keys_between(old, last, start)
        if tail and len(tail) < len(old):
            tail[:1] = _keys_between(old, end, tail[0].time)
        return Channel.from_keys([*head, *keys, *tail])


def _keys_between(track: Channel, first: float, last: float) -> list[Key]:
    """Return keys that follow a track from one time to another [s], between two of its keys."""
    following = int(np.searchsorted(track.times, last))
    easing = track.easing(following).name if following < len(track) else "linear"
    value = track.value(last) if len(track) else 0.0
    end = Key(last, value, easing)
    if easing in ("linear", "hold") or {first, last} <= set(track.times.tolist()):
        return [end]  # the easing of a part is the easing of the whole
    # Straight lines between this many samples of an eased curve have errors of 0.0002.
    times = np.linspace(first, last, 64 + 1)
    along = thinned(times, [track.value(time) for time in times.tolist()])
    return [*along.keys[1:-1], replace(end, easing="linear")]
