r"""Detail of a finer mesh on the split points: the scheme named `detail`.

Kähler, Haber, Seidel 2003, section 6: "If the input geometry has been produced from a finer mesh,
one could do even better than smoothing: detail information can be stored locally and used to place
generated split vertices on the surface, as has been exercised in multiresolution editing."

At binding, the points that all edges would get from the scheme `cubic` are compared with the finer
mesh, both at rest. What is missing is stored along directions that move with the surface:

          n                                     stored:  how the finer surface lies beside the
          |                                              point, and its normal, along n, t and n x t
    a-----o------> t = b - a
         /                                      n:  upright on the edge in its middle, half way from
        n x t                                       there to the normal of the end at its quarters

In a frame the same directions are found in the deformed mesh and the detail is added to the cubic.
A quarter has to turn with the vertex near it: with one direction n for all of an edge, the normals
around a vertex turned less than its own where the mesh was folded, and stars stood there.

The normal of a point turns to that of the finer mesh as far as the edges around have grown, in the
mean: where what is refined ends, a fold would otherwise end as a crease. The middle of a triangle,
which blending adds, slides toward the edges that bend (axes.py).

The middle of an edge has two places, for one split and for two (fit.py), and goes from the first to
the second while the quarters grow.

Vertices stay where they are (they lie on the finer mesh if they are taken from it). All of them
show its normals, fitted (fit.py) and stored along their own normal and one of their edges.
"""

import numpy as np
import numpy.typing as npt

from ...jit import njit
from ..kahler.frame import CENTRES, ONCE, ROWS, FrameBuffers
from ..kahler.smoothing import mix
from ..mesh.arrays import Doubles, Floats
from ..mesh.connectivity import Connectivity
from ..mesh.validation import checked_indices, checked_positions
from ..mesh.vectors import HALF, ONE, ZERO, Vector, plus, row_of, times
from .axes import (
    edge_axes,
    find_middles,
    slide_middle,
    triangle_axes,
)
from .closest import SearchSurface
from .cubic import CubicScheme
from .fit import Points, fit, middles_of

FinerMesh = tuple[npt.ArrayLike, npt.ArrayLike]
"""Positions at rest, shape (V, 3), and triangles, shape (F, 3)."""

START, MIDDLE, END, ALONE = 0, 1, 2, 3
"""Points of an edge (fit.py)."""
AXES_OF = [START, MIDDLE, END, MIDDLE]
"""The directions that each point of an edge is stored along: both middles have the same."""
THIRD = np.float32(1 / 3)
FOUR = np.float32(4.0)
FOUR_NINTHS = np.float32(4 / 9)
QUARTER = np.float32(0.25)


class DetailScheme(CubicScheme):
    """Cubic edges with what a finer mesh at rest has in addition."""

    def __init__(self, finer: FinerMesh) -> None:
        """`finer`: positions at rest, in the place of the coarse mesh, and triangles."""
        if not isinstance(finer, tuple) or len(finer) != 2:
            raise ValueError(
                "detail must be a pair (finer rest positions, finer triangles), "
                f"got {type(finer).__name__}"
            )
        positions = checked_positions(finer[0], "detail[0]")
        faces = checked_indices("detail[1]", finer[1], len(positions), "detail[0]")
        if len(faces) == 0:
            raise ValueError("detail[1] must have triangles, got none")
        self._finer: SearchSurface | None = SearchSurface(positions, faces.astype(np.uint32))

    def bind(
        self, connectivity: Connectivity, rest_positions: Doubles, rest_normals: Floats
    ) -> None:
        """Compare the cubic at rest with the finer mesh, point by point."""
        super().bind(connectivity, rest_positions, rest_normals)
        assert self._finer is not None, "a scheme is bound once"
        mesh = connectivity
        self._axes = np.zeros((len(mesh.edges), 3, 3, 3), dtype=np.float32)
        bulges = super()._bulge(
            self._every_edge._replace(positions=rest_positions, normals=rest_normals)
        )
        # All directions follow the normals that the cubic has, now as in every frame.
        rest_normals = self._tangents.normals.copy()
        shares = np.zeros((len(mesh.faces), 3), dtype=np.float32)
        centre_axes = np.zeros((len(mesh.faces), 3, 3), dtype=np.float32)
        find_middles(rest_positions, rest_normals, mesh.faces, shares, centre_axes)
        points, ups = _points_on(bulges, mesh, rest_positions, rest_normals)
        middles = shares.astype(np.float64), centre_axes[:, 0].astype(np.float64)
        places = fit(self._finer, mesh, rest_positions, rest_normals, (points, ups), middles)
        centres = middles_of(places.of_edges, mesh, rest_positions, middles[0])
        offsets = Points(places.of_edges - points, places.of_triangles - centres)
        twice = np.full(len(mesh.edges), 2, dtype=np.uint8)
        everything = self._every_edge._replace(
            positions=rest_positions, points=rest_positions.astype(np.float32), splits=twice
        )
        edge_axes(mesh.around, everything, rest_normals, self._axes)
        self._offsets = _along(self._axes[:, AXES_OF], offsets.of_edges)
        self._centre_offsets = _along(centre_axes[:, None], offsets.of_triangles)
        self._finer = None

    def place_centres(self, frame: FrameBuffers) -> None:
        """Slide and move the points in the middle of triangles."""
        slide_centres(self._mesh, frame, self._tangents.normals, self._centre_offsets)

    def _bulge(self, frame: FrameBuffers) -> Floats:
        bulges = super()._bulge(frame)
        edge_axes(self._around, frame, self._tangents.normals, self._axes)
        add_offsets(frame, self._offsets, self._axes, bulges)
        return bulges


def _points_on(
    bulges: Floats, mesh: Connectivity, positions: Doubles, normals: Floats
) -> tuple[Doubles, Doubles]:
    """Points of all edges (fit.Points), and normals there, both of shape (E, 4, 3)."""
    share = np.array([0.25, 0.5, 0.75])[:, None]
    a, b = mesh.edges[:, 0], mesh.edges[:, 1]
    points = (1.0 - share) * positions[a][:, None] + share * positions[b][:, None] + bulges
    between = (1.0 - share) * normals[a][:, None] + share * normals[b][:, None]
    return points[:, AXES_OF], between[:, AXES_OF]


def _along(axes: Floats, vectors: Doubles) -> Floats:
    """Components of vectors (.., 3) along the rows of axes (.., 3, 3)."""
    components: Doubles = np.einsum("...ij,...j->...i", axes.astype(np.float64), vectors)
    return components.astype(np.float32)


@njit
def add_offsets(frame: FrameBuffers, offsets: Floats, axes: Floats, bulges: Floats) -> None:
    """Add the stored offsets of the split edges, shape (E, 4, 3), to their bulges.

    `axes`: shape (E, 3, 3, 3), edge, point, direction; `bulges`: shape (E, 3, 3).
    """
    for k in range(frame.counts[ONCE]):
        e = frame.split_once[k]
        is_twice = frame.splits[e] == 2
        twice = frame.growth_twice[e] if is_twice else ZERO
        for j in range(3):
            offset = mix(offsets[e, ALONE, j], offsets[e, MIDDLE, j], twice)
            for i in range(3):
                bulges[e, MIDDLE, i] += offset * axes[e, MIDDLE, j, i]
                if is_twice:
                    bulges[e, START, i] += offsets[e, START, j] * axes[e, START, j, i]
                    bulges[e, END, i] += offsets[e, END, j] * axes[e, END, j, i]


@njit
def mixed_rows(rows: Floats, k: int, n: int, share: np.float32) -> Vector:
    """A share of the way from row k to row n."""
    return plus(times(ONE - share, row_of(rows, k)), times(share, row_of(rows, n)))


@njit
def grown_around(mesh: Connectivity, frame: FrameBuffers, t: int) -> tuple[np.float32, np.float32]:
    """How far the least grown edge of a triangle has grown, for its first and its second split."""
    once = twice = ONE
    for i in range(3):
        e = mesh.triangle_edges[t, i]
        once = min(once, frame.growth_once[e])
        twice = min(twice, frame.growth_twice[e] if frame.splits[e] == 2 else ZERO)
    return once, twice


@njit
def slide_centres(
    mesh: Connectivity, frame: FrameBuffers, normals: Floats, offsets: Floats
) -> None:
    """Slide and move the points in the middle of triangles as the least grown edge allows.

    Where all edges have grown, blending has them in the centroid (blending.py).
    `normals`: of vertices, shape (V, 3). `offsets`: what is missing, shape (F, 2, 3).
    """
    vertices = frame.rows
    shares, axes = np.zeros(3, np.float32), np.zeros((3, 3), np.float32)
    for k in range(frame.counts[CENTRES]):
        t, row = frame.centre_triangles[k], np.uint32(frame.counts[ROWS] + k)
        once, twice = grown_around(mesh, frame, t)
        if once == ZERO:
            continue
        slide_middle(frame.positions, normals, mesh.faces, t, shares)
        triangle_axes(frame.positions, normals, mesh.faces, t, shares, axes)
        for i in range(3):
            e, a, b = mesh.triangle_edges[t, i], mesh.faces[t, i], mesh.faces[t, (i + 1) % 3]
            middle = frame.first_points[e] + (frame.splits[e] >> 1)
            corner = once * (shares[i] - THIRD)
            bulge = once * (FOUR * shares[i] * shares[(i + 1) % 3] - FOUR_NINTHS)
            for j in range(3):
                out = vertices[middle, j] - HALF * (vertices[a, j] + vertices[b, j])
                vertices[row, j] += corner * vertices[a, j] + bulge * out
        offset = mixed_rows(offsets[t], 1, 0, twice)
        for j in range(3):
            for i in range(3):
                vertices[row, i] += once * offset[j] * axes[j, i]
