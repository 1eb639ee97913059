"""Polylines: arc lengths, points between their points, and evenly spaced points."""

import numpy as np
import numpy.typing as npt

from .arrays import Floats64


def arc_lengths(points: Floats64) -> Floats64:
    """Return the arc length of a polyline (n, k) up to each of its points, shape (n,)."""
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(lengths)])


def polyline_at(places: npt.ArrayLike, along: npt.ArrayLike, points: Floats64) -> Floats64:
    """Return the points of a polyline (n, k) at the parameters `places`, shape (..., k).

    along: the parameter of each point of the polyline, ascending, shape (n,).
    """
    at = np.asarray(places, np.float64)
    known = np.asarray(along, np.float64)
    return np.stack([np.interp(at, known, column) for column in points.T], axis=-1)


def evenly_spaced(points: Floats64, along: Floats64, count: int) -> Floats64:
    """Return evenly spaced points on a polyline (n, k) from start to end, shape (count, k).

    along: as in `polyline_at`.
    """
    return polyline_at(np.linspace(0.0, along[-1], count), along, points)
