"""Polylines: distances of points, and the nearest places along them."""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import Floats64
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
    foot = np.empty(3)
    for n in range(len(points)):
        squared[n], _ = nearest_on_line(corners, reached, points[n], foot)


@njit
def arcs_along(points: Floats64, positions: Floats64) -> Floats64:
    """Return where a line (k, 3) is nearest to each of the positions (n, 3): arc lengths 0..1."""
    reached = reached_along(points)
    arc = np.empty(len(positions))
    foot = np.empty(3)
    for n in range(len(positions)):
        _, arc[n] = nearest_on_line(points, reached, positions[n], foot)
    return arc


@njit
def reached_along(points: Floats64) -> Floats64:
    """Return the length of a line (k, 3) up to each of its points, shape (k,)."""
    reached = np.zeros(len(points))
    for k in range(len(points) - 1):
        squared = 0.0
        for axis in range(3):
            squared += (points[k + 1, axis] - points[k, axis]) ** 2
        reached[k + 1] = reached[k] + max(np.sqrt(squared), 1e-9)
    return reached


@njit
def nearest_on_line(
    points: Floats64, reached: Floats64, place: Floats64, foot: Floats64
) -> tuple[float, float]:
    """Return the squared distance of a place from a line, and its place along it; fills `foot`."""
    end = len(points) - 1
    nearest = np.inf
    arc = 0.0
    for k in range(end):
        length = reached[k + 1] - reached[k]
        dot = 0.0
        for axis in range(3):
            dot += (place[axis] - points[k, axis]) * (points[k + 1, axis] - points[k, axis])
        t = min(max(dot / length**2, 0.0), 1.0)
        squared = 0.0
        for axis in range(3):
            at = points[k, axis] + t * (points[k + 1, axis] - points[k, axis])
            squared += (place[axis] - at) ** 2
        if squared < nearest:  # of equal distances the first counts
            nearest = squared
            arc = (reached[k] + t * length) / reached[end]
            for axis in range(3):
                foot[axis] = points[k, axis] + t * (points[k + 1, axis] - points[k, axis])
    return nearest, arc
