"""The front edges of eyelids: paths along the mesh near the lids' landmarks.

Source: own.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..geometry.arrays import Floats64, Integers32
from .surface import SkinSurface


class LidAxes(NamedTuple):
    """Coordinates of points relative to the line from the outer to the inner corner of an eye."""

    centre: Floats64  # of the eyeball
    up: Floats64
    forward: Floats64
    corner: Floats64  # the outer one
    axis: Floats64  # from there to the inner one [mm]

    def angle(self, points: Floats64) -> Floats64:
        """Angle [rad] about the axis of the lids, 0 straight forward."""
        away = points - self.centre
        return np.arctan2(away @ self.up, away @ self.forward)

    def column(self, points: Floats64) -> Floats64:
        """Place from the outer corner of the eye, 0, to the inner one, 1."""
        column: Floats64 = ((points - self.corner) @ self.axis) / (self.axis @ self.axis)
        return column


def front_edges(
    surface: SkinSurface, axes: LidAxes, outline: Floats64
) -> tuple[Integers32, Integers32]:
    """Vertices of the front edges of the upper and the lower lid, from corner to corner.

    outline: an eye's landmarks from the outer corner, (6, 3).
    """
    upper = _front_edge(surface, outline[[0, 1, 2, 3]], axes)
    lower = _front_edge(surface, outline[[0, 5, 4, 3]], axes)
    return upper, lower


def _front_edge(surface: SkinSurface, line: Floats64, axes: LidAxes) -> Integers32:
    """Vertices of the path along the mesh near a lid's line of landmarks (4, 3)."""
    x = surface.positions
    reaches = np.linalg.norm(line - axes.centre, axis=1)
    order = np.argsort(axes.column(line))
    expected = np.interp(axes.column(x), axes.column(line)[order], reaches[order])
    edge_cost = 0.3  # cost per mm off the landmarks' distance from the eyeball, where no edge is
    behind = edge_cost * np.abs(np.linalg.norm(x - axes.centre, axis=1) - expected)
    edge: Integers32 = surface.way_through(surface.nearest(line), behind)
    return edge


def side_with_edges(side: Floats64, upper: Integers32, lower: Integers32) -> Floats64:
    """Side of each vertex (V,), 1 or -1 on the front edges of the upper and the lower lid.

    Beside a corner of the eye, a coarse mesh may have a vertex of the upper edge that lies nearer
    to the lower landmarks.
    """
    found = side.copy()
    found[np.setdiff1d(upper, lower)] = 1.0
    found[np.setdiff1d(lower, upper)] = -1.0
    return found
