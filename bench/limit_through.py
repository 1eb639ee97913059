"""Limit surfaces of Loop subdivision that pass through the vertices of the coarse mesh.

*Through*: control points are solved for, such that the limit positions of all vertices are the
vertices; the matrix is factorised once. Where edges are uneven the solution swings.

*Mended*: nothing is solved, and a point is moved along the normal only. Over the flat triangles its
height is that of the limit surface plus what the corners miss, in the mean of the corners:

    offset    limit - flat point + mean over the corners of (vertex - its limit)
    height    offset . n          n the mean of the corners' normals

With even triangles that is exact for all quadratic heights over a tangent plane. With uneven ones
it is not; so the weights of each point are changed, as little as possible, such that it is exact at
rest: a constant and a slope give no height, the three squares give theirs. GIVE says how far.
Weights stay as sparse as the limit's. Borders move by the same rule.

Corners of borders stay, as everywhere here (refine/mesh/borders.py).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import scipy.sparse
import scipy.sparse.linalg

from risorius import refine
from risorius.refine.beyond.curves import CurveScheme
from risorius.refine.mesh.arrays import Floats
from risorius.refine.mesh.borders import border_neighbours

from .loop_limit import Doubles, Integers, LoopLimit
from .sparse_loop import subdivision
from .subjects import vertex_normals

GIVE = 0.3
"""Squared miss of a slope or a square, in lengths of the edge, that counts as much as squared
changes of weights. Chosen on two faces: with less, thin triangles get large weights."""
EXACT = 1e-9
"""The same for a constant."""


class LimitThrough:
    """The limit surface through the vertices of one mesh, for any positions of it."""

    def __init__(self, faces: npt.NDArray[np.integer], rest: Doubles, levels: int) -> None:
        """Factorise; `faces`: shape (F, 3); `rest`: shape (V, 3), where borders have corners."""
        corners = border_corners(faces, rest)
        at_vertices = LoopLimit(faces, len(rest), 0, corners).limit
        self._control_points = scipy.sparse.linalg.splu(at_vertices.tocsc()).solve
        self._surface = LoopLimit(faces, len(rest), levels, corners)

    def mesh(self, positions: Doubles) -> tuple[Doubles, Doubles, Integers]:
        """Points, normals of the limit surface, triangles; `positions`: shape (V, 3)."""
        return self._surface.mesh(self._control_points(positions))

    def mesh_with_normals(self, positions: Doubles) -> tuple[Doubles, Doubles, Integers]:
        """The same points with the normals of their triangles."""
        points, _, triangles = self.mesh(positions)
        return points, vertex_normals(points, triangles), triangles


class MendedLimit:
    """The mended limit surface of one mesh, at all vertices of some levels."""

    def __init__(self, faces: npt.NDArray[np.integer], rest: Doubles, levels: int) -> None:
        """Work out the weights; `faces`: shape (F, 3); `rest`: shape (V, 3)."""
        corners = border_corners(faces, rest)
        surface = LoopLimit(faces, len(rest), levels, corners)
        missed = scipy.sparse.identity(len(rest)) - LoopLimit(faces, len(rest), 0, corners).limit
        self._faces, self.triangles = faces, surface.triangles
        self.spread = surface.spread
        offsets = (surface.limit + self.spread @ missed - self.spread).tocsr()
        self.offsets = mend(offsets, self.spread, rest, vertex_normals(rest, faces))
        """Weights of the vertices in the offset of each point, shape (N, V)."""

    def mesh(self, positions: Doubles) -> tuple[Doubles, Doubles, Integers]:
        """Points, normals of their triangles, triangles; `positions`: shape (V, 3)."""
        normals = vertex_normals(positions, self._faces)
        points = self.spread @ positions + heights(self.offsets, self.spread, positions, normals)
        return points, vertex_normals(points, self.triangles), self.triangles


class MendedLimitScheme(CurveScheme):
    """The same as a scheme of the refiner: at the points of split edges only."""

    def bind(self, connectivity: refine.Connectivity, rest: Doubles, rest_normals: Floats) -> None:
        """Work out the weights of the three points of every edge."""
        super().bind(connectivity, rest, rest_normals)
        whole = MendedLimit(connectivity.faces, rest.astype(np.float64), 2)
        rows = edge_points(connectivity).ravel()
        self._offsets, self._spread = whole.offsets[rows], whole.spread[rows]

    def prepare(self, frame: refine.FrameBuffers) -> None:
        """Find the heights of the three points of every edge."""
        self._normals[:] = frame.normals
        found = heights(
            self._offsets, self._spread, frame.positions, frame.normals.astype(np.float64)
        )
        self._bulges[:] = found.reshape(self._bulges.shape)


def heights(
    offsets: scipy.sparse.csr_matrix,
    spread: scipy.sparse.csr_matrix,
    positions: Doubles,
    normals: Doubles,
) -> Doubles:
    """Offsets along the mean of the normals at the corners, shape (N, 3)."""
    along = spread @ normals
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-300)
    return np.asarray(np.einsum("ni,ni->n", offsets @ positions, along)[:, None] * along)


def mend(
    offsets: scipy.sparse.csr_matrix,
    spread: scipy.sparse.csr_matrix,
    rest: Doubles,
    normals: Doubles,
) -> scipy.sparse.csr_matrix:
    """Change weights, shape (N, V), such that they find the heights of quadratics at rest."""
    offsets.data[np.abs(offsets.data) < 1e-12] = 0.0
    offsets.eliminate_zeros()
    flat, up = spread @ rest, spread @ normals
    up /= np.maximum(np.linalg.norm(up, axis=1, keepdims=True), 1e-300)
    give = np.diag([EXACT] + 5 * [GIVE])
    mended = offsets.copy()
    for row in range(len(rest), offsets.shape[0]):
        own = slice(offsets.indptr[row], offsets.indptr[row + 1])
        near = slice(spread.indptr[row], spread.indptr[row + 1])
        weights, shares = offsets.data[own], spread.data[near]
        corners = rest[spread.indices[near]] - flat[row]
        size = 2.0 * np.sqrt(shares @ np.einsum("ci,ci->c", corners, corners))
        if len(weights) < 6 or size == 0.0:
            continue
        axes = np.linalg.svd(up[row : row + 1])[2][1:] / size
        terms = _quadratics((rest[offsets.indices[own]] - flat[row]) @ axes.T)
        # A height over the flat point: its own, which is that of the constant, less the corners'.
        wanted = np.eye(6)[0] - _quadratics(corners @ axes.T) @ shares
        miss = wanted - terms @ weights
        mended.data[own] += terms.T @ np.linalg.solve(terms @ terms.T + give, miss)
    return mended


def _quadratics(places: Doubles) -> Doubles:
    """1, u, v and the three squares at places (u, v), shape (n, 2); shape (6, n)."""
    u, v = places.T
    return np.stack([np.ones_like(u), u, v, u * u, u * v, v * v])


def border_corners(faces: npt.NDArray[np.integer], rest: Doubles) -> Integers:
    """The vertices at which a border has a corner at rest, or does not run on."""
    mesh = refine.connect(faces, len(rest))
    on_border = np.unique(mesh.edges[~mesh.around.is_interior])
    runs_on = border_neighbours(mesh, rest)[on_border, 0] != on_border
    return np.asarray(on_border[~runs_on], dtype=np.int64)


def edge_points(mesh: refine.Connectivity) -> Integers:
    """Near start, middle and near end of every edge, as vertices of two levels, shape (E, 3)."""
    edges = mesh.edges.astype(np.int64)
    middles = mesh.vertex_count + np.arange(len(edges))
    count = mesh.vertex_count + len(edges)
    halved = subdivision(mesh.faces.astype(np.int64), mesh.vertex_count, 1)[2]
    halves = refine.connect(halved, count).edges.astype(np.int64)
    codes = halves.min(axis=1) * count + halves.max(axis=1)
    order = np.argsort(codes)
    wanted = edges * count + middles[:, None]
    quarters = count + order[np.searchsorted(codes[order], wanted)]
    return np.stack([quarters[:, 0], middles, quarters[:, 1]], axis=1)
