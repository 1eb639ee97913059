"""Polylines: arc lengths, and evenly spaced points."""

import numpy as np

from .arrays import Floats64


def arc_lengths(points: Floats64) -> Floats64:
    """Return the arc length of a polyline (n, k) up to each of its points, shape (n,)."""
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(lengths)])


def evenly_spaced(points: Floats64, along: Floats64, count: int) -> Floats64:
    """Return evenly spaced points on a polyline (n, k) from start to end, shape (count, k).

    `along`: the parameter of each point of the polyline, ascending, shape (n,).
    """
    positions = np.linspace(0.0, along[-1], count)
    return np.stack([np.interp(positions, along, column) for column in points.T], axis=1)
