"""Tests of shortest paths along edges, and of connected pieces."""

import numpy as np
import scipy

from risorius.geometry.mesh_graph import length_graph, path_lengths, path_to, pieces_of

# Two squares of two triangles beside each other, and a triangle that nothing joins. The middle
# edge of the left square is a side of two triangles that run along it in the same direction.
VERTICES = np.array(
    [
        [0, 0, 0],
        [1, 0, 0],
        [2, 0, 0],
        [0, 1, 0],
        [1, 1, 0],
        [2, 1, 0],
        [9, 0, 0],
        [9, 1, 0],
        [9, 9, 0],
    ],
    np.float64,
)
FACES = np.array([[0, 1, 4], [4, 0, 3], [1, 2, 5], [1, 5, 4], [6, 7, 8]], np.int32)


def test_paths_go_along_edges():
    """An edge of two triangles has its own length, whichever way the triangles run along it."""
    lengths = path_lengths(VERTICES, FACES, [0, 6])
    assert np.allclose(lengths[0, :6], [0.0, 1.0, 2.0, 1.0, 2**0.5, 1.0 + 2**0.5])
    assert np.isinf(lengths[0, 6:]).all() and np.isinf(lengths[1, :6]).all()


def test_a_path_has_its_start_and_end():
    """A path is read back from its end; a vertex without a path is alone."""
    graph = length_graph(VERTICES, FACES)
    before = scipy.sparse.csgraph.dijkstra(
        graph, directed=False, indices=0, return_predecessors=True
    )[1]
    assert path_to(2, before) == [0, 1, 2]
    assert path_to(0, before) == [0]
    assert path_to(7, before) == [7]


def test_pieces_are_joined_by_corners_or_links():
    """Triangles and pairs join the points that they name; any other point is a separate piece."""
    assert pieces_of(FACES, 10).tolist() == [0] * 6 + [1] * 3 + [2]
    assert pieces_of(np.array([[2, 0], [3, 1]]), 5).tolist() == [0, 1, 0, 1, 2]
    assert pieces_of(np.zeros((0, 2), np.int64), 2).tolist() == [0, 1]
