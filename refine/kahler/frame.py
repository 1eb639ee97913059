"""The arrays that the passes of a frame hand on to each other.

Kähler, Haber, Seidel 2003, section 4. A frame has two halves: first it is decided which edges are
split (`splits`, and how far their points have grown), then points are placed and triangles written
into `rows`. The arrays stay the same from frame to frame, but for `rows`, which the caller may
lend.

Compiled code takes the `FrameBuffers` as they are, or the arrays that it reads: an array alone
costs a twentieth of a microsecond, in a named tuple twice as much. So passes of the paper's frame,
which is done in 40 microseconds, take arrays, or plain tuples (`frame[:]`), which cost as much.
"""

from typing import NamedTuple

import numpy as np

from ...geometry.arrays import Floats32, Floats64, Integers64, Unsigned8, Unsigned16, Unsigned32
from ..mesh.connectivity import Connectivity

ROWS, ONCE, TWICE, TRIANGLES, CENTRES = range(5)
"""Places in `FrameBuffers.counts`: output rows but centres, edges split, edges split twice,
subtriangles, triangles with a point in the middle."""


class FrameBuffers(NamedTuple):
    """One frame of a mesh with V vertices, F triangles, E edges and R attribute edges."""

    positions: Floats64
    """Deformed vertex positions, shape (V, 3)."""
    points: Floats32
    """The same in single precision, which is enough for all but differences."""
    normals: Floats32
    """Their unit normals, shape (V, 3)."""
    splits: Unsigned8
    """Splits of attribute edges, edges first, shape (R + 1,); the last is where no edge is."""
    geomorph_once: Floats32
    """How far the middle point of an edge is from the straight edge to its place, shape (E,).

    Ones, but for frames that are blended (beyond/blending.py); no meaning where no point is.
    """
    geomorph_twice: Floats32
    """How far its quarter points are."""
    first_points: Unsigned32
    """Output row of the first point of every split attribute edge, shape (R + 1,).

    There is one point on an edge split once, its middle; one split twice has a quarter point, the
    middle and another quarter point, from its first end to its second.
    """
    split_once: Unsigned32
    """The edges that are split; the first `counts[ONCE]` count."""
    split_twice: Unsigned32
    """The edges that are split twice; the first `counts[TWICE]` count."""
    configurations: Unsigned16
    """s0 + 3 s1 + 9 s2 of each triangle's edges, shape (F + 1,); the last one has no meaning."""
    centre_triangles: Unsigned32
    """The triangles with a point in the middle, which only blending has; the first
    `counts[CENTRES]` count. Shape (F + 1,)."""
    centre_weights: Floats32
    """Where in its triangle each of these points is: weights of the corners, shape (F + 1, 3)."""
    counts: Integers64
    """How many there are of what, shape (5,): see ROWS, ONCE, TWICE, TRIANGLES, CENTRES."""
    rows: Floats32
    """The output: x y z, nx ny nz, attributes; row v is vertex v."""

    @property
    def split_edges(self) -> Unsigned32:
        """The edges that are split in this frame, once or twice."""
        return self.split_once[: self.counts[ONCE]]

    @property
    def twice_split_edges(self) -> Unsigned32:
        """Those of them that are split twice."""
        return self.split_twice[: self.counts[TWICE]]

    @property
    def centre_count(self) -> int:
        """How many triangles have a point in the middle."""
        return int(self.counts[CENTRES])


def buffers_for(
    mesh: Connectivity, positions: Floats64, points: Floats32, normals: Floats32
) -> FrameBuffers:
    """Make the buffers of a mesh, but for `rows`, of which there are none yet."""
    edge_count = len(mesh.edges)
    face_count = len(mesh.faces)
    attribute_edge_count = len(mesh.attribute_edges)
    return FrameBuffers(
        positions=positions,
        points=points,
        normals=normals,
        # One more than attribute edges: triangles without edges refer to it and find zero splits.
        splits=np.zeros(attribute_edge_count + 1, dtype=np.uint8),
        geomorph_once=np.ones(edge_count, dtype=np.float32),
        geomorph_twice=np.ones(edge_count, dtype=np.float32),
        first_points=np.zeros(attribute_edge_count + 1, dtype=np.uint32),
        split_once=np.zeros(edge_count + 1, dtype=np.uint32),
        split_twice=np.zeros(edge_count + 1, dtype=np.uint32),
        configurations=np.zeros(face_count + 1, dtype=np.uint16),
        centre_triangles=np.zeros(face_count + 1, dtype=np.uint32),
        centre_weights=np.zeros((face_count + 1, 3), dtype=np.float32),
        counts=np.zeros(5, dtype=np.int64),
        rows=np.zeros((0, 0), dtype=np.float32),
    )


def split_everywhere(frame: FrameBuffers, vertex_count: int) -> FrameBuffers:
    """Fill buffers in so that every edge is split once: points follow vertices in its order."""
    edge_count = len(frame.geomorph_once)
    every_edge = np.arange(edge_count, dtype=np.uint32)
    frame.splits[:edge_count] = 1
    frame.split_once[:edge_count] = every_edge
    frame.first_points[:edge_count] = vertex_count + every_edge
    frame.counts[ROWS] = vertex_count + edge_count
    frame.counts[ONCE] = edge_count
    return frame
