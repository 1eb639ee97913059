"""The arrays that the passes of a frame share.

Kähler, Haber, Seidel 2003, section 4. A frame has two halves. First it decides which edges are
split (`splits`, and geomorph weights). Then it places points into `rows` and writes triangles. The
arrays stay the same from frame to frame, except `rows`, which the caller may lend.

Compiled code takes the whole `FrameBuffers`, or only the arrays that it reads. Passing an array
costs a twentieth of a microsecond, and in a named tuple twice as much. A frame of the paper's
method takes 40 microseconds, so its passes take arrays, or plain tuples (`frame[:]`), which cost no
more.
"""

from typing import NamedTuple

import numpy as np

from ...geometry.arrays import Floats32, Floats64, Integers64, Unsigned8, Unsigned16, Unsigned32
from ..mesh.connectivity import Connectivity

ROWS, SPLIT_EDGES, TWICE_SPLIT_EDGES, TRIANGLES, CENTRES = range(5)
"""Places in `FrameBuffers.counts`: output rows without centres, split edges, edges split twice,
subtriangles, triangles with a centre.
"""


class FrameBuffers(NamedTuple):
    """One frame of a mesh with V vertices, F triangles, E edges and R attribute edges."""

    positions: Floats64
    """Deformed vertex positions, shape (V, 3)."""
    points: Floats32
    """Positions in single precision, which is enough for all but differences."""
    normals: Floats32
    """Their unit normals, shape (V, 3)."""
    splits: Unsigned8
    """Splits of attribute edges, shape (R + 1,): first all edges, then copies; the last entry
    stands for no edge.
    """
    geomorph_once: Floats32
    """Geomorph weight of an edge's first-level point: its distance from the straight edge relative
    to the final distance, (E,).

    All are 1 unless frames are blended (beyond/blending.py); entries without a point have no
    meaning.
    """
    geomorph_twice: Floats32
    """Geomorph weight of an edge's quarter points, (E,), like `geomorph_once`."""
    first_points: Unsigned32
    """Output row of the first point of every split attribute edge, shape (R + 1,).

    An edge split once has one point, its middle. An edge split twice has, from its first end to its
    second, a quarter point, the middle and another quarter point.
    """
    split_once: Unsigned32
    """The edges that are split; the first `counts[SPLIT_EDGES]` are valid."""
    split_twice: Unsigned32
    """The edges that are split twice; the first `counts[TWICE_SPLIT_EDGES]` are valid."""
    configurations: Unsigned16
    """s0 + 3 s1 + 9 s2 of each triangle's edges, shape (F + 1,); the last one has no meaning."""
    centre_triangles: Unsigned32
    """The triangles with a centre, which only blending has; the first
    `counts[CENTRES]` are valid. Shape (F + 1,).
    """
    centre_weights: Floats32
    """Position of each centre in its triangle: weights of the corners, shape (F + 1, 3)."""
    counts: Integers64
    """Counts, shape (5,): see ROWS, SPLIT_EDGES, TWICE_SPLIT_EDGES, TRIANGLES, CENTRES."""
    rows: Floats32
    """The output: x y z, nx ny nz, attributes; row v is vertex v."""

    @property
    def split_edges(self) -> Unsigned32:
        """The edges that are split in this frame, once or twice."""
        return self.split_once[: self.counts[SPLIT_EDGES]]

    @property
    def twice_split_edges(self) -> Unsigned32:
        """The edges that are split twice in this frame."""
        return self.split_twice[: self.counts[TWICE_SPLIT_EDGES]]

    @property
    def centre_count(self) -> int:
        """Number of triangles with a centre."""
        return int(self.counts[CENTRES])


def buffers_for(
    mesh: Connectivity, positions: Floats64, points: Floats32, normals: Floats32
) -> FrameBuffers:
    """Make the buffers of a mesh, with no `rows` yet."""
    edge_count = len(mesh.edges)
    face_count = len(mesh.faces)
    attribute_edge_count = len(mesh.attribute_edges)
    return FrameBuffers(
        positions=positions,
        points=points,
        normals=normals,
        # One more than attribute edges: triangles without edges refer to the last entry, which has
        # no splits.
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
    """Fill buffers so that every edge is split once: points follow vertices in edge order."""
    edge_count = len(frame.geomorph_once)
    every_edge = np.arange(edge_count, dtype=np.uint32)
    frame.splits[:edge_count] = 1
    frame.split_once[:edge_count] = every_edge
    frame.first_points[:edge_count] = vertex_count + every_edge
    frame.counts[ROWS] = vertex_count + edge_count
    frame.counts[SPLIT_EDGES] = edge_count
    return frame
