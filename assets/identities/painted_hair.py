"""Paint hair on the scalp below standing hair, so that no skin shows through.

Near the hairline it thins out as single hairs.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import scipy

from ...geometry.arrays import Floats32
from ..smooth import shrunk
from .hair import Cut, Fall

MOST_COVER = np.float32(0.99)  # share that dense hair covers


def grown_over(behind: Floats32) -> Floats32:
    """Share of texels that hair covers; behind: their distance behind the hairline [mm]."""
    dense_depth = np.float32(22.0)  # [mm] behind the hairline, where hair is dense
    t = np.clip(behind / dense_depth, np.float32(0.0), np.float32(1.0))
    return np.asarray(MOST_COVER * t * t * (np.float32(3.0) - np.float32(2.0) * t), np.float32)


def fringe_of(cut: Cut | Fall) -> float:
    """Share of single hairs at the hairline; smaller where hair is not combed over it."""
    is_combed_down = isinstance(cut, Cut) and cut.whorl[2] < 0.0 and not cut.knot
    return 1.0 if is_combed_down else 0.25


@lru_cache(maxsize=1)
def shrunk_strands(size: int, shrink: int) -> Floats32:
    """Strands of short hair with this many texels less each way."""
    return shrunk(_strands(size), shrink)


def _strands(size: int) -> Floats32:
    """How much more than hair about them single hairs at a hairline cover, shape (size, size).

    They run down the texture and lean to both sides; 0 in the mean, 2 at most.
    """
    random = np.random.default_rng(0).random((2, size, size), np.float32)
    rows = np.arange(size)[:, None]
    columns = np.arange(size)
    lean = np.round(0.12 * rows).astype(np.int64)
    fields = []
    for field, aside in zip(random, (lean, -lean), strict=True):
        upright = scipy.ndimage.gaussian_filter(field[rows, (columns + aside) % size], (5.0, 0.6))
        fields.append(upright[rows, (columns - aside) % size])
    nearest = np.maximum(*fields)
    hairs = np.clip(1.5 * (nearest - nearest.mean()) / nearest.std() - 0.5, -1.4, 1.4)
    return np.asarray(hairs - hairs.mean(), dtype=np.float32)
