"""How far a sound swings in each of many equal stretches of time, quickly, whatever the zoom."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from .decoding import Sound

BLOCK = 512  # samples of which the lowest and the highest are known
LEAST = 4  # blocks of a stretch, so that its edges are right; of shorter ones samples are read


class Peaks:
    """The swings of a sound, of all channels together; made once, asked often."""

    def __init__(self, sound: Sound) -> None:
        self._rate = sound.rate
        swings = sound.samples.min(axis=1), sound.samples.max(axis=1)
        starts = np.arange(0, len(sound.samples), BLOCK)
        blocks = np.minimum.reduceat(swings[0], starts), np.maximum.reduceat(swings[1], starts)
        self._levels = {BLOCK: blocks, 1: swings}
        self._loudest = max(-int(blocks[0].min()), int(blocks[1].max()), 1)

    def between(
        self, start: float, end: float, count: int
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """The lowest and highest value in each of `count` equal stretches of a time [s].

        Each (count,), from -1 to 1, which is as far as the sound ever swings: a quiet recording is
        seen, too. 0 where there is no sound. start: not below 0.
        """
        edges = np.linspace(start, end, count + 1) * self._rate
        length = BLOCK if edges[-1] - edges[0] >= count * LEAST * BLOCK else 1
        low, high = self._levels[length]
        places = np.floor(edges / length).astype(np.int64)
        begins = places[:-1][places[:-1] < len(low)]
        swings = np.zeros((2, count))
        if len(begins):
            last = max(min(int(places[len(begins)]), len(low)), int(begins[-1]) + 1)
            part = slice(begins[0], last)
            swings[0, : len(begins)] = np.minimum.reduceat(low[part], begins - begins[0])
            swings[1, : len(begins)] = np.maximum.reduceat(high[part], begins - begins[0])
        return swings[0] / self._loudest, swings[1] / self._loudest
