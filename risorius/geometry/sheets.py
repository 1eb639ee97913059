"""Heights of points over a sheet that moves: a weighted mean of planes through nearest vertices.

Vertices are sorted into cells of a grid, which takes less time than to build and search a tree in
each frame. The vertices near one point bound the search for the next: points lie in rows.
"""

from typing import NamedTuple

import numpy as np

from ..jit import njit
from .arrays import Floats64, Integers64

NEAR = 8  # vertices that count


class Sheet(NamedTuple):
    """A sheet whose vertices are sorted into cells.

    vertices: (V, 3) in the order of their cells. normals: unit, (V, 3). depths: of what lies below
    the sheet, (V,). starts: the first vertex of each cell, and V, shape (nx ny nz + 1,). counts:
    cells along each axis, (3,). corner: of the first cell, (3,). cell: its size. All in one unit of
    length.
    """

    vertices: Floats64
    normals: Floats64
    depths: Floats64
    starts: Integers64
    counts: Integers64
    corner: Floats64
    cell: float


def sheet_of(vertices: Floats64, normals: Floats64, depths: Floats64) -> Sheet:
    """A sheet of at least NEAR vertices, (V, 3), with normals (V, 3) and depths (V,)."""
    corner = vertices.min(axis=0)
    extent = vertices.max(axis=0) - corner
    # About one vertex for each cell that the sheet passes, as if it were the side of a cube.
    cell = max(float(extent.max()) / np.sqrt(len(vertices)) * 1.5, 1e-9)
    cells = ((vertices - corner) / cell).astype(np.int64)
    counts = cells.max(axis=0) + 1
    number = (cells[:, 0] * counts[1] + cells[:, 1]) * counts[2] + cells[:, 2]
    order = np.argsort(number, kind="stable")
    starts = np.append(0, np.cumsum(np.bincount(number, minlength=int(counts.prod()))))
    return Sheet(vertices[order], normals[order], depths[order], starts, counts, corner, cell)


def heights_over(
    sheet: Sheet, points: Floats64, outward: Floats64
) -> tuple[Floats64, Floats64, Floats64]:
    """How far points (n, 3) are outside, (n,); unit normals there, (n, 3); mean depths, (n,).

    outward: vertices whose normals turn away from it hardly count, (n, 3).
    """
    found = np.empty((len(points), 5))
    _fill(*sheet, points, outward, found)
    return found[:, 0], found[:, 1:4], found[:, 4]


@njit
def _fill(
    x: Floats64,
    normals: Floats64,
    depths: Floats64,
    starts: Integers64,
    counts: Integers64,
    corner: Floats64,
    cell: float,
    points: Floats64,
    outward: Floats64,
    found: Floats64,
) -> None:
    """Fill rows of height, normal and depth."""
    near = np.arange(NEAR)
    away = np.empty(NEAR)  # squared, increasing
    for n in range(len(points)):
        _find_nearest(x, starts, counts, corner, cell, points[n], near, away)
        _weigh(x, normals, depths, points[n], outward[n], near, away, found[n])


@njit
def _find_nearest(
    x: Floats64,
    starts: Integers64,
    counts: Integers64,
    corner: Floats64,
    cell: float,
    point: Floats64,
    near: Integers64,
    away: Floats64,
) -> None:
    """Replace the last point's nearest vertices by those of this point, the nearest first.

    The last ones are near this point, too: others must be nearer than these.
    """
    limit = 0.0
    for k in range(NEAR):
        limit = max(limit, _squared(point, x[near[k]]))
    limit = limit * (1.0 + 1e-12) + 1e-30  # rounded up
    low = np.empty(3, np.int64)
    high = np.empty(3, np.int64)
    for c in range(3):
        place = (point[c] - corner[c]) / cell
        radius = np.sqrt(limit) / cell
        low[c] = min(max(int(np.floor(place - radius)), 0), counts[c] - 1)
        high[c] = min(max(int(np.floor(place + radius)), 0), counts[c] - 1)
    away[:] = limit
    for i in range(low[0], high[0] + 1):
        for j in range(low[1], high[1] + 1):
            row = (i * counts[1] + j) * counts[2]
            for v in range(starts[row + low[2]], starts[row + high[2] + 1]):
                square = _squared(point, x[v])
                if square >= away[NEAR - 1]:
                    continue
                rank = NEAR - 1
                while rank > 0 and away[rank - 1] > square:
                    away[rank] = away[rank - 1]
                    near[rank] = near[rank - 1]
                    rank -= 1
                away[rank] = square
                near[rank] = v


@njit
def _squared(point: Floats64, vertex: Floats64) -> float:
    """The squared distance of two points."""
    square = 0.0
    for c in range(3):
        square += (point[c] - vertex[c]) ** 2
    return square


@njit
def _weigh(
    x: Floats64,
    normals: Floats64,
    depths: Floats64,
    point: Floats64,
    outward: Floats64,
    near: Integers64,
    away: Floats64,
    found: Floats64,
) -> None:
    """Fill a row of height, normal and depth: means over near vertices that look outward."""
    reach = 0.35 * max(away[NEAR - 1], 1e-30)
    total = 0.0
    found[:] = 0.0
    for k in range(NEAR):
        v = near[k]
        height = 0.0
        facing = 0.0
        for c in range(3):
            height += (point[c] - x[v, c]) * normals[v, c]
            facing += outward[c] * normals[v, c]
        weight = 1e-9
        if facing > 0.0:
            weight += np.exp(-away[k] / reach)
        total += weight
        found[0] += weight * height
        for c in range(3):
            found[1 + c] += weight * normals[v, c]
        found[4] += weight * depths[v]
    size = np.sqrt(found[1] ** 2 + found[2] ** 2 + found[3] ** 2)
    found[0] /= total
    found[4] /= total
    for c in range(3):
        found[1 + c] /= max(size, 1e-30)
