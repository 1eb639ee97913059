"""How far a sound swings in each of many equal stretches of time, quickly, whatever the zoom.

A pyramid, as in audio editors: each level holds the lowest and highest sample of blocks that are
BLOCK times as long as those below; the lowest level is the sound itself. Stretches are read from
the coarsest level of which each has several blocks.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from .decoding import Sound

BLOCK = 32  # blocks of a level that make one of the next
LEAST = 4  # blocks of a stretch, so that its edges are seen at the right place


class _Level(NamedTuple):
    """The lowest and highest of every block of so many frames, which has so many entries."""

    frames: int
    entries: int  # a frame of the sound itself has one for each channel
    low: npt.NDArray[np.int16]
    high: npt.NDArray[np.int16]

    def coarser(self) -> _Level:
        """The next level."""
        starts = np.arange(0, len(self.low), BLOCK * self.entries)
        low = np.minimum.reduceat(self.low, starts)
        high = np.maximum.reduceat(self.high, starts)
        return _Level(self.frames * BLOCK, 1, low, high)


class Peaks:
    """The swings of a sound, of all channels together; made once, asked often."""

    def __init__(self, sound: Sound) -> None:
        self._rate = sound.rate
        samples = sound.samples.reshape(-1)
        level = _Level(1, sound.samples.shape[1], samples, samples)
        self._levels = [level]
        while len(level.low) > BLOCK:
            level = level.coarser()
            self._levels.append(level)
        self._loudest = max(-int(level.low.min()), int(level.high.max()), 1)

    def between(
        self, start: float, end: float, count: int
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """The lowest and highest value in each of `count` equal stretches of a time [s].

        Each (count,), from -1 to 1, which is as far as the sound ever swings: a quiet recording is
        seen, too. 0 where there is no sound. start: not below 0.
        """
        edges = np.linspace(start, end, count + 1) * self._rate
        longest = (edges[-1] - edges[0]) / count / LEAST
        level = next(
            (each for each in reversed(self._levels) if each.frames <= longest), self._levels[0]
        )
        places = np.floor(edges / level.frames).astype(np.int64) * level.entries
        places = places[places < len(level.low)]
        inside = slice(len(places[:count]))
        swings = np.zeros((2, count))
        if inside.stop:
            end_of_last = places[-1] if len(places) > count else len(level.low)
            part = slice(places[0], max(end_of_last, places[:count][-1] + level.entries))
            begins = places[:count] - places[0]
            swings[0, inside] = np.minimum.reduceat(level.low[part], begins)
            swings[1, inside] = np.maximum.reduceat(level.high[part], begins)
        return swings[0] / self._loudest, swings[1] / self._loudest
