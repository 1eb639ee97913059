"""Polylines: the way along them, and points at even places."""

import numpy as np

from .arrays import Floats64


def arc_lengths(points: Floats64) -> Floats64:
    """The way along a polyline (n, k) to each of its points, shape (n,)."""
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(lengths)])


def evenly_spaced(points: Floats64, along: Floats64, count: int) -> Floats64:
    """Points of a polyline (n, k) at even places from its start to its end, shape (count, k).

    `along`: the rising place of each of its points, shape (n,).
    """
    places = np.linspace(0.0, along[-1], count)
    return np.stack([np.interp(places, along, column) for column in points.T], axis=1)
