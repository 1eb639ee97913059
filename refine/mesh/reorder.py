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

from ...geometry.closest import places_on_curve
from .arrays import Wide
from .seams import number_by_first_use
from .validation import checked_indices, checked_positions


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
