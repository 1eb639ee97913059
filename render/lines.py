"""Polylines that are drawn over a scene."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ..geometry.arrays import Floats32, Unsigned32
from .style import Colour


class Lines(NamedTuple):
    """Polylines, which shine through surfaces in front of them."""

    polylines: Sequence[npt.NDArray[Any]]
    """Points of each line, (n, 3)."""
    colour: Colour | npt.NDArray[Any]
    """sRGB of all lines, or of each line, (len(polylines), 3)."""
    width: float = 1.6
    """Width of the lines [pixels at scale 1]."""
    hidden_opacity: float = 0.45
    """Opacity behind a surface, 0 to 1."""
    opacity: float = 1.0
    """Opacity in front of all surfaces, 0 to 1."""

    def segments(self) -> tuple[Floats32, Unsigned32]:
        """Return positions and sRGB of points, (n, 6), and point indices of segments, (s, 2)."""
        polylines = self.polylines
        colours = np.asarray(self.colour, np.float32)
        counts = np.array([len(line) for line in polylines], np.int64)
        if not counts.sum():
            return np.zeros((0, 6), np.float32), np.zeros((0, 2), np.uint32)
        rows = np.empty((int(counts.sum()), 6), np.float32)
        np.concatenate([np.reshape(line, (-1, 3)) for line in polylines], out=rows[:, :3])
        rows[:, 3:] = colours if colours.ndim == 1 else np.repeat(colours, counts, axis=0)
        is_last = np.zeros(len(rows), bool)
        is_last[np.cumsum(counts)[counts > 0] - 1] = True
        starts = np.flatnonzero(~is_last).astype(np.uint32)
        return rows, np.stack([starts, starts + 1], axis=1)
