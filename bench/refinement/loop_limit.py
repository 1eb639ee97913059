"""The limit surface of uniform Loop subdivision, at the vertices of one or two levels.

What OpenSubdiv and others evaluate: every vertex of a subdivided mesh is pushed to where endless
subdivision would take it, with the normal that the surface has there. A frame is four products with
sparse matrices. Masks for limit positions, and for tangents inside, are those of Loop 1987 and
Hoppe et al. 1994; Warren's weights stand in place of Loop's, as everywhere here
(refine/mesh/rings.py). Tangents at borders are left eigenvectors of these rules, for any number of
triangles (border_tangent).

A vertex where surfaces only touch, or a border turns back, stays with the normal of its triangles.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import scipy.sparse

from risorius.geometry.normals import vertex_normals
from risorius.refine.mesh.rings import BORDER_RING, warren_weight

from .sparse_loop import subdivision

Doubles = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]
Mask = dict[int, float]
"""Weights by vertex."""


class LoopLimit:
    """The limit surface of one mesh, for any positions of it."""

    def __init__(
        self,
        faces: npt.NDArray[np.integer],
        vertex_count: int,
        levels: int,
        corners: Integers | None = None,
    ) -> None:
        """Work out the matrices; `faces`: shape (F, 3); `corners`: vertices that stay."""
        held = np.zeros(0, dtype=np.int64) if corners is None else corners
        finer = spread = scipy.sparse.identity(vertex_count, format="csr")
        triangles = faces.astype(np.int64)
        for _ in range(levels):
            smooth, means, triangles = subdivision(triangles, finer.shape[0], 1)
            finer, spread = (_held(smooth, held) @ finer).tocsr(), (means @ spread).tocsr()
        rings = ordered_rings(triangles, finer.shape[0])
        masks = [vertex_masks(vertex, ring, is_closed) for vertex, (ring, is_closed) in rings]
        for vertex in held.tolist():
            masks[vertex] = vertex_masks(vertex, [], False)
        self._has_tangents = np.array([bool(along) for _, along, _ in masks])
        self.limit, self._along, self._across = (
            (_matrix([mask[k] for mask in masks]) @ finer).tocsr() for k in range(3)
        )
        """The first: limit positions from those of the input, shape (N, V)."""
        self.spread = spread
        """Points of the flat triangles from the vertices, shape (N, V)."""
        self.triangles = triangles

    def mesh(self, positions: Doubles) -> tuple[Doubles, Doubles, Integers]:
        """Points and unit normals, shape (N, 3), and triangles; `positions`: shape (V, 3)."""
        points = self.limit @ positions
        normals = np.cross(self._along @ positions, self._across @ positions)
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
        plain = vertex_normals(points, self.triangles)
        return points, np.where(self._has_tangents[:, None], normals, plain), self.triangles


def vertex_masks(vertex: int, ring: list[int], is_closed: bool) -> tuple[Mask, Mask, Mask]:
    """Masks of limit position and of two tangents, counter-clockwise; none where it is a corner."""
    count = len(ring)
    if count < 2 or (is_closed and count < 3):
        return {vertex: 1.0}, {}, {}
    turn = np.arange(count)
    if is_closed:
        share = 1.0 / (3.0 / (8.0 * float(warren_weight(np.array(count)))) + count)
        angles = 2.0 * np.pi * turn / count
        return (
            {vertex: 1.0 - count * share, **dict.fromkeys(ring, share)},
            dict(zip(ring, np.cos(angles), strict=True)),
            dict(zip(ring, np.sin(angles), strict=True)),
        )
    share = 1.0 / (2.0 + 0.5 / BORDER_RING)
    position = {vertex: 1.0 - 2.0 * share, ring[0]: share, ring[-1]: share}
    along = {ring[0]: 1.0, ring[-1]: -1.0}
    if count == 2:
        return position, along, {vertex: -2.0, ring[0]: 1.0, ring[1]: 1.0}
    own, end, inner = border_tangent(count)
    across = {vertex: own, ring[0]: end, ring[-1]: end}
    return position, along, across | dict(zip(ring[1:-1], inner, strict=True))


def border_tangent(count: int) -> tuple[float, float, Doubles]:
    """Weights of the tangent into the surface at a border vertex with `count` > 2 neighbours.

    Of the vertex, of its two neighbours on the border, of the others, shape (count - 2,). It is the
    left eigenvector that is symmetric and of one sign inside: what a level makes of it is itself,
    `shrunk` times. Inside a ring it is a sine; two equations are left for the other two weights.
    """
    step = np.pi / (count - 1)
    inner = np.sin(step * np.arange(1, count - 1))
    shrunk = 3.0 / 8.0 + np.cos(step) / 4.0
    rules = [[-1.0 / 8.0, shrunk - 1.0 / 2.0], [shrunk - 3.0 / 4.0, -1.0]]
    own, end = np.linalg.solve(rules, [inner[0] / 8.0, 3.0 / 8.0 * inner.sum()])
    return float(own), float(end), inner


def ordered_rings(faces: Integers, vertex_count: int) -> list[tuple[int, tuple[list[int], bool]]]:
    """Each vertex, its neighbours counter-clockwise, and whether they close; none if unclear."""
    following: list[dict[int, int]] = [{} for _ in range(vertex_count)]
    doubled = set()
    for triangle in faces.tolist():
        for k in range(3):
            vertex, start, end = triangle[k], triangle[k - 2], triangle[k - 1]
            if start in following[vertex]:
                doubled.add(vertex)
            following[vertex][start] = end
    return [
        (vertex, ([], False) if vertex in doubled else _walk(after))
        for vertex, after in enumerate(following)
    ]


def _walk(after: dict[int, int]) -> tuple[list[int], bool]:
    """One ring in order; empty unless it is a single one."""
    firsts = [start for start in after if start not in set(after.values())]
    if len(firsts) > 1 or not after:
        return [], False
    ring = [firsts[0] if firsts else next(iter(after))]
    while ring[-1] in after and after[ring[-1]] != ring[0]:
        ring.append(after[ring[-1]])
    is_whole = len(ring) == len(after) + len(firsts)
    return (ring, not firsts) if is_whole else ([], False)


def _held(smooth: scipy.sparse.csr_matrix, vertices: Integers) -> scipy.sparse.csr_matrix:
    """The same rules, but that these vertices stay."""
    moves = np.ones(smooth.shape[0])
    moves[vertices] = 0.0
    ones = np.ones(len(vertices)), (vertices, vertices)
    return scipy.sparse.diags(moves) @ smooth + scipy.sparse.csr_matrix(ones, shape=smooth.shape)


def _matrix(masks: list[Mask]) -> scipy.sparse.csr_matrix:
    rows = np.repeat(np.arange(len(masks)), [len(mask) for mask in masks])
    columns = np.array([vertex for mask in masks for vertex in mask], dtype=np.int64)
    values = np.array([value for mask in masks for value in mask.values()])
    return scipy.sparse.csr_matrix((values, (rows, columns)), shape=(len(masks), len(masks)))
