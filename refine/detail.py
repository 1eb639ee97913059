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
from .local_frames import edge_axes, list_grown, slide_middles, triangle_axes, vertex_axes
from .masks import write_normal
from .native import Call, native
from .normals import unit
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
        self._axes = np.zeros((9 * edge_count, 3), dtype=np.float32)
        self._centre_axes = np.zeros((3 * len(connectivity.faces), 3), dtype=np.float32)
        self._middle_shares = np.zeros((len(connectivity.faces), 3), dtype=np.float32)
        self._vertex_axes = np.zeros((3 * len(rest_normals), 3), dtype=np.float32)
        self._shown = np.zeros_like(rest_normals)
        self._count = np.array([len(connectivity.faces)], dtype=np.int64)
        self._towards = np.arange(connectivity.vertex_count, dtype=np.uint32)
        # The longest edge of a vertex, written last: no matter of the order of edges.
        both_ways = np.concatenate([connectivity.edges, connectivity.edges[:, ::-1]])
        along = rest_positions[both_ways[:, 1]] - rest_positions[both_ways[:, 0]]
        squared = along[:, 0] ** 2 + along[:, 1] ** 2 + along[:, 2] ** 2
        start, end = both_ways[np.argsort(squared, kind="stable")].T
        self._towards[start] = end
        everything = self._every_edge(rest_positions, rest_normals)
        for call in super()._bind_bulging(everything):
            call()
        # All directions follow the normals that the cubic has, now as in every frame.
        rest_normals = self._normals.copy()
        self._grown = np.arange(len(connectivity.faces), dtype=np.uint32)
        for call in self._bind_middles(rest_positions, rest_normals):
            call()
        points, ups = _points_on(self._bulges, connectivity, rest_positions, rest_normals)
        shares = self._middle_shares.astype(np.float64)
        middles = shares, self._centre_axes[::3].astype(np.float64)
        places, looks, saved = fit(
            self._surface, connectivity, rest_positions, rest_normals, (points, ups), middles
        )
        centres = middles_of(places.of_edges, connectivity, rest_positions, shares)
        offsets = Points(places.of_edges - points, places.of_triangles - centres)
        self._remember(rest_positions, rest_normals, offsets, looks)
        # What is off around an edge; and what turns in its middle, where few finer vertices are.
        self.turns = np.hypot(saved, self._turns_at(rest_positions, looks)).astype(np.float32)
        self._surface = None

    def _bind_middles(self, positions: Doubles, normals: Floats) -> list[Call]:
        """Return the calls that find the middles of grown triangles, and directions there."""
        faces, listed, shares = self._connectivity.faces, self._grown, self._middle_shares
        axes = self._centre_axes
        return [
            slide_middles.bind(positions, normals, faces, listed, self._count, shares),
            triangle_axes.bind(positions, normals, faces, listed, self._count, shares, axes),
        ]

    def _remember(
        self, rest_positions: Doubles, rest_normals: Floats, offsets: Points, looks: Doubles
    ) -> None:
        """Store offsets and normals along the directions of edges, triangles and vertices."""
        mesh, edge_count = self._connectivity, len(self._connectivity.edges)
        edge_axes(
            rest_positions,
            rest_normals,
            mesh.edge_points,
            np.full(edge_count, 2, dtype=np.uint8),
            np.arange(edge_count, dtype=np.uint32),
            np.array([0, edge_count], dtype=np.int64),
            self._axes,
        )
        vertex_axes(rest_positions, rest_normals, self._towards, self._vertex_axes)
        point_looks = Points.unstacked(looks, mesh)
        point_axes = self._axes.reshape(-1, 3, 3, 3)[:, AXES_OF]
        centre_axes = self._centre_axes.reshape(-1, 1, 3, 3)
        self._offsets = _along(point_axes, offsets.of_edges)
        self._looks = _along(point_axes, point_looks.of_edges)
        self._centre_offsets = _along(centre_axes, offsets.of_triangles)
        self._centre_looks = _along(centre_axes, point_looks.of_triangles)
        # A vertex without a normal has no frame: nothing to show there.
        vertex_axes_at_rest = self._vertex_axes.reshape(-1, 3, 3)
        self._vertex_looks = _along(vertex_axes_at_rest, looks[: mesh.vertex_count])

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
        """Write vertices and points, with the normals of the finer mesh."""
        frame.bound(self.placing)()

    def placing(self, frame: Frame) -> list[Call]:
        """Return the calls that place points in the arrays of a frame; `vertices` are its rows."""
        mesh = self._connectivity
        return [
            *self._bind_bulging(frame),
            vertex_axes.bind(frame.positions, self._normals, self._towards, self._vertex_axes),
            show_vertices.bind(self._normals, self._vertex_looks, self._vertex_axes, self._shown),
            *self._bind_pointing(frame),
            show_points.bind(
                mesh.edge_points,
                mesh.edge_wings,
                mesh.is_interior,
                self._looks,
                self._axes,
                frame.splits,
                frame.growth_once,
                frame.growth_twice,
                frame.first_points,
                frame.split_once,
                frame.counts,
                frame.rows,
            ),
        ]

    def raising(self, frame: Frame) -> list[Call]:
        """Return the calls that move points in the middle of triangles, when others are there."""
        assert frame.centre_triangles is not None
        mesh = self._connectivity
        return [
            list_grown.bind(
                mesh.triangle_edges,
                frame.growth_once,
                frame.centre_triangles,
                frame.counts,
                self._grown,
                self._count,
            ),
            *self._bind_middles(frame.positions, self._normals),
            show_centres.bind(
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
                frame.counts,
                frame.rows,
            ),
        ]

    def _vertex_normals(self, frame: Frame) -> Floats:
        return self._shown

    def _bind_bulging(self, frame: Frame) -> list[Call]:
        axes, counts = self._axes, frame.counts
        points, splits, split_once = self._connectivity.edge_points, frame.splits, frame.split_once
        twice = frame.growth_twice
        return [
            *super()._bind_bulging(frame),
            edge_axes.bind(
                frame.positions, self._normals, points, splits, split_once, counts, axes
            ),
            add_offsets.bind(
                self._offsets, axes, splits, twice, split_once, counts, self._bulge_rows
            ),
        ]


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


@native
def add_offsets(
    offsets: Floats,
    axes: Floats,
    splits: npt.NDArray[np.uint8],
    growth_twice: Floats,
    split_once: Unsigned,
    counts: npt.NDArray[np.int64],
    bulges: Floats,
) -> None:
    """Add the stored offsets of the split edges to their bulges.

    `axes`: nine rows for each edge, `bulges`: three; `counts`: see schemes.Frame.
    """
    for k in range(counts[1]):
        e = split_once[k]
        first, bulge = np.uint64(9) * np.uint64(e), np.uint64(3) * np.uint64(e)
        middle = bulge + np.uint64(MIDDLE)
        twice = growth_twice[e] if splits[e] == 2 else ZERO
        for j in range(3):
            offset = between(offsets[e, ALONE, j], offsets[e, MIDDLE, j], twice)
            axis = first + np.uint64(3 * MIDDLE + j)
            for i in range(3):
                bulges[middle, i] += offset * axes[axis, i]
        if splits[e] < 2:
            continue
        for end in range(2):
            point = START + (END - START) * end
            for j in range(3):
                axis, quarter = first + np.uint64(3 * point + j), bulge + np.uint64(point)
                for i in range(3):
                    bulges[quarter, i] += offsets[e, point, j] * axes[axis, i]


@native
def between(start: np.float32, end: np.float32, share: np.float32) -> np.float32:
    """A share of the way from one number to another, neither of which is lost at its end."""
    return (ONE - share) * start + share * end


@native
def turned(
    x: np.float32,
    y: np.float32,
    z: np.float32,
    u: np.float32,
    v: np.float32,
    w: np.float32,
    axes: Floats,
    k: np.uint64,
    growth: np.float32,
) -> tuple[np.float32, np.float32, np.float32]:
    """Turn a unit normal (x y z) as far as `growth` says to (u v w), stored along rows k, .. k + 2.

    The result has length one.
    """
    second, third = k + np.uint64(1), k + np.uint64(2)
    along_x = u * axes[k, 0] + v * axes[second, 0] + w * axes[third, 0]
    along_y = u * axes[k, 1] + v * axes[second, 1] + w * axes[third, 1]
    along_z = u * axes[k, 2] + v * axes[second, 2] + w * axes[third, 2]
    return unit(x + growth * (along_x - x), y + growth * (along_y - y), z + growth * (along_z - z))


@native
def show_vertices(normals: Floats, looks: Floats, axes: Floats, shown: Floats) -> None:
    """Write the finer normal of every vertex, turned with its surroundings."""
    for v in range(normals.shape[0]):
        x, y, z = normals[v, 0], normals[v, 1], normals[v, 2]
        first = np.uint64(3 * v)
        x, y, z = turned(x, y, z, looks[v, 0], looks[v, 1], looks[v, 2], axes, first, ONE)
        shown[v, 0], shown[v, 1], shown[v, 2] = x, y, z


@native
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
    counts: npt.NDArray[np.int64],
    vertices: Floats,
) -> None:
    """Turn the normals of the points of split edges to those of the finer mesh.

    `axes`: nine rows for each edge; `counts`: see schemes.Frame.
    """
    for k in range(counts[1]):
        e = split_once[k]
        row, first = np.uint32(first_points[e] + (splits[e] >> 1)), np.uint64(9) * np.uint64(e)
        share = growth_once[e]
        if is_interior[e]:
            around = ZERO
            for i in range(4):
                wing = edge_wings[e, i]
                around += QUARTER * growth_once[wing] if splits[wing] > 0 else ZERO
            share = min(share, around)
        twice = growth_twice[e] if splits[e] == 2 else ZERO
        x, y, z = turned(
            vertices[row, 3],
            vertices[row, 4],
            vertices[row, 5],
            between(looks[e, ALONE, 0], looks[e, MIDDLE, 0], twice),
            between(looks[e, ALONE, 1], looks[e, MIDDLE, 1], twice),
            between(looks[e, ALONE, 2], looks[e, MIDDLE, 2], twice),
            axes,
            first + np.uint64(3 * MIDDLE),
            share,
        )
        write_normal(vertices, row, x, y, z)
        if splits[e] < 2:
            continue
        for end in range(2):
            # Between its neighbours at first, of which the middle has just been turned.
            a, point = edge_points[e, end], START + (END - START) * end
            quarter = np.uint32(row - 1 + 2 * end)
            u, v, w = turned(
                HALF * (vertices[a, 3] + x),
                HALF * (vertices[a, 4] + y),
                HALF * (vertices[a, 5] + z),
                looks[e, point, 0],
                looks[e, point, 1],
                looks[e, point, 2],
                axes,
                first + np.uint64(3 * point),
                min(share, growth_twice[e]),
            )
            write_normal(vertices, quarter, u, v, w)


@native
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
    counts: npt.NDArray[np.int64],
    vertices: Floats,
) -> None:
    """Slide, move and turn the points in the middle of triangles as the least grown edge allows.

    They are where blending has them (blend.py): in the centroid. `axes`: three rows for each
    triangle; `counts`: see schemes.Frame.
    """
    for k in range(counts[4]):
        t, row = centre_triangles[k], np.uint32(counts[0] + k)
        once = twice = ONE
        for i in range(3):
            e = triangle_edges[t, i]
            once = min(once, growth_once[e])
            twice = min(twice, growth_twice[e] if splits[e] == 2 else ZERO)
        if once == ZERO:
            continue
        first = np.uint64(3) * np.uint64(t)
        for i in range(3):
            e, a, b = triangle_edges[t, i], faces[t, i], faces[t, (i + 1) % 3]
            middle = first_points[e] + (splits[e] >> 1)
            corner = once * (shares[t, i] - THIRD)
            bulge = once * (FOUR * shares[t, i] * shares[t, (i + 1) % 3] - FOUR_NINTHS)
            for j in range(3):
                out = vertices[middle, j] - HALF * (vertices[a, j] + vertices[b, j])
                vertices[row, j] += corner * vertices[a, j] + bulge * out
        for j in range(3):
            offset = once * between(offsets[t, 1, j], offsets[t, 0, j], twice)
            for i in range(3):
                vertices[row, i] += offset * axes[first + np.uint64(j), i]
        x, y, z = turned(
            vertices[row, 3],
            vertices[row, 4],
            vertices[row, 5],
            between(looks[t, 1, 0], looks[t, 0, 0], twice),
            between(looks[t, 1, 1], looks[t, 0, 1], twice),
            between(looks[t, 1, 2], looks[t, 0, 2], twice),
            axes,
            first,
            once,
        )
        write_normal(vertices, row, x, y, z)
