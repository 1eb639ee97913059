"""A mesh as a graph of vertices and edges: its connected pieces, and shortest paths along edges."""

from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import sparse
from scipy.sparse import csgraph

from .arrays import Floats64, Integers, Integers32
from .sides import edges_of, side_lengths


def edge_graph(edges: Integers, lengths: Floats64, vertex_count: int) -> sparse.csr_array:
    """The graph of edges (E, 2), each given once, with their lengths above 0, (E,)."""
    return sparse.csr_array((lengths, edges.T), shape=(vertex_count, vertex_count))


def length_graph(vertices: Floats64, faces: Integers) -> sparse.csr_array:
    """The graph of the edges of triangles (F, 3), with the distances of vertices (V, 3)."""
    edges = edges_of(faces)
    lengths = side_lengths(vertices, edges)
    return edge_graph(edges, np.maximum(lengths, 1e-9), len(vertices))


def path_lengths(vertices: Floats64, faces: Integers, starts: npt.ArrayLike) -> Floats64:
    """Lengths of shortest paths along edges from each start to all vertices, shape (n, V).

    vertices: shape (V, 3). starts: vertex indices, shape (n,). Without a path: infinity.
    """
    graph = length_graph(vertices, faces)
    return np.asarray(csgraph.dijkstra(graph, directed=False, indices=starts))


def path_to(end: int, before: npt.NDArray[np.integer[Any]]) -> list[int]:
    """The vertices of a path from its start to `end`; it is [end] if no path leads there.

    before: the vertex before each vertex on a path from the start, below 0 for none, shape (V,), as
    `csgraph.dijkstra` returns predecessors.
    """
    path = [int(end)]
    while before[path[-1]] >= 0:
        path.append(int(before[path[-1]]))
    return path[::-1]


def pieces_of(links: Integers, count: int) -> Integers32:
    """The index of the connected piece that each of `count` things belongs to, shape (count,).

    links: pairs of connected things, or triangles, whose corners are connected, (n, 2) or (n, 3).
    """
    pairs = np.concatenate([links[:, [k, k + 1]] for k in range(links.shape[1] - 1)])
    graph = sparse.coo_array((np.ones(len(pairs)), pairs.T), shape=(count, count))
    return np.asarray(csgraph.connected_components(graph, directed=False)[1], np.int32)
