"""Small functions of arrays: a bump, and means of blocks."""

import numpy as np

from ..geometry.arrays import Floats32, Floats64


def bump(values: Floats64, centre: float, width: float) -> Floats64:
    """Rise to 1 at `centre`, and fall to 0.37 at a distance of `width` (a Gaussian)."""
    return np.asarray(np.exp(-(((values - centre) / width) ** 2)))


def shrunk(values: Floats32, shrink: int) -> Floats32:
    """Means over blocks of `shrink` x `shrink` values (H, W, ...); H and W are multiples of it."""
    for axis in (0, 1):
        rows = np.moveaxis(values, axis, 0)
        count = len(rows) // shrink
        blocks = rows.reshape(count, shrink, *rows.shape[1:])
        means = blocks.mean(axis=1, dtype=np.float32)
        values = np.moveaxis(means, 0, axis)
    return np.ascontiguousarray(values)
