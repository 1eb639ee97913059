"""Triangles and edges around each vertex, sorted once, for loops shared by threads (threads.py).

A loop over triangles that adds to their corners cannot be shared, because two threads could add to
one vertex. A loop over vertices can be shared. Each vertex sums its triangles and edges in the
order of a loop over all triangles and edges, so sums are equal to the last bit.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ...geometry.arrays import Flags, Unsigned32
from .connectivity import Connectivity


class Fans(NamedTuple):
    """Triangles and edges around each vertex of a mesh with V vertices, F triangles, E edges."""

    corner_starts: Unsigned32
    """Corners of vertex v are `corners[corner_starts[v]:corner_starts[v + 1]]`, shape (V + 1,)."""
    corners: Unsigned32
    """Corners at each vertex, 4 x triangle + i, triangles in their order, shape (3 F,)."""
    neighbour_starts: Unsigned32
    """Places of the neighbours of each vertex in `neighbours`, like `corner_starts`, (V + 1,)."""
    neighbours: Unsigned32
    """The other ends of the edges at each vertex, in the order of edges, shape (2 E,)."""


def fans_of(mesh: Connectivity) -> Fans:
    """Sort the corners of triangles and the ends of edges by their vertices."""
    return fans_around(mesh.faces, mesh.edges, mesh.vertex_count)


def fans_around(
    faces: npt.NDArray[np.integer], edges: npt.NDArray[np.integer], vertex_count: int
) -> Fans:
    """Sort corners of triangles (F, 3) and ends of edges (E, 2) by their vertices or sectors."""
    corner_starts, order = _by_vertex(faces, vertex_count)
    corners = (order // 3 * 4 + order % 3).astype(np.uint32)
    neighbour_starts, order = _by_vertex(edges, vertex_count)
    neighbours = edges[:, ::-1].ravel()[order].astype(np.uint32)
    return Fans(corner_starts, corners, neighbour_starts, neighbours)


def fans_before(mesh: Connectivity, is_back: Flags) -> Fans:
    """Return the fans of a mesh without the corners of backs at vertices of other triangles.

    is_back: flags of triangles, shape (F,).
    """
    fans = fans_of(mesh)
    kept = ~corners_behind(mesh.faces, is_back)[fans.corners // 4, fans.corners % 4]
    ends = np.concatenate([[0], np.cumsum(kept)])
    starts = ends[fans.corner_starts].astype(np.uint32)
    return fans._replace(corner_starts=starts, corners=fans.corners[kept])


def corners_behind(faces: npt.NDArray[np.integer], is_back: Flags) -> Flags:
    """Return the corners of backs, (F,), at vertices of other triangles, as flags (F, 3)."""
    at_front = np.isin(faces, faces[~is_back])
    return is_back[:, None] & at_front


def _by_vertex(
    vertices: npt.NDArray[np.integer], vertex_count: int
) -> tuple[Unsigned32, npt.NDArray[np.intp]]:
    order = np.argsort(vertices, axis=None, kind="stable")
    counts = np.bincount(vertices.ravel(), minlength=vertex_count)
    return np.concatenate([[0], np.cumsum(counts)]).astype(np.uint32), order
