r"""The rule that moves input vertices: their neighbours and weights.

Kähler, Haber, Seidel 2003, Fig. 3 right, with Warren's weights (Warren 2001) in place of Loop's:

      ring   ring         interior, valence n     ring = 3/16 for n = 3, otherwise 3/(8 n)
         \   /                                    own  = 1 - n ring
    ring--own--ring       on a border curve       ring = 1/8 for the two neighbours on the curve
         /   \                                    own  = 3/4
      ring   ring         anywhere else           own  = 1

The paper leaves one question open; we decide that a vertex moves when any of its edges is split. A
vertex with one border edge or with more than two (a corner where surfaces meet) stays in place.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ...geometry.arrays import Floats32, Floats64, Unsigned32
from .connectivity import Connectivity

BORDER_OWN_WEIGHT = 3 / 4
"""Vertex on a border curve (Fig. 3, bottom right)."""
NEAR_COUNT = 8
"""Number of vertices of a ring in the table of width 8."""
BORDER_RING_WEIGHT = 1 / 8
"""Its two neighbours on the curve (Fig. 3, bottom right)."""


class Rings(NamedTuple):
    """Rings and weights of the vertex rule: own x vertex + ring x (sum over its ring).

    A ring has the neighbours along all edges, or, for a vertex on a border curve, along the border
    only. Most rings have at most eight vertices. Shorter rings are filled up to eight with the
    vertex itself, and its own weight is reduced accordingly, because a loop of exactly eight steps
    is three times as fast. Compiled code takes this tuple.
    """

    own: Floats32
    """Weight of the vertex itself, minus its weight in its own ring, shape (V,)."""
    ring: Floats32
    """Weight of every vertex in the ring, shape (V,); 0 where the vertex never moves."""
    near: Unsigned32
    """The first eight vertices of the ring, shape (V, 8)."""
    starts: Unsigned32
    """Further vertices of the ring are `others[starts[v]:starts[v + 1]]`, shape (V + 1,)."""
    others: Unsigned32
    """Vertices of the rings after the eighth."""


def vertex_rings(connectivity: Connectivity) -> Rings:
    """Compute Warren's weights for every vertex of a mesh (Fig. 3, right)."""
    vertex_count = connectivity.vertex_count
    ends = connectivity.edges.astype(np.int64)
    is_border = ~connectivity.around.is_interior
    valence = np.bincount(ends.ravel(), minlength=vertex_count)
    border_valence = np.bincount(ends[is_border].ravel(), minlength=vertex_count)
    is_inside = (border_valence == 0) & (valence > 0)
    is_on_curve = border_valence == 2

    own = np.ones(vertex_count)
    ring = np.zeros(vertex_count)
    inside_valence = valence[is_inside]
    ring[is_inside] = warren_weight(inside_valence)
    own[is_inside] = 1.0 - inside_valence * ring[is_inside]
    ring[is_on_curve] = BORDER_RING_WEIGHT
    own[is_on_curve] = BORDER_OWN_WEIGHT

    centres = ends.ravel()
    neighbours = ends[:, ::-1].ravel()
    is_in_ring = is_inside[centres] | (is_on_curve[centres] & np.repeat(is_border, 2))
    centres = centres[is_in_ring]
    neighbours = neighbours[is_in_ring]
    order = np.argsort(centres, kind="stable")
    centres = centres[order]
    neighbours = neighbours[order]
    sizes = np.bincount(centres, minlength=vertex_count)
    place = np.arange(len(centres)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    is_near = place < NEAR_COUNT
    near = np.repeat(np.arange(vertex_count, dtype=np.uint32)[:, None], NEAR_COUNT, axis=1)
    near[centres[is_near], place[is_near]] = neighbours[is_near]
    own -= ring * np.maximum(NEAR_COUNT - sizes, 0)
    other_counts = np.maximum(sizes - NEAR_COUNT, 0)
    return Rings(
        own=own.astype(np.float32),
        ring=ring.astype(np.float32),
        near=near,
        starts=np.concatenate([[0], np.cumsum(other_counts)]).astype(np.uint32),
        others=neighbours[~is_near].astype(np.uint32),
    )


def warren_weight(valence: npt.NDArray[np.integer]) -> Floats64:
    """Weight of one neighbour of an interior vertex: 3/16 for valence 3, else 3/(8 valence)."""
    return np.where(valence == 3, 3.0 / 16.0, 3.0 / (8.0 * np.maximum(valence, 1)))
