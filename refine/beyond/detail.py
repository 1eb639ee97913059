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

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ...jit import njit
from ..kahler.frame import CENTRES, ONCE, ROWS, FrameBuffers
from ..kahler.smoothing import growth_of_split, mix
from ..mesh.arrays import Doubles, Floats, Unsigned
from ..mesh.connectivity import Connectivity, Surroundings
from ..mesh.validation import checked_indices, checked_positions
from ..mesh.vectors import HALF, ONE, ZERO, Vector, less, plus, row_of, times, unit, write_row
from .axes import edge_axes, find_middles, slide_middle, triangle_axes, vertex_axes
from .closest import SearchSurface
from .cubic import CubicScheme
from .curves import place_on_curves
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


class Stored(NamedTuple):
    """Detail along directions that move with the surface; compiled code takes it as it is.

    `START, MIDDLE, END, ALONE` are the points of an edge (fit.py); the middle of a triangle has one
    of them with edges split twice, and one with edges split once.
    """

    offsets: Floats
    """What is missing at the points of edges, shape (E, 4, 3)."""
    normals: Floats
    """Normals there, shape (E, 4, 3)."""
    centre_offsets: Floats
    """What is missing in the middle of triangles, shape (F, 2, 3)."""
    centre_normals: Floats
    """Normals there, shape (F, 2, 3)."""
    vertex_normals: Floats
    """Normals at vertices, shape (V, 3)."""


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
        self._surface: SearchSurface | None = SearchSurface(positions, faces.astype(np.uint32))

    def bind(
        self, connectivity: Connectivity, rest_positions: Doubles, rest_normals: Floats
    ) -> None:
        """Compare the cubic at rest with the finer mesh, point by point."""
        super().bind(connectivity, rest_positions, rest_normals)
        assert self._surface is not None, "a scheme is bound once"
        mesh = connectivity
        self._axes = np.zeros((len(mesh.edges), 3, 3, 3), dtype=np.float32)
        self._vertex_axes = np.zeros((len(rest_normals), 3, 3), dtype=np.float32)
        self._fine_normals = np.zeros_like(rest_normals)
        self._towards = _longest_edges(mesh, rest_positions)
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
        places, fine_normals, saved = fit(
            self._surface, mesh, rest_positions, rest_normals, (points, ups), middles
        )
        centres = middles_of(places.of_edges, mesh, rest_positions, middles[0])
        offsets = Points(places.of_edges - points, places.of_triangles - centres)
        self._find_axes(rest_positions, rest_normals)
        self._stored = self._remember(offsets, fine_normals, centre_axes)
        # What is off around an edge; and what turns in its middle, where few finer vertices are.
        turns = self._turns_at(rest_positions, fine_normals)
        self.turns = np.hypot(saved, turns).astype(np.float32)
        self._surface = None

    def _find_axes(self, rest_positions: Doubles, rest_normals: Floats) -> None:
        """Find the directions of all edges, as if split twice, and of all vertices at rest."""
        twice = np.full(len(self._mesh.edges), 2, dtype=np.uint8)
        everything = self._every_edge._replace(positions=rest_positions, splits=twice)
        edge_axes(self._around, everything, rest_normals, self._axes)
        vertex_axes(rest_positions, rest_normals, self._towards, self._vertex_axes)

    def _remember(self, offsets: Points, fine_normals: Doubles, centre_axes: Floats) -> Stored:
        """Return offsets and normals along the directions of edges, triangles and vertices."""
        mesh = self._mesh
        point_normals = Points.unstacked(fine_normals, mesh)
        point_axes = self._axes[:, AXES_OF]
        return Stored(
            offsets=_along(point_axes, offsets.of_edges),
            normals=_along(point_axes, point_normals.of_edges),
            centre_offsets=_along(centre_axes[:, None], offsets.of_triangles),
            centre_normals=_along(centre_axes[:, None], point_normals.of_triangles),
            # A vertex without a normal has no frame: nothing to show there.
            vertex_normals=_along(self._vertex_axes, fine_normals[: mesh.vertex_count]),
        )

    def _turns_at(self, rest_positions: Doubles, fine_normals: Doubles) -> Doubles:
        """How far the middle of each edge split once turns from between its ends, shape (E,).

        Times the root of the edge's length in mean lengths: a longer edge shows more of it.
        """
        mesh = self._mesh
        mean = fine_normals[mesh.edges].sum(axis=1)
        mean /= np.maximum(np.linalg.norm(mean, axis=1, keepdims=True), 1e-12)
        middles = Points.unstacked(fine_normals, mesh).of_edges[:, ALONE]
        angles = np.arccos(np.clip((mean * middles).sum(axis=1), -1.0, 1.0))
        lengths = np.linalg.norm(np.diff(rest_positions[mesh.edges], axis=1)[:, 0], axis=1)
        share = np.sqrt(lengths / max(float(lengths.mean()), 1e-300)) if len(lengths) else lengths
        turns: Doubles = angles * share
        return turns

    def place(self, frame: FrameBuffers) -> None:
        """Write vertices and points, with the normals of the finer mesh."""
        around, normals, stored = self._around, self._tangents.normals, self._stored
        bulges = self._bulge(frame)
        vertex_axes(frame.positions, normals, self._towards, self._vertex_axes)
        turn_vertices(normals, stored.vertex_normals, self._vertex_axes, self._fine_normals)
        place_on_curves(around, frame, self._fine_normals, bulges)
        turn_points(around, frame, stored.normals, self._axes)

    def place_centres(self, frame: FrameBuffers) -> None:
        """Slide, move and turn the points in the middle of triangles."""
        refine_centres(self._mesh, frame, self._tangents.normals, self._stored)

    def _bulge(self, frame: FrameBuffers) -> Floats:
        bulges = super()._bulge(frame)
        edge_axes(self._around, frame, self._tangents.normals, self._axes)
        add_offsets(frame, self._stored.offsets, self._axes, bulges)
        return bulges


def _longest_edges(mesh: Connectivity, positions: Doubles) -> Unsigned:
    """The other end of the longest edge of every vertex, itself where it has none, shape (V,)."""
    towards = np.arange(mesh.vertex_count, dtype=np.uint32)
    both_ways = np.concatenate([mesh.edges, mesh.edges[:, ::-1]])
    along = positions[both_ways[:, 1]] - positions[both_ways[:, 0]]
    squared = along[:, 0] ** 2 + along[:, 1] ** 2 + along[:, 2] ** 2
    # Written last, so that the order of edges does not matter.
    start, end = both_ways[np.argsort(squared, kind="stable")].T
    towards[start] = end
    return towards


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
def turned(normal: Vector, stored: Vector, axes: Floats, share: np.float32) -> Vector:
    """Turn a unit normal a share of the way to the one that is stored along `axes`.

    `axes`: directions as rows, shape (3, 3). The result has length one.
    """
    u, v, w = stored
    x = u * axes[0, 0] + v * axes[1, 0] + w * axes[2, 0]
    y = u * axes[0, 1] + v * axes[1, 1] + w * axes[2, 1]
    z = u * axes[0, 2] + v * axes[1, 2] + w * axes[2, 2]
    return unit(plus(normal, times(share, less((x, y, z), ONE, normal))))


@njit
def mixed_rows(rows: Floats, k: int, n: int, share: np.float32) -> Vector:
    """A share of the way from row k to row n."""
    return plus(times(ONE - share, row_of(rows, k)), times(share, row_of(rows, n)))


@njit
def turn_vertices(normals: Floats, fine_normals: Floats, axes: Floats, turned_rows: Floats) -> None:
    """Write the finer normal of every vertex, turned with its surroundings."""
    for v in range(normals.shape[0]):
        write_row(turned_rows, v, turned(row_of(normals, v), row_of(fine_normals, v), axes[v], ONE))


@njit
def turn_points(
    around: Surroundings, frame: FrameBuffers, fine_normals: Floats, axes: Floats
) -> None:
    """Turn the normals of the points of split edges to those of the finer mesh.

    `fine_normals`: shape (E, 4, 3); `axes`: shape (E, 3, 3, 3), edge, point, direction.
    """
    vertices = frame.rows
    for k in range(frame.counts[ONCE]):
        e = frame.split_once[k]
        row = np.uint32(frame.first_points[e] + (frame.splits[e] >> 1))
        share = frame.growth_once[e]
        if around.is_interior[e]:
            grown = ZERO
            for i in range(4):
                grown += QUARTER * growth_of_split(
                    frame.splits, frame.growth_once, around.wings[e, i]
                )
            share = min(share, grown)
        twice = frame.growth_twice[e] if frame.splits[e] == 2 else ZERO
        wanted = mixed_rows(fine_normals[e], ALONE, MIDDLE, twice)
        middle = turned(row_of(vertices, row, 3), wanted, axes[e, MIDDLE], share)
        write_row(vertices, row, middle, 3)
        if frame.splits[e] < 2:
            continue
        for end in range(2):
            # Between its neighbours at first, of which the middle has just been turned.
            a, point = around.points[e, end], START + (END - START) * end
            between = times(HALF, plus(row_of(vertices, a, 3), middle))
            wanted = row_of(fine_normals[e], point)
            quarter = turned(between, wanted, axes[e, point], min(share, twice))
            write_row(vertices, np.uint32(row - 1 + 2 * end), quarter, 3)


@njit
def refine_centres(
    mesh: Connectivity, frame: FrameBuffers, normals: Floats, stored: Stored
) -> None:
    """Slide, move and turn the points in the middle of triangles as the least grown edge allows.

    Where all edges have grown, blending has them in the centroid (blending.py).
    `normals`: of vertices, shape (V, 3).
    """
    vertices = frame.rows
    shares, axes = np.zeros(3, np.float32), np.zeros((3, 3), np.float32)
    for k in range(frame.counts[CENTRES]):
        t, row = frame.centre_triangles[k], np.uint32(frame.counts[ROWS] + k)
        once = twice = ONE
        for i in range(3):
            e = mesh.triangle_edges[t, i]
            once = min(once, frame.growth_once[e])
            twice = min(twice, frame.growth_twice[e] if frame.splits[e] == 2 else ZERO)
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
        offset = mixed_rows(stored.centre_offsets[t], 1, 0, twice)
        for j in range(3):
            for i in range(3):
                vertices[row, i] += once * offset[j] * axes[j, i]
        wanted = mixed_rows(stored.centre_normals[t], 1, 0, twice)
        write_row(vertices, row, turned(row_of(vertices, row, 3), wanted, axes, once), 3)
