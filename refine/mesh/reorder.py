"""Large meshes in a careless order: an order in which neighbours lie beside each other.

The passes of a frame follow triangles to their vertices and edges to their ends. In a large mesh
whose vertices or triangles were shuffled each step leads to memory that has left the processor's
caches: a million triangles take two to three times as long. Whoever has such a mesh brings it into
a better order once, before binding a refiner to it:

    order = refine.reorder(faces, positions)
    refiner = refine.create("kahler", order.faces, positions[order.vertices])
    mesh = refiner.refine(moved[order.vertices])        # order.triangles[mesh.source]: whose part

Vertices and triangles follow a curve that fills space (Morton 1966), triangles by the first of
their vertices, vertices then by their first use in these triangles, so that both stream. It pays
where the vertices do not fit the processor's second cache, above 20 000 or so. Not in the paper.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from .arrays import Doubles, Wide
from .seams import number_by_first_use
from .validation import checked_indices, checked_positions

BITS = 20
"""Of the grid along one axis that the curve runs through; 3 x 20 fit a number of 64."""


class Order(NamedTuple):
    """A mesh in a better order, in terms of the one that was given."""

    vertices: Wide
    """The given number of each vertex, shape (V,)."""
    triangles: Wide
    """The given number of each triangle, shape (F,)."""
    faces: Wide
    """The triangles, of the new numbers of vertices, shape (F, 3)."""


def reorder(faces: npt.ArrayLike, positions: npt.ArrayLike) -> Order:
    """Find an order for triangles `faces`, shape (F, 3), and vertices at `positions`, (V, 3).

    The same mesh gets the same order everywhere. Raises ValueError for arrays that do not fit
    together.
    """
    points = checked_positions(positions, "positions")
    corners = checked_indices("faces", faces, len(points), "positions")
    place = np.empty(len(points), dtype=np.int64)
    place[np.argsort(places_on_curve(points), kind="stable")] = np.arange(len(points))
    triangles = np.argsort(place[corners].min(axis=1), kind="stable")
    walked = corners[triangles].ravel()
    numbers, first_uses = number_by_first_use(walked)
    used = walked[first_uses]
    unused = np.setdiff1d(np.arange(len(points)), used)
    return Order(np.concatenate([used, unused]), triangles, numbers.reshape(-1, 3))


def places_on_curve(positions: Doubles) -> Wide:
    """How far along a curve that fills space each position lies, shape (V,)."""
    if len(positions) == 0:
        return np.zeros(0, dtype=np.int64)
    low = positions.min(axis=0)
    size = float((positions.max(axis=0) - low).max())
    scale = (2**BITS - 1) / size if size > 0.0 else 0.0
    cells = ((positions - low) * scale).astype(np.int64)
    places = np.zeros(len(positions), dtype=np.int64)
    for bit in range(BITS):  # of x, y and z in turn
        for axis in range(3):
            places |= ((cells[:, axis] >> bit) & 1) << (3 * bit + axis)
    return places
