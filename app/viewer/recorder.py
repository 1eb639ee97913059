"""Movements of controls over time, as the tracks of a script."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from ..script import Channel, Key, Script, rounded

TOLERANCE = 2e-3  # of a value: what a straight line between keys may be off


class Recorder:
    """Takes the value of every control at every step; `script` is what was played."""

    def __init__(self, empty: Script) -> None:
        """empty: the script without tracks, which gets those that are recorded."""
        self._empty = empty
        self.time = 0.0
        self._tracks: dict[str, list[tuple[float, float]]] = {}
        self._drafts: dict[str, tuple[list[tuple[float, float]], int]] = {}

    def add(self, seconds: float, values: Mapping[str, float]) -> None:
        """`seconds` went by since the last call, and the controls are now at `values`."""
        before, self.time = self.time, self.time + seconds
        for name, value in values.items():
            track = self._tracks.get(name)
            if track is None:
                if value == 0.0:
                    continue
                track = self._tracks[name] = [(0.0, 0.0 if before else value)]
            if value != track[-1][1]:
                if track[-1][0] < before:
                    track.append((before, track[-1][1]))
                track.append((self.time, value))

    def script(self) -> Script | None:
        """What was recorded, or None where nothing was."""
        return self._with({name: straightened(track) for name, track in self._tracks.items()})

    def draft(self) -> Script | None:
        """The same so far, with a few more keys: only what is new since the last one is thinned."""
        for name, track in self._tracks.items():
            thinned, count = self._drafts.get(name, (track[:1], 1))
            if len(track) > count:
                thinned += straightened(track[count - 1 :])[1:]
            self._drafts[name] = thinned, len(track)
        return self._with({name: thinned for name, (thinned, _) in self._drafts.items()})

    def _with(self, tracks: Mapping[str, list[tuple[float, float]]]) -> Script | None:
        if self.time <= 0.0 or not tracks:
            return None
        channels = {
            name: Channel(
                tuple(Key(rounded(time), rounded(value), "linear") for time, value in each)
            )
            for name, each in sorted(tracks.items())
        }
        return replace(self._empty, duration=rounded(self.time), tracks=channels)


def straightened(track: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Leave out keys that lie on a straight line between others (Ramer, Douglas, Peucker)."""
    corners = {0, len(track) - 1}
    spans = [(0, len(track) - 1)]
    while spans:
        first, last = spans.pop()
        (start, low), (end, high) = track[first], track[last]
        most, worst = TOLERANCE, -1
        for index in range(first + 1, last):
            time, value = track[index]
            off = abs(low + (high - low) * (time - start) / (end - start) - value)
            if off > most:
                most, worst = off, index
        if worst >= 0:
            corners.add(worst)
            spans += [(first, worst), (worst, last)]
    return [track[index] for index in sorted(corners)]
