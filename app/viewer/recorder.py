"""Movements of controls over time, as the tracks of a script."""

from __future__ import annotations

from array import array
from collections.abc import Mapping
from dataclasses import replace

from ..script import Channel, Script, rounded, thinned


class Recorder:
    """Takes the value of every control at every step; `script` is what was played."""

    def __init__(self, played: Script) -> None:
        """played: the script that the recording takes the place of."""
        self._empty = replace(
            played, title="Recording", source="Recording", poses=(), tracks={}, preface=""
        )
        self.time = 0.0
        # Of each control that has moved: times [s] and values from the last key of its track on.
        self._samples: dict[str, tuple[array[float], array[float]]] = {}
        self._tracks: dict[str, Channel] = {}
        thinned([0.0, 1.0], [0.0, 1.0])  # if this must be compiled, then before anything moves

    def add(self, seconds: float, values: Mapping[str, float]) -> None:
        """`seconds` went by since the last call, and the controls are now at `values`.

        Nothing is taken where no time went by.
        """
        if seconds <= 0.0:
            return
        before, self.time = self.time, self.time + seconds
        for name, value in values.items():
            if name not in self._samples:
                if value == 0.0:
                    continue
                first = 0.0 if before else value
                self._samples[name] = array("d", [0.0]), array("d", [first])
            times, its_values = self._samples[name]
            if value != its_values[-1]:
                if times[-1] < before:
                    times.append(before)
                    its_values.append(its_values[-1])
                times.append(self.time)
                its_values.append(value)

    def script(self) -> Script | None:
        """What was recorded so far, or None where nothing was.

        Only what is new since the last call is thinned, so that a long recording does not stutter.
        """
        for name, (times, values) in self._samples.items():
            if name not in self._tracks:
                self._tracks[name] = thinned(times, values)
            elif len(times) > 1:
                self._tracks[name] = self._tracks[name].continued(thinned(times, values))
            del times[:-1], values[:-1]
        if self.time <= 0.0 or not self._tracks:
            return None
        tracks = dict(sorted(self._tracks.items()))
        return replace(self._empty, duration=rounded(self.time), tracks=tracks)
