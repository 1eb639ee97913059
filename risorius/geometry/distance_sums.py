"""Sums of weighted distances, the basis functions of thin-plate splines in space."""

import math

from ..jit import njit
from .arrays import Floats64


@njit(fastmath={"contract", "reassoc"})
def subtract_distances(
    places: Floats64,
    points: tuple[Floats64, ...],
    weights: tuple[Floats64, ...],
    moved: Floats64,
) -> None:
    """Subtract weighted distances of n places from m points; only the last bits are inexact.

    places, moved: shape (n, 3). points: their x, y and z, (m,) each. weights: of each point in x, y
    and z, (m,) each.
    """
    xs, ys, zs = points
    in_x, in_y, in_z = weights
    for place in range(len(places)):
        x = places[place, 0]
        y = places[place, 1]
        z = places[place, 2]
        sum_x = sum_y = sum_z = 0.0
        for point in range(len(xs)):
            aside = xs[point] - x
            above = ys[point] - y
            ahead = zs[point] - z
            distance = math.sqrt(aside * aside + above * above + ahead * ahead)
            sum_x += in_x[point] * distance
            sum_y += in_y[point] * distance
            sum_z += in_z[point] * distance
        moved[place, 0] -= sum_x
        moved[place, 1] -= sum_y
        moved[place, 2] -= sum_z
