"""Border curves: sequences of vertices along the borders of a mesh, and their ends.

A border runs on through a vertex with exactly two border edges, unless it has a *corner* there.
Examples are the corners of a table cloth, or of a shut mouth, where the border of the upper lip
turns back along the lower lip. Corners are found on the mesh at rest and remain corners when it
moves.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from ...geometry.arrays import Flags, Floats64, Unsigned32
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


def follow_borders(mesh: Connectivity, rest_positions: Floats64) -> Unsigned32:
    """Find the vertices before and after every border edge, shape (E, 2).

    At a corner of the border, this vertex is the edge's own end. Rows of other edges have no
    meaning.
    """
    neighbours = border_neighbours(mesh, rest_positions)[mesh.edges]
    others = mesh.edges[:, ::-1].view(np.uint32)
    return np.where(neighbours[..., 0] != others, neighbours[..., 0], neighbours[..., 1])


def follow_outlines(
    mesh: Connectivity, beyond: Unsigned32, outlines: Sequence[Sequence[int]]
) -> Unsigned32:
    """Return `beyond`, shape (E, 2), with the vertices before and after each edge of outlines."""
    if not outlines:
        return beyond
    around = {}
    for rim in outlines:
        for before, first, last, after in zip(rim, rim[1:], rim[2:], rim[3:], strict=False):
            around[first, last] = before, after
            around[last, first] = after, before
    found = beyond.copy()
    for number in np.flatnonzero(mesh.is_sharp).tolist():
        edge = tuple(mesh.edges[number].tolist())
        found[number] = around.get(edge, beyond[number])
    return found


def edges_of_outlines(mesh: Connectivity, outlines: Sequence[Sequence[int]]) -> Flags:
    """Flag the edges of each outline, except its first and its last edge, shape (E,)."""
    inner = [edge for rim in outlines for edge in pairwise(rim[1:-1])]
    if not inner:
        return np.zeros(len(mesh.edges), np.bool_)
    first, last = np.sort(np.array(inner, dtype=np.int64), axis=1).T
    near, far = np.sort(mesh.edges.astype(np.int64), axis=1).T
    return np.isin(near * mesh.vertex_count + far, first * mesh.vertex_count + last)
