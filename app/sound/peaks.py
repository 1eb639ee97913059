"""How far a sound swings in each of many equal stretches of time, quickly, whatever the zoom.

A pyramid, as in audio editors: each level holds the lowest and highest sample of blocks that are
BLOCK times as long as those below; the lowest level is the sound itself. Stretches are read from
the coarsest level of which each has several blocks.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from .decoding import Sound

BLOCK = 8  # blocks of a level that make one of the next
LEAST = 4  # blocks of a stretch, so that its edges are seen at the right place

Swings = npt.NDArray[np.int16]


class Peaks:
    """The swings of a sound, of both its sides together; made once, asked often."""

    def __init__(self, sound: Sound) -> None:
        self._rate = sound.rate
        sides = sound.samples[:, 0], sound.samples[:, -1]
        low, high = _blocks(np.minimum(*sides), np.maximum(*sides))
        self._loudest = float(max(-int(low.min()), int(high.max()), 1))
        self._sides = sides
        self._levels = [(low, high)]
        while len(low) > BLOCK:
            low, high = _blocks(low, high)
            self._levels.append((low, high))

    def between(
        self, start: float, end: float, count: int
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """The lowest and highest value in each of `count` equal stretches of a time [s].

        Each (count,), from -1 to 1, which is as far as the sound ever swings: a quiet recording is
        seen, too. 0 where there is no sound.
        """
        edges = np.linspace(start, end, count + 1) * self._rate
        longest = (edges[-1] - edges[0]) / count / LEAST  # block [samples]
        level, length = 0, 1
        while length * BLOCK <= longest and level < len(self._levels):
            level, length = level + 1, length * BLOCK
        first = np.floor(edges / length).astype(np.int64)
        low, high = self._level(level, max(int(first[0]), 0), int(first[-1]) + 1)
        places = first[:-1] - max(int(first[0]), 0)
        is_there = (places >= 0) & (places < len(low))
        swings = np.zeros((2, count))
        if is_there.any():
            swings[0, is_there] = np.minimum.reduceat(low, places[is_there])
            swings[1, is_there] = np.maximum.reduceat(high, places[is_there])
        return swings[0] / self._loudest, swings[1] / self._loudest

    def _level(self, level: int, first: int, end: int) -> tuple[Swings, Swings]:
        """The lowest and highest of blocks of a level, from one to another."""
        if level:
            low, high = self._levels[level - 1]
            return low[first:end], high[first:end]
        left, right = (side[first:end] for side in self._sides)
        return np.minimum(left, right), np.maximum(left, right)


def _blocks(low: Swings, high: Swings) -> tuple[Swings, Swings]:
    """The next level: BLOCK of each make one."""
    starts = np.arange(0, len(low), BLOCK)
    return np.minimum.reduceat(low, starts), np.maximum.reduceat(high, starts)
