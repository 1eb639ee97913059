r"""Detail of a finer mesh on the split points: the scheme named `detail`.

Kähler, Haber, Seidel 2003, section 6: "If the input geometry has been produced from a finer mesh,
one could do even better than smoothing: detail information can be stored locally and used to place
generated split vertices on the surface, as has been exercised in multiresolution editing."

At binding, the scheme `cubic` places points on all edges. Each is compared with the closest point
of the finer mesh whose surface faces the same way, both at rest. A point is displaced FULLNESS
times as far as its closest point, as in the scheme `cubic`, because triangles between points are
flat. The difference from the cubic is stored along three directions that move with the surface:

          n                                     stored:  offset of the finer surface from the
          |                                              point, along n, t and n x t
    a-----o------> t = b - a
         /                                      n:  upright on the edge in its middle, half way from
        n x t                                       there to the normal of the end at its quarters

In a frame the same directions are found in the deformed mesh, and the stored detail is added to the
cubic. The directions change continuously as long as normals and edges do. A quarter point must turn
with the vertex near it: one direction n for a whole edge gives star-shaped artefacts around
vertices where the mesh is folded.

Vertices stay where they are (they lie on the finer mesh if they are taken from it). Normals are the
normals of the refined surface (surface_normals.py), which has the shape of the finer mesh.
"""

import numpy as np
import numpy.typing as npt

from ...geometry.arrays import Floats32, Floats64, Unsigned32
from ...geometry.closest import closest_points
from ...geometry.vectors import (
    SMALLEST_FLOAT,
    Vector,
    between,
    cross,
    dot,
    less,
    plus,
    row_of,
    unit,
    write_row,
)
from ...jit import njit
from ..kahler.frame import FrameBuffers
from ..mesh.connectivity import Connectivity, Surroundings
from ..mesh.validation import checked_mesh
from .cubic import END_POINT, FULLNESS_FACTOR, MIDDLE_POINT, START_POINT, CubicScheme
from .measuring import mean_length

FinerMesh = tuple[npt.ArrayLike, npt.ArrayLike]
"""Positions at rest, shape (V, 3), and triangles, shape (F, 3)."""

WRONG_SIDE_DISTANCE = 10.0
"""Distance, in edge lengths, that is added for a surface that faces the other way. So a point of
one lip finds no point of the other lip, although they touch at rest.
"""


class DetailScheme(CubicScheme):
    """Cubic edges with the additional form of a finer mesh at rest."""

    def __init__(self, finer: FinerMesh | None = None) -> None:
        """`finer`: positions at rest, aligned with the coarse mesh, and triangles.

        Raises ValueError without a finer mesh, such as when the scheme is chosen by the name
        `detail` alone.
        """
        if not isinstance(finer, tuple) or len(finer) != 2:
            raise ValueError(
                "the scheme detail needs a finer mesh: pass "
                "scheme=refine.DetailScheme((rest positions, triangles)), "
                f"got {type(finer).__name__}"
            )
        super().__init__()
        positions, faces = checked_mesh(*finer, ("finer[0]", "finer[1]"))
        if len(faces) == 0:
            raise ValueError("finer[1] must have triangles, got none")
        self._finer = positions, faces

    def bind(
        self, connectivity: Connectivity, rest_positions: Floats64, rest_normals: Floats32
    ) -> None:
        """Compare the cubic at rest with the finer mesh, point by point."""
        super().bind(connectivity, rest_positions, rest_normals)
        edge_count = len(connectivity.edges)
        self._every_edge = np.arange(edge_count, dtype=np.uint32)
        self._axes = np.zeros((edge_count, 3, 3, 3), dtype=np.float32)
        rest = rest_positions.copy()  # single precision, as in frames
        self._displace(rest)
        normals = self._normals  # at rest: all directions are derived from the normals of the cubic
        middle_axes(self._around, rest, normals, self._axes)
        quarter_axes(self._around, rest, normals, self._every_edge, self._axes)

        fraction = np.array([0.25, 0.5, 0.75])[:, None]
        start, end = connectivity.edges.T
        straight = (1.0 - fraction) * rest_positions[start][:, None]
        straight += fraction * rest_positions[end][:, None]
        points = straight + self._displacements
        directions = (1.0 - fraction) * normals[start][:, None] + fraction * normals[end][:, None]
        away = WRONG_SIDE_DISTANCE * float(mean_length(connectivity, rest_positions))
        found = closest_points(points.reshape(-1, 3), *self._finer, directions.reshape(-1, 3), away)
        closest = found.interpolate(self._finer[0]).reshape(points.shape)
        missing = straight + float(FULLNESS_FACTOR) * (closest - straight) - points
        axes = self._axes.astype(np.float64)
        self._offsets = np.einsum("epij,epj->epi", axes, missing).astype(np.float32)

    def prepare(self, frame: FrameBuffers) -> None:
        """Compute the displacements of the points on all edges, with detail only at midpoints."""
        super().prepare(frame)
        middle_axes(self._around, frame.positions, self._normals, self._axes)
        self._add(self._every_edge, MIDDLE_POINT)

    def place_positions(self, frame: FrameBuffers) -> None:
        """Write points with their detail; call it once per `prepare` if edges are split twice."""
        twice = frame.twice_split_edges
        quarter_axes(self._around, frame.positions, self._normals, twice, self._axes)
        self._add(twice, START_POINT)
        self._add(twice, END_POINT)
        super().place_positions(frame)

    def _add(self, edges: Unsigned32, point: int) -> None:
        add_offsets(edges, point, self._offsets, self._axes, self._displacements)


@njit
def add_offsets(
    edges: Unsigned32, point: int, offsets: Floats32, axes: Floats32, displacements: Floats32
) -> None:
    """Add stored offsets to the displacements, (E, 3, 3), of one point of some edges, (N,).

    `offsets`: shape (E, 3, 3), edge, point, direction; `axes`: shape (E, 3, 3, 3).
    """
    for e in edges:
        for j in range(3):
            for i in range(3):
                displacements[e, point, i] += offsets[e, point, j] * axes[e, point, j, i]


@njit
def write_axes(up: Vector, towards: Vector, axes: Floats32) -> None:
    """Write three orthogonal directions of length one as rows of `axes`, shape (3, 3).

    The first is `up`; the second is `towards`, made normal to `up`.
    """
    up = unit(up)
    towards = unit(less(towards, dot(up, towards), up))
    write_row(axes, 0, up)
    write_row(axes, 1, towards)
    write_row(axes, 2, cross(up, towards))


@njit
def middle_axes(
    around: Surroundings, positions: Floats64, normals: Floats32, axes: Floats32
) -> None:
    """Write the directions at the midpoints of edges: normal to the edge, along it, across both.

    The first direction is the mean of the normals at both ends, made normal to the edge. `normals`:
    of vertices, shape (V, 3); `axes`: shape (E, 3, 3, 3), edge, point, direction.
    """
    for e in range(axes.shape[0]):
        a = around.points[e, 0]
        b = around.points[e, 1]
        along = between(positions, a, b)
        mean = plus(row_of(normals, a), row_of(normals, b))
        up = unit(less(mean, dot(along, mean) / max(dot(along, along), SMALLEST_FLOAT), along))
        write_axes(up, along, axes[e, MIDDLE_POINT])


@njit
def quarter_axes(
    around: Surroundings, positions: Floats64, normals: Floats32, edges: Unsigned32, axes: Floats32
) -> None:
    """Write the directions at the quarters of some edges, shape (N,), from those at the midpoints.

    The first direction is the mean of two: the first direction at the midpoint, and the normal at
    the near end. So a
    point near a vertex turns with the vertex, not with the edge.
    """
    for e in edges:
        a = around.points[e, 0]
        b = around.points[e, 1]
        up = row_of(axes[e, MIDDLE_POINT], 0)
        along = between(positions, a, b)
        write_axes(plus(up, row_of(normals, a)), along, axes[e, START_POINT])
        write_axes(plus(up, row_of(normals, b)), along, axes[e, END_POINT])
