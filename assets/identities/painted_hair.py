"""Paint the scalp below hair in the colour of hair, so that no skin shows through.

Near the hairline the paint thins out into single hairs.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import scipy

from ...geometry.arrays import Floats32
from ..smooth import shrunk
from .hair import Cut, Fall

MOST_COVER = np.float32(0.99)  # opacity of dense hair


def grown_over(behind: Floats32) -> Floats32:
    """Return the opacity of hair, 0 to 1, at distances behind the hairline [mm], any shape."""
    dense_depth = np.float32(22.0)  # [mm] behind the hairline, where hair is dense
    t = np.clip(behind / dense_depth, np.float32(0.0), np.float32(1.0))
    return np.asarray(MOST_COVER * t * t * (np.float32(3.0) - np.float32(2.0) * t), np.float32)


def fringe_of(cut: Cut | Fall) -> float:
    """Return the strength of single hairs at the hairline, 1 for cuts that are combed over it."""
    is_combed_down = isinstance(cut, Cut) and cut.whorl[2] < 0.0 and not cut.knot
    return 1.0 if is_combed_down else 0.25


@lru_cache(maxsize=1)
def shrunk_strands(size: int, shrink: int) -> Floats32:
    """Average `_strands(size)` over blocks of `shrink` x `shrink` texels."""
    return shrunk(_strands(size), shrink)


def _strands(size: int) -> Floats32:
    """Draw a random pattern of hairs, (size, size), which changes the opacity at a hairline.

    The hairs run down the texture and lean to both sides. The mean is 0, the maximum at most 2.
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
