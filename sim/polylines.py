"""Polylines: distances of points, and the nearest places along them."""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import Floats64
from ..geometry.vectors import Vector, difference, dot, less, plus, row_of, times
from ..jit import njit


def polyline_distance(points: Floats64, corners: Floats64) -> Floats64:
    """Distance [mm] of points (N, 3) to the polyline through `corners` (K, 3), shape (N,)."""
    squared = np.empty(len(points))
    _fill_squared(np.ascontiguousarray(points), np.ascontiguousarray(corners), squared)
    return np.sqrt(squared)


@njit
def _fill_squared(points: Floats64, corners: Floats64, squared: Floats64) -> None:
    """Fill squared distances (N,) of points to a polyline."""
    reached = reached_along(corners)
    for n in range(len(points)):
        squared[n], _, _ = nearest_on_line(corners, reached, row_of(points, n))


@njit
def arcs_along(points: Floats64, positions: Floats64) -> Floats64:
    """Return where a line (k, 3) is nearest to each of the positions (n, 3): arc lengths 0..1."""
    reached = reached_along(points)
    arc = np.empty(len(positions))
    for n in range(len(positions)):
        _, arc[n], _ = nearest_on_line(points, reached, row_of(positions, n))
    return arc


@njit
def reached_along(points: Floats64) -> Floats64:
    """Return the length of a line (k, 3) up to each of its points, shape (k,)."""
    reached = np.zeros(len(points))
    for k in range(len(points) - 1):
        along = difference(points, k, k + 1)
        reached[k + 1] = reached[k] + max(np.sqrt(dot(along, along)), 1e-9)
    return reached


@njit
def nearest_on_line(
    points: Floats64, reached: Floats64, place: Vector
) -> tuple[float, float, Vector]:
    """Return the squared distance of a place from a line (k, 3), and the nearest point.

    The point is given as arc length 0..1, and as a place. reached: see `reached_along`.
    """
    end = len(points) - 1
    nearest = np.inf
    arc = 0.0
    foot = place
    for k in range(end):
        length = reached[k + 1] - reached[k]
        start = row_of(points, k)
        along = difference(points, k, k + 1)
        t = min(max(dot(less(place, 1.0, start), along) / length**2, 0.0), 1.0)
        there = plus(start, times(t, along))
        away = less(place, 1.0, there)
        squared = dot(away, away)
        if squared < nearest:  # of equal distances the first counts
            nearest = squared
            arc = (reached[k] + t * length) / reached[end]
            foot = there
    return nearest, arc, foot
