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
which blending adds, slides toward the edges that bend (local_frames.py).

The middle of an edge has two places, for one split and for two (fit.py), and goes from the first to
the second while the quarters grow.

Vertices stay where they are (they lie on the finer mesh if they are taken from it). All of them
show its normals, fitted (fit.py) and stored along their own normal and one of their edges.
"""

import numpy as np
import numpy.typing as npt

from .arguments import checked_indices, checked_positions
from .closest import Surface
from .connectivity import Connectivity
from .cubic import CubicScheme
from .fit import Points, fit, middles_of
from .kernels import kernel
from .local_frames import edge_axes, list_grown, slide_middles, triangle_axes, vertex_axes
from .schemes import Frame

Floats = npt.NDArray[np.float32]
Doubles = npt.NDArray[np.float64]
Unsigned = npt.NDArray[np.uint32]

FinerMesh = tuple[npt.ArrayLike, npt.ArrayLike]
"""Positions at rest, shape (V, 3), and triangles, shape (F, 3)."""

START, MIDDLE, END, ALONE = 0, 1, 2, 3
"""Points of an edge (fit.py)."""
AXES_OF = [START, MIDDLE, END, MIDDLE]
"""The directions that each point of an edge is stored along: both middles have the same."""
ZERO = np.float32(0.0)
THIRD = np.float32(1 / 3)
FOUR = np.float32(4.0)
FOUR_NINTHS = np.float32(4 / 9)
QUARTER = np.float32(0.25)
HALF = np.float32(0.5)
ONE = np.float32(1.0)
TINY = np.finfo(np.float32).tiny


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
        self._surface: Surface | None = Surface(positions, faces.astype(np.uint32))

    def bind(
        self, connectivity: Connectivity, rest_positions: Doubles, rest_normals: Floats
    ) -> None:
        """Compare the cubic at rest with the finer mesh, point by point."""
        super().bind(connectivity, rest_positions, rest_normals)
        assert self._surface is not None, "a scheme is bound once"
        edge_count = len(connectivity.edges)
        self._axes = np.zeros((edge_count, 3, 3, 3), dtype=np.float32)
        self._centre_axes = np.zeros((len(connectivity.faces), 3, 3), dtype=np.float32)
        self._middle_shares = np.zeros((len(connectivity.faces), 3), dtype=np.float32)
        self._vertex_axes = np.zeros((len(rest_normals), 3, 3), dtype=np.float32)
        self._shown = np.zeros_like(rest_normals)
        self._towards = np.arange(connectivity.vertex_count, dtype=np.uint32)
        # The longest edge of a vertex, written last: no matter of the order of edges.
        both_ways = np.concatenate([connectivity.edges, connectivity.edges[:, ::-1]])
        along = rest_positions[both_ways[:, 1]] - rest_positions[both_ways[:, 0]]
        squared = along[:, 0] ** 2 + along[:, 1] ** 2 + along[:, 2] ** 2
        start, end = both_ways[np.argsort(squared, kind="stable")].T
        self._towards[start] = end
        super()._bulge(self._every_edge(rest_positions, rest_normals), self._bulges)
        # All directions follow the normals that the cubic has, now as in every frame.
        rest_normals = self._normals.copy()
        self._grown = np.arange(len(connectivity.faces), dtype=np.uint32)
        self._find_middles(rest_positions, rest_normals, len(self._grown))
        points, ups = _points_on(self._bulges, connectivity, rest_positions, rest_normals)
        shares = self._middle_shares.astype(np.float64)
        middles = shares, self._centre_axes[:, 0].astype(np.float64)
        places, looks, saved = fit(
            self._surface, connectivity, rest_positions, rest_normals, (points, ups), middles
        )
        centres = middles_of(places.of_edges, connectivity, rest_positions, shares)
        offsets = Points(places.of_edges - points, places.of_triangles - centres)
        self._remember(rest_positions, rest_normals, offsets, looks)
        # What is off around an edge; and what turns in its middle, where few finer vertices are.
        self.turns = np.hypot(saved, self._turns_at(rest_positions, looks)).astype(np.float32)
        self._surface = None

    def _find_middles(self, positions: Doubles, normals: Floats, count: int) -> None:
        """Find where the middles of the first `count` grown triangles lie, and directions there."""
        faces, listed, shares = self._connectivity.faces, self._grown, self._middle_shares
        slide_middles(positions, normals, faces, listed, count, shares)
        triangle_axes(positions, normals, faces, listed, count, shares, self._centre_axes)

    def _remember(
        self, rest_positions: Doubles, rest_normals: Floats, offsets: Points, looks: Doubles
    ) -> None:
        """Store offsets and normals along the directions of edges, triangles and vertices."""
        mesh, edge_count = self._connectivity, len(self._axes)
        edges = np.arange(edge_count, dtype=np.uint32)
        twice = np.full(edge_count, 2, dtype=np.uint8)
        edge_axes(
            rest_positions, rest_normals, mesh.edge_points, twice, edges, edge_count, self._axes
        )
        vertex_axes(rest_positions, rest_normals, self._towards, self._vertex_axes)
        point_looks = Points.unstacked(looks, mesh)
        point_axes, centre_axes = self._axes[:, AXES_OF], self._centre_axes[:, None]
        self._offsets = _along(point_axes, offsets.of_edges)
        self._looks = _along(point_axes, point_looks.of_edges)
        self._centre_offsets = _along(centre_axes, offsets.of_triangles)
        self._centre_looks = _along(centre_axes, point_looks.of_triangles)
        # A vertex without a normal has no frame: nothing to show there.
        self._vertex_looks = _along(self._vertex_axes, looks[: mesh.vertex_count])

    def _turns_at(self, rest_positions: Doubles, looks: Doubles) -> Doubles:
        """How far the middle of each edge split once turns from between its ends, shape (E,).

        Times the root of the edge's length in mean lengths: a longer edge shows more of it.
        """
        mesh = self._connectivity
        mean = looks[mesh.edges].sum(axis=1)
        mean /= np.maximum(np.linalg.norm(mean, axis=1, keepdims=True), 1e-12)
        middles = Points.unstacked(looks, mesh).of_edges[:, ALONE]
        angles = np.arccos(np.clip((mean * middles).sum(axis=1), -1.0, 1.0))
        lengths = np.linalg.norm(np.diff(rest_positions[mesh.edges], axis=1)[:, 0], axis=1)
        share: Doubles = np.sqrt(lengths / lengths.mean()) if len(lengths) else lengths
        turns: Doubles = angles * share
        return turns

    def place(self, frame: Frame) -> None:
        """Write vertices and points, then the normals of the finer mesh at points."""
        super().place(frame)
        show_points(
            self._connectivity.edge_points,
            self._connectivity.edge_wings,
            self._connectivity.is_interior,
            self._looks,
            self._axes,
            frame.splits,
            frame.growth_once,
            frame.growth_twice,
            frame.first_points,
            frame.split_once,
            frame.once_count,
            frame.rows,
        )

    def _vertex_normals(self, frame: Frame) -> Floats:
        return self._shown

    def _find_vertex_normals(self, frame: Frame) -> None:
        axes = self._vertex_axes
        vertex_axes(frame.positions, self._normals, self._towards, axes)
        show_vertices(self._normals, self._vertex_looks, axes, self._shown)

    def _bulge(self, frame: Frame, bulges: Floats) -> None:
        super()._bulge(frame, bulges)
        edge_axes(
            frame.positions,
            self._normals,
            self._connectivity.edge_points,
            frame.splits,
            frame.split_once,
            frame.once_count,
            self._axes,
        )
        add_offsets(
            self._offsets,
            self._axes,
            frame.splits,
            frame.growth_twice,
            frame.split_once,
            frame.once_count,
            bulges,
        )

    def place_centres(self, frame: Frame) -> None:
        """Move the points in the middle of triangles as far as the edges around have grown."""
        assert frame.centre_triangles is not None
        mesh = self._connectivity
        grown_count = list_grown(
            mesh.triangle_edges,
            frame.growth_once,
            frame.centre_triangles,
            frame.centre_count,
            self._grown,
        )
        self._find_middles(frame.positions, self._normals, grown_count)
        show_centres(
            mesh.faces,
            self._middle_shares,
            self._centre_offsets,
            self._centre_looks,
            self._centre_axes,
            mesh.triangle_edges,
            frame.splits,
            frame.growth_once,
            frame.growth_twice,
            frame.first_points,
            frame.centre_triangles,
            frame.centre_count,
            frame.first_centre,
            frame.rows,
        )


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


@kernel
def add_offsets(
    offsets: Floats,
    axes: Floats,
    splits: npt.NDArray[np.uint8],
    growth_twice: Floats,
    split_once: Unsigned,
    once_count: int,
    bulges: Floats,
) -> None:
    """Add the stored offsets of the split edges to their bulges."""
    for k in range(once_count):
        e = split_once[k]
        twice = growth_twice[e] if splits[e] == 2 else ZERO
        for j in range(3):
            offset = between(offsets[e, ALONE, j], offsets[e, MIDDLE, j], twice)
            for i in range(3):
                bulges[e, MIDDLE, i] += offset * axes[e, MIDDLE, j, i]
        if splits[e] < 2:
            continue
        for point in (START, END):
            for j in range(3):
                for i in range(3):
                    bulges[e, point, i] += offsets[e, point, j] * axes[e, point, j, i]


@kernel
def between(start: np.float32, end: np.float32, share: np.float32) -> np.float32:
    """A share of the way from one number to another, neither of which is lost at its end."""
    return (ONE - share) * start + share * end


@kernel
def turn(normal: Floats, look: Floats, axes: Floats, growth: np.float32) -> None:
    """Turn a unit normal, as far as `growth` says, to the one that is stored along the axes."""
    x = y = z = ZERO
    for k in range(3):
        x += look[k] * axes[k, 0]
        y += look[k] * axes[k, 1]
        z += look[k] * axes[k, 2]
    x = normal[0] + growth * (x - normal[0])
    y = normal[1] + growth * (y - normal[1])
    z = normal[2] + growth * (z - normal[2])
    scale = ONE / np.sqrt(max(x * x + y * y + z * z, TINY))
    normal[0], normal[1], normal[2] = x * scale, y * scale, z * scale


@kernel
def show_vertices(normals: Floats, looks: Floats, axes: Floats, shown: Floats) -> None:
    """Write the finer normal of every vertex, turned with its surroundings."""
    for v in range(normals.shape[0]):
        for i in range(3):
            shown[v, i] = normals[v, i]
        turn(shown[v], looks[v], axes[v], ONE)


@kernel
def show_points(
    edge_points: Unsigned,
    edge_wings: Unsigned,
    is_interior: npt.NDArray[np.bool_],
    looks: Floats,
    axes: Floats,
    splits: npt.NDArray[np.uint8],
    growth_once: Floats,
    growth_twice: Floats,
    first_points: Unsigned,
    split_once: Unsigned,
    once_count: int,
    vertices: Floats,
) -> None:
    """Turn the normals of the points of split edges to those of the finer mesh."""
    look = np.empty(3, np.float32)
    for k in range(once_count):
        e = split_once[k]
        row = first_points[e] + (splits[e] >> 1)
        share = growth_once[e]
        if is_interior[e]:
            around = ZERO
            for i in range(4):
                wing = edge_wings[e, i]
                around += QUARTER * growth_once[wing] if splits[wing] > 0 else ZERO
            share = min(share, around)
        twice = growth_twice[e] if splits[e] == 2 else ZERO
        for j in range(3):
            look[j] = between(looks[e, ALONE, j], looks[e, MIDDLE, j], twice)
        turn(vertices[row, 3:6], look, axes[e, MIDDLE], share)
        if splits[e] < 2:
            continue
        for end in range(2):
            # Between its neighbours at first, of which the middle has just been turned.
            vertex, point = edge_points[e, end], row - 1 + 2 * end
            for i in range(3, 6):
                vertices[point, i] = HALF * (vertices[vertex, i] + vertices[row, i])
            turn(
                vertices[point, 3:6],
                looks[e, 2 * end],
                axes[e, 2 * end],
                min(share, growth_twice[e]),
            )


@kernel
def show_centres(
    faces: Unsigned,
    shares: Floats,
    offsets: Floats,
    looks: Floats,
    axes: Floats,
    triangle_edges: npt.NDArray[np.int32],
    splits: npt.NDArray[np.uint8],
    growth_once: Floats,
    growth_twice: Floats,
    first_points: Unsigned,
    centre_triangles: Unsigned,
    centre_count: int,
    first_centre: int,
    vertices: Floats,
) -> None:
    """Slide, move and turn the points in the middle of triangles as the least grown edge allows.

    They are where blending has them (blend.py): in the centroid.
    """
    look = np.empty(3, np.float32)
    for k in range(centre_count):
        t, row = centre_triangles[k], first_centre + k
        once = twice = ONE
        for i in range(3):
            e = triangle_edges[t, i]
            once = min(once, growth_once[e])
            twice = min(twice, growth_twice[e] if splits[e] == 2 else ZERO)
        if once == ZERO:
            continue
        for i in range(3):
            e, a, b = triangle_edges[t, i], faces[t, i], faces[t, (i + 1) % 3]
            middle = first_points[e] + (splits[e] >> 1)
            corner = once * (shares[t, i] - THIRD)
            bulge = once * (FOUR * shares[t, i] * shares[t, (i + 1) % 3] - FOUR_NINTHS)
            for j in range(3):
                out = vertices[middle, j] - HALF * (vertices[a, j] + vertices[b, j])
                vertices[row, j] += corner * vertices[a, j] + bulge * out
        for j in range(3):
            look[j] = between(looks[t, 1, j], looks[t, 0, j], twice)
            offset = once * between(offsets[t, 1, j], offsets[t, 0, j], twice)
            for i in range(3):
                vertices[row, i] += offset * axes[t, j, i]
        turn(vertices[row, 3:6], look, axes[t], once)
