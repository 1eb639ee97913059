"""Border curves: sequences of vertices along the borders of a mesh, and their ends.

A border runs on through a vertex with exactly two border edges, unless it has a *corner* there.
Examples are the corners of a table cloth, or of a shut mouth, where the border of the upper lip
turns back along the lower lip. Corners are found on the mesh at rest and remain corners when it
moves.
"""

import numpy as np

from ...geometry.arrays import Floats64, Unsigned32
from .connectivity import Connectivity

CORNER_COSINE = 0.5
"""Cosine of 60 degrees: a border that turns by more has a corner. Chosen: the holes of eyes and
mouth of the built-in head turn by up to 38 degrees along their sides, and by 62 and more at their
corners; a hexagonal hole may still be round.
"""
TURN_ROUNDING = 1e-9
"""Cosines within this of CORNER_COSINE count as no corner."""


def border_neighbours(mesh: Connectivity, rest_positions: Floats64) -> Unsigned32:
    """Find the two neighbours of every vertex along its border, shape (V, 2).

    For a vertex where no border runs on, both neighbours are the vertex itself. `rest_positions`:
    shape (V, 3).
    """
    every_vertex = np.arange(mesh.vertex_count, dtype=np.uint32)
    neighbours = np.stack([every_vertex, every_vertex], axis=1)
    ends = mesh.edges[~mesh.around.is_interior].astype(np.uint32)
    here = ends.ravel()
    there = ends[:, ::-1].ravel()
    runs_on = np.bincount(here, minlength=mesh.vertex_count)[here] == 2
    here = here[runs_on]
    there = there[runs_on]
    order = np.argsort(here, kind="stable")
    vertices = here[order][::2]
    pairs = there[order].reshape(-1, 2)
    arriving = rest_positions[vertices] - rest_positions[pairs[:, 0]]
    leaving = rest_positions[pairs[:, 1]] - rest_positions[vertices]
    lengths = np.linalg.norm(arriving, axis=1) * np.linalg.norm(leaving, axis=1)
    is_straight = (
        np.einsum("vi,vi->v", arriving, leaving) >= (CORNER_COSINE - TURN_ROUNDING) * lengths
    )
    neighbours[vertices[is_straight]] = pairs[is_straight]
    return neighbours
