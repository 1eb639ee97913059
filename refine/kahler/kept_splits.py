"""Loop's rules for frames that all have the same splits, without blending.

Kähler, Haber, Seidel 2003, section 4.2. Moved vertices and the first level are then fixed sums of
the vertices of a frame, a sparse matrix. Its rows have four entries for a point on an edge and nine
for a vertex, so no list of lengths is needed. Indices and weights are computed once; vertices that
stay have weights 1 and 0. The results equal those of smoothing.py to the last bit.
"""

from typing import NamedTuple

import numpy as np

from ...geometry.arrays import Floats32, Unsigned32
from ...geometry.vectors import ONE, ZERO, is_representable, plus, row_of, unit, write_row
from ...jit import njit
from ..mesh.connectivity import Surroundings
from ..mesh.lanes import (
    LANE_WIDTH,
    copy_into_lanes,
    lanes_of,
    scaled,
    sum_of,
    unit_if_representable,
    write_point,
)
from ..mesh.rings import NEAR_COUNT, Rings
from .frame import FrameBuffers


class KeptRows(NamedTuple):
    """The rows of the matrix, for V vertices and the N edge points of split edges."""

    points: Floats32
    """Positions of a frame in lanes (mesh/lanes.py), shape (V, 4)."""
    normals: Floats32
    """Normals of a frame in lanes, shape (V, 4)."""
    near: Unsigned32
    """The first eight vertices around each vertex, shape (V, 8)."""
    own: Floats32
    """Weight of the vertex itself, shape (V,)."""
    ring: Floats32
    """Weight of each vertex around it, shape (V,)."""
    crowded: Unsigned32
    """Moved vertices with more than eight neighbours."""
    corners: Unsigned32
    """Ends of a split edge and the corners opposite, shape (N, 4); edges inside the mesh first."""
    rows: Unsigned32
    """Output row of each edge point, shape (N,)."""
    edges: Unsigned32
    """The split edges, shape (N,)."""


def kept_rows(frame: FrameBuffers, around: Surroundings, rings: Rings) -> tuple[KeptRows, int]:
    """Compute indices and weights for the splits of `frame`, and count edges inside the mesh."""
    vertex_count = len(frame.points)
    split_edges = frame.split_edges
    inside_first = np.argsort(~around.is_interior[split_edges], kind="stable")
    edges = split_edges[inside_first]
    corners = around.points[edges]
    moves = np.zeros(vertex_count, dtype=np.bool_)
    moves[corners[:, :2]] = True
    more_count = np.diff(rings.starts.astype(np.int64))
    kept = KeptRows(
        points=np.zeros((vertex_count, LANE_WIDTH), dtype=np.float32),
        normals=np.zeros((vertex_count, LANE_WIDTH), dtype=np.float32),
        near=rings.near,
        own=np.where(moves, rings.own, ONE),
        ring=np.where(moves, rings.ring, ZERO),
        crowded=np.flatnonzero(moves & (more_count > 0)).astype(np.uint32),
        corners=corners,
        rows=frame.first_points[edges] + (frame.splits[edges] >> 1),
        edges=edges,
    )
    return kept, int(around.is_interior[edges].sum())


@njit
def copy_frame(first: int, last: int, frame: FrameBuffers, kept: KeptRows) -> None:
    """Copy positions and normals of a frame into lanes."""
    copy_into_lanes(first, last, frame.points, kept.points)
    copy_into_lanes(first, last, frame.normals, kept.normals)


@njit(lanes=True)
def place_kept_vertices(first: int, last: int, kept: KeptRows, rows: Floats32) -> None:
    """Write all vertices as if they had at most eight neighbours (Fig. 3)."""
    points = kept.points
    normals = kept.normals
    near = kept.near
    assert points.shape[1] == normals.shape[1] == LANE_WIDTH and near.shape[1] == NEAR_COUNT
    for k in range(first, last):
        v = np.uint32(k)
        total = lanes_of(points, near[v, 0])
        for i in range(1, NEAR_COUNT):
            total = sum_of(total, lanes_of(points, near[v, i]))
        point = sum_of(scaled(kept.own[v], lanes_of(points, v)), scaled(kept.ring[v], total))
        write_point(rows, v, point, lanes_of(normals, v))


@njit
def place_crowded_vertices(kept: KeptRows, rings: Rings, rows: Floats32) -> None:
    """Write the positions of vertices with more than eight neighbours."""
    points = kept.points
    others = rings.others
    for v in kept.crowded:
        total = lanes_of(points, rings.near[v, 0])
        for i in range(1, NEAR_COUNT):
            total = sum_of(total, lanes_of(points, rings.near[v, i]))
        for i in range(rings.starts[v], rings.starts[v + 1]):
            total = sum_of(total, lanes_of(points, others[i]))
        point = sum_of(scaled(kept.own[v], lanes_of(points, v)), scaled(kept.ring[v], total))
        write_row(rows, v, (point[0], point[1], point[2]))


@njit(lanes=True)
def place_kept_edge_points(
    first: int,
    last: int,
    kept: KeptRows,
    of_ends: np.float32,
    of_wings: np.float32,
    rows: Floats32,
) -> None:
    """Write the first-level points of split edges (Fig. 3), with the unit means of normals.

    `of_ends`, `of_wings`: weights of the ends of an edge, and of the corners opposite.
    """
    points = kept.points
    normals = kept.normals
    corners = kept.corners
    output_rows = kept.rows
    assert points.shape[1] == normals.shape[1] == corners.shape[1] == LANE_WIDTH
    left_count = 0
    for k in range(first, last):
        i = np.uint32(k)
        a = corners[i, 0]
        b = corners[i, 1]
        ends = sum_of(lanes_of(points, a), lanes_of(points, b))
        wings = sum_of(lanes_of(points, corners[i, 2]), lanes_of(points, corners[i, 3]))
        edge_point = sum_of(scaled(of_ends, ends), scaled(of_wings, wings))
        total = sum_of(lanes_of(normals, a), lanes_of(normals, b))
        squared = total[0] * total[0] + total[1] * total[1] + total[2] * total[2]
        write_point(rows, output_rows[i], edge_point, unit_if_representable(total, squared))
        left_count += not is_representable(squared)
    if left_count > 0:  # normals that look in opposite directions
        for k in range(first, last):
            i = np.uint32(k)
            a = corners[i, 0]
            b = corners[i, 1]
            mean = unit(plus(row_of(normals, a), row_of(normals, b)))
            write_row(rows, output_rows[i], mean, 3)


@njit
def keep_edge_points(kept: KeptRows, rows: Floats32, edge_points: Floats32) -> None:
    """Copy first-level points into `edge_points`, (E, 3), before the second level moves them."""
    for k in range(len(kept.edges)):
        write_row(edge_points, kept.edges[k], row_of(rows, kept.rows[k]))
