"""The edges of a triangle mesh, and all else that depends only on its triangles.

All persons have the triangles of the built-in head, so these data are computed once: edges, the
nonzero pattern of matrices, and an elimination order of the vertices with little fill-in.

Source: George, Liu 1989, "The evolution of the minimum degree ordering algorithm".
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from scipy import sparse
from scipy.sparse import linalg as sparse_linalg

from ..geometry.arrays import Floats64, Integers32, Integers64
from ..geometry.read_only import read_only
from ..geometry.sides import numbered_edges


@dataclass(frozen=True, eq=False)
class SkinGraph:
    """The edges of a mesh of V vertices; made by `graph_of`."""

    edges: Integers32  # (E, 2), sorted, the lower vertex first
    edge_of_side: Integers64  # (3 F,) of each side of `sides_of`
    order: Integers64  # (V,) of the vertices, for elimination
    neighbours: sparse.csr_array  # (V, V) number of the edge between two vertices
    ordered: sparse.csr_array  # the same in that order, and E + i on the diagonal at vertex i

    @cached_property
    def border(self) -> Integers32:
        """The vertices at edges of one triangle only, shape (n,), rising."""
        triangle_counts = np.bincount(self.edge_of_side, minlength=len(self.edges))
        return np.unique(self.edges[triangle_counts == 1])

    def matrix(self, values: Floats64) -> sparse.csr_array:
        """Values of edges (E,) as a symmetric matrix (V, V)."""
        known = self.neighbours
        parts = values[known.data], known.indices, known.indptr
        return sparse.csr_array(parts, shape=known.shape)

    def solver(self, stiffness: Floats64, diagonal: Floats64) -> Callable[[Floats64], Floats64]:
        """Return a function that solves (diagonal + L) x = right for x.

        L is the Laplacian whose edge weights are `stiffness`, shape (E,), 0 and above. diagonal: of
        vertices, shape (V,), above 0. right, x: shape (V,) or (V, k).
        """
        known = self.ordered
        degrees = np.bincount(self.edges.ravel(), np.repeat(stiffness, 2), len(diagonal))
        values = np.concatenate([-stiffness, degrees + diagonal])
        # Symmetric, so that rows may stand for columns.
        parts = values[known.data], known.indices, known.indptr
        factors = sparse_linalg.splu(
            sparse.csc_array(parts, shape=known.shape),
            permc_spec="NATURAL",
            diag_pivot_thresh=0.0,
            relax=20,  # with few columns at once, as below, this takes 60 % of the usual time
            panel_size=1,
            options={"SymmetricMode": True},
        )

        def solve(right: Floats64) -> Floats64:
            found = np.empty_like(right)
            found[self.order] = factors.solve(right[self.order])
            return found

        return solve


def graph_of(faces: Integers32, vertex_count: int) -> SkinGraph:
    """Return the graph of triangles (F, 3); graphs of the last few meshes are cached."""
    return _graph_of(faces.tobytes(), vertex_count)


@lru_cache(maxsize=4)
def _graph_of(faces: bytes, vertex_count: int) -> SkinGraph:
    """Find the edges, and an order of vertices; faces: bytes of triangles (F, 3), int32."""
    triangles = np.frombuffer(faces, np.int32).reshape(-1, 3)
    pairs, edge_of_side = numbered_edges(triangles)
    edges: Integers32 = pairs.astype(np.int32)
    neighbours = _edge_number_matrix(edges, np.zeros(0, np.int32), vertex_count)
    # Any matrix of this pattern gives the order, because the values do not matter.
    parts = np.ones(neighbours.nnz), neighbours.indices, neighbours.indptr
    pattern = sparse.csc_array(parts, shape=neighbours.shape)
    degrees = np.diff(neighbours.indptr)
    factors = sparse_linalg.splu(
        (sparse.diags_array(degrees + 1.0) - pattern).tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    place = factors.perm_c  # of each vertex in the order
    order = np.argsort(place).astype(np.int64)
    ordered = _edge_number_matrix(place[edges], place, vertex_count)
    return SkinGraph(read_only(edges), read_only(edge_of_side), order, neighbours, ordered)


def _edge_number_matrix(
    edges: Integers32, diagonal: Integers32, vertex_count: int
) -> sparse.csr_array:
    """A symmetric matrix with the index of each edge, and E + i on the diagonal for vertex i."""
    i, j = edges.T
    entries = np.concatenate([i, j, diagonal]), np.concatenate([j, i, diagonal])
    numbers = np.arange(len(edges) + len(diagonal))
    values = np.concatenate([numbers[: len(edges)], numbers])
    shape = (vertex_count, vertex_count)
    matrix = sparse.coo_array((values, entries), shape=shape).tocsr()
    matrix.sort_indices()
    return matrix
