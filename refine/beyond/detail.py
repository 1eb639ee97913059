r"""Detail of a finer mesh on the split points: the scheme named `detail`.

Kähler, Haber, Seidel 2003, section 6: "If the input geometry has been produced from a finer mesh,
one could do even better than smoothing: detail information can be stored locally and used to place
generated split vertices on the surface, as has been exercised in multiresolution editing."

At binding, the points that all edges would get from the scheme `cubic` are compared with where they
fit the finer mesh best (fit.py), both at rest. What is missing is stored along directions that move
with the surface:

          n                                     stored:  how the finer surface lies beside the
          |                                              point, along n, t and n x t
    a-----o------> t = b - a
         /                                      n:  upright on the edge in its middle, half way from
        n x t                                       there to the normal of the end at its quarters

In a frame the same directions are found in the deformed mesh and the detail is added to the cubic.
A quarter has to turn with the vertex near it: with one direction n for all of an edge, stars stood
around the vertices where the mesh was folded.

The middle of an edge has two places, for one split and for two (fit.py), and goes from the first to
the second while the quarters grow. The middle of a triangle, which blending adds, slides toward the
edges that bend (axes.py).

Vertices stay where they are (they lie on the finer mesh if they are taken from it). Normals are not
the finer mesh's but those of the refined surface (surface_normals.py), which has its shape.
"""

import numpy as np
import numpy.typing as npt

from ...geometry.normals import vertex_normals
from ...jit import njit
from ..kahler.frame import CENTRES, ROWS, FrameBuffers
from ..mesh.arrays import Doubles, Floats, Unsigned
from ..mesh.connectivity import Connectivity
from ..mesh.validation import checked_indices, checked_positions
from ..mesh.vectors import HALF, ONE, THIRD, ZERO, Vector, plus, row_of, times
from .axes import FOUR, find_middles, middle_axes, quarter_axes, slide_middle, triangle_axes
from .blending import FOUR_NINTHS
from .cubic import CubicScheme
from .fit import ALONE, END, MIDDLE, START, FinerSurface, Points, fit, middles_of

FinerMesh = tuple[npt.ArrayLike, npt.ArrayLike]
"""Positions at rest, shape (V, 3), and triangles, shape (F, 3)."""

AXES_OF = [START, MIDDLE, END, MIDDLE]
"""The directions that each point of an edge is stored along: both middles have the same."""


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
        normals = vertex_normals(positions, faces)
        self._finer: FinerSurface | None = FinerSurface(positions, normals, faces)

    def bind(
        self, connectivity: Connectivity, rest_positions: Doubles, rest_normals: Floats
    ) -> None:
        """Compare the cubic at rest with the finer mesh, point by point."""
        super().bind(connectivity, rest_positions, rest_normals)
        assert self._finer is not None, "a scheme is bound once"
        mesh = connectivity
        self._axes = np.zeros((len(mesh.edges), 3, 3, 3), dtype=np.float32)
        self._displace(rest_positions)
        normals = self._normals  # at rest: all directions follow those that the cubic has
        shares = np.zeros((len(mesh.faces), 3), dtype=np.float32)
        centre_axes = np.zeros((len(mesh.faces), 3, 3), dtype=np.float32)
        find_middles(rest_positions, normals, mesh.faces, shares, centre_axes)
        points, ups = _points_on(self._displacements, mesh, rest_positions, normals)
        middles = shares.astype(np.float64), centre_axes[:, 0].astype(np.float64)
        places = fit(self._finer, mesh, rest_positions, normals, (points, ups), middles)
        centres = middles_of(places.of_edges, mesh, rest_positions, middles[0])
        offsets = Points(places.of_edges - points, places.of_triangles - centres)
        every_edge = np.arange(len(mesh.edges), dtype=np.uint32)
        middle_axes(self._around, rest_positions, normals, self._axes)
        quarter_axes(self._around, rest_positions, normals, every_edge, self._axes)
        self._offsets = _along(self._axes[:, AXES_OF], offsets.of_edges)
        self._centre_offsets = _along(centre_axes[:, None], offsets.of_triangles)
        self._finer = None

    def prepare(self, frame: FrameBuffers) -> None:
        """Find the displacements of all edges as if each were split once."""
        super().prepare(frame)
        middle_axes(self._around, frame.positions, self._normals, self._axes)
        add_offsets_once(self._offsets, self._axes, self._displacements)

    def place_positions(self, frame: FrameBuffers) -> None:
        """Write points with their detail; only once after `prepare` with edges split twice."""
        twice = frame.twice_split_edges
        quarter_axes(self._around, frame.positions, self._normals, twice, self._axes)
        add_offsets_twice(
            twice, frame.geomorph_twice, self._offsets, self._axes, self._displacements
        )
        super().place_positions(frame)

    def place_centres(self, frame: FrameBuffers) -> None:
        """Slide and move the points in the middle of triangles."""
        slide_centres(self._mesh, frame, self._normals, self._centre_offsets)


def _points_on(
    displacements: Floats, mesh: Connectivity, positions: Doubles, normals: Floats
) -> tuple[Doubles, Doubles]:
    """Points of all edges (fit.Points), and normals around there, both of shape (E, 4, 3)."""
    share = np.array([0.25, 0.5, 0.75])[:, None]
    a, b = mesh.edges[:, 0], mesh.edges[:, 1]
    points = (1.0 - share) * positions[a][:, None] + share * positions[b][:, None] + displacements
    between = (1.0 - share) * normals[a][:, None] + share * normals[b][:, None]
    return points[:, AXES_OF], between[:, AXES_OF]


def _along(axes: Floats, vectors: Doubles) -> Floats:
    """Components of vectors (.., 3) along the rows of axes (.., 3, 3)."""
    components: Doubles = np.einsum("...ij,...j->...i", axes.astype(np.float64), vectors)
    return components.astype(np.float32)


@njit
def add_offsets_once(offsets: Floats, axes: Floats, displacements: Floats) -> None:
    """Add the stored offsets of middles, shape (E, 4, 3), to their displacements, shape (E, 3, 3).

    `axes`: shape (E, 3, 3, 3), edge, point, direction.
    """
    for e in range(displacements.shape[0]):
        for j in range(3):
            for i in range(3):
                displacements[e, MIDDLE, i] += offsets[e, ALONE, j] * axes[e, MIDDLE, j, i]


@njit
def add_offsets_twice(
    edges: Unsigned, geomorph_twice: Floats, offsets: Floats, axes: Floats, displacements: Floats
) -> None:
    """Add what a second split of some edges, shape (N,), shows: middles have those of one already.

    `geomorph_twice`: shape (E,); the rest as for `add_offsets_once`.
    """
    for e in edges:
        for j in range(3):
            step = geomorph_twice[e] * (offsets[e, MIDDLE, j] - offsets[e, ALONE, j])
            for i in range(3):
                displacements[e, MIDDLE, i] += step * axes[e, MIDDLE, j, i]
                displacements[e, START, i] += offsets[e, START, j] * axes[e, START, j, i]
                displacements[e, END, i] += offsets[e, END, j] * axes[e, END, j, i]


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
        once = min(once, frame.geomorph_once[e])
        twice = min(twice, frame.geomorph_twice[e] if frame.splits[e] == 2 else ZERO)
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
            displacement = once * (FOUR * shares[i] * shares[(i + 1) % 3] - FOUR_NINTHS)
            for j in range(3):
                out = vertices[middle, j] - HALF * (vertices[a, j] + vertices[b, j])
                vertices[row, j] += corner * vertices[a, j] + displacement * out
        offset = mixed_rows(offsets[t], 1, 0, twice)
        for j in range(3):
            for i in range(3):
                vertices[row, i] += once * offset[j] * axes[j, i]
