r"""Normals computed from the refined surface: `normals="refined"`.

Kähler, Haber, Seidel 2003, interpolate the normal of a new point from those at the ends of its edge
(section 4.4). Then smooth shading cannot show the form that a split adds: only outlines and
highlights change. This scheme uses the surface in which every edge is split once:

              c                m    points of all edges, where the scheme puts them
             / \ C middle of a triangle: its corners' mean, and 0.511 of the
          m /   \ m                 each m stands out of its edge
           /  C  \
          a---m---b            normal at m    (b - a) x (C - C'), with C' beyond the edge;
           \  C' /                            (b - a) x (C - m) on a border
          m \   / m            normal at a    sum over the triangles around of
             \ /                              (C - a) x (m_ac - m_ab)
              d

Both normals are sums of the cross products of the small triangles around the point. They do not
depend on the splits of this frame, so no normal jumps when an edge is split. Normals at m are
computed on split edges, or on all edges if the criterion measures them. The normal of a new point
begins as the mean of the normals at the ends of its edge. It reaches the normal of the surface when
the point has moved a third of its displacement (blending.py). The normal at a quarter point is the
mean of the normals of its neighbours.

Differs from the paper, whose rule is `normals="linear"`.
"""

import numpy as np

from ...geometry.arrays import Flags, Floats32, Floats64, Integers32, Unsigned32
from ...geometry.vectors import (
    ONE,
    ZERO,
    cross,
    less,
    mix,
    plus,
    row_of,
    unit,
    write_row,
)
from ...jit import njit
from ..kahler.frame import ROWS, SPLIT_EDGES, FrameBuffers
from ..kahler.scheme import Scheme
from ..mesh.connectivity import Connectivity
from ..mesh.creases import sharpened
from ..mesh.threads import parallel_for
from .whole_surface import WholeSurface, between_rows

NORMAL_HASTE = np.float32(3.0)
"""Ratio of the speeds at which the normal and the position of a new point change. Chosen above 1:
shading that changes is less visible than a surface that jumps, and a triangle whose normal is half
turned has half its effect.
"""


class RefinedNormals(Scheme):
    """A wrapper around a scheme that replaces its normals by the normals of the refined surface."""

    measures = True

    def __init__(self, scheme: Scheme) -> None:
        """`scheme`: the scheme that places the points."""
        self.parts = (scheme,)
        self.interpolates = scheme.interpolates
        self.uses_normals = scheme.uses_normals
        self._scheme = scheme

    def bind(
        self, connectivity: Connectivity, rest_positions: Floats64, rest_normals: Floats32
    ) -> None:
        """Bind the scheme, and allocate its surface."""
        self._scheme.bind(connectivity, rest_positions, rest_normals)
        outlined = self.outlined(connectivity)
        if outlined.any():
            connectivity = sharpened(connectivity, outlined)
        self._mesh = connectivity
        self._surface = WholeSurface(connectivity, rest_positions, self.is_back(connectivity))
        on_crease = np.zeros(connectivity.vertex_count, dtype=np.bool_)
        on_crease[connectivity.edges[connectivity.is_sharp]] = True
        self._at_creases = np.flatnonzero(on_crease[connectivity.edges].any(axis=1))

    def prepare(self, frame: FrameBuffers) -> None:
        """Compute the surface of this frame with every edge split once, and its normals."""
        self._scheme.prepare(frame)
        self._scheme.place_positions(self._surface.split(frame))
        self._surface.find_normals()

    def place(self, frame: FrameBuffers) -> None:
        """Write points at the positions of the scheme, with the normals of its surface."""
        self._surface.find_normals_of_edges(frame.split_edges)
        self._scheme.place_positions(frame)
        count = len(frame.points) + int(frame.counts[SPLIT_EDGES])
        parallel_for(turn_normals, count, self._mesh.around.points, frame, self._surface.normals)

    def place_centres(self, frame: FrameBuffers) -> None:
        """Let the scheme correct the centres of triangles, and turn their normals."""
        self._scheme.place_centres(frame)
        triangles = self._mesh.faces, self._mesh.triangle_edges
        parallel_for(turn_centres, frame.centre_count, *triangles, frame, self._surface.rows)

    def outlined(self, connectivity: Connectivity) -> Flags:
        """Flags of interior edges that the scheme treats as outlines, shape (E,)."""
        return self._scheme.outlined(connectivity)

    def is_back(self, connectivity: Connectivity) -> Flags:
        """Flags of triangles that the scheme leaves out of normals of other triangles, (F,)."""
        return self._scheme.is_back(connectivity)

    def curved(self, connectivity: Connectivity) -> Flags:
        """Flags of interior edges that the scheme bends like borders, shape (E,)."""
        return self._scheme.curved(connectivity)

    def measure(self, displacements: Floats32, turns: Floats32) -> None:
        """Write how far a split moves the midpoint of every edge, and turns its normal, (E,) each.

        The normal of a vertex on a crease is a mean over both sides. So a split would not correct
        the turn of edges that end there, and their turn is zero.
        """
        self._surface.measure(displacements, turns)
        turns[self._at_creases] = ZERO


@njit
def turn_normals(
    first: int, last: int, points: Unsigned32, frame: FrameBuffers, normals: Floats32
) -> None:
    """Write the normals of vertices, and of points on split edges by their geomorph weights.

    The loop runs over vertices, and then over split edges. `points`: ends and opposite corners of
    edges, shape (E, 4); `normals`: normals of vertices and of points on edges, shape (V + E, 3).
    """
    vertices = frame.rows
    vertex_count = frame.points.shape[0]
    for v in range(first, min(last, vertex_count)):
        write_row(vertices, v, row_of(normals, v), 3)
    for k in range(max(first - vertex_count, 0), last - vertex_count):
        e = frame.split_once[k]
        a = points[e, 0]
        b = points[e, 1]
        row = np.uint32(frame.first_points[e] + (frame.splits[e] >> 1))
        geomorph = min(ONE, NORMAL_HASTE * frame.geomorph_once[e])
        normal = row_of(normals, np.uint32(vertex_count + e))
        if geomorph < ONE:
            mean = unit(plus(row_of(normals, a), row_of(normals, b)))
            normal = unit(mix(mean, normal, geomorph))
        write_row(vertices, row, normal, 3)
        if frame.splits[e] == 2:
            near_a = np.uint32(row - 1)
            near_b = np.uint32(row + 1)
            write_row(vertices, near_a, unit(plus(row_of(normals, a), normal)), 3)
            write_row(vertices, near_b, unit(plus(row_of(normals, b), normal)), 3)


@njit
def turn_centres(
    first: int,
    last: int,
    faces: Unsigned32,
    triangle_edges: Integers32,
    frame: FrameBuffers,
    rows: Floats32,
) -> None:
    """Turn the normals of centres of triangles, by their least geomorph weight.

    They turn to the normal of the hexagon of corners and split points, from `rows`, shape (V + E,
    6).
    """
    vertices = frame.rows
    vertex_count = frame.points.shape[0]
    for k in range(first, last):
        t = frame.centre_triangles[k]
        row = np.uint32(frame.counts[ROWS] + k)
        geomorph = ONE
        hexagon = (ZERO, ZERO, ZERO)
        origin = row_of(rows, faces[t, 0])
        for i in range(3):
            e = triangle_edges[t, i]
            previous = triangle_edges[t, i - 1]
            geomorph = min(geomorph, frame.geomorph_once[e] if frame.splits[e] > 0 else ZERO)
            a = less(row_of(rows, faces[t, i]), ONE, origin)
            after = np.uint32(vertex_count + e)
            before = np.uint32(vertex_count + previous)
            hexagon = plus(hexagon, cross(a, between_rows(rows, before, after)))
        if geomorph > ZERO:
            geomorph = min(ONE, NORMAL_HASTE * geomorph)
            mean = row_of(vertices, row, 3)
            write_row(vertices, row, unit(mix(mean, unit(hexagon), geomorph)), 3)
