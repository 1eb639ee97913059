"""Sides of triangles as pairs of vertices."""

import numpy as np

from risorius.geometry.sides import (
    border_edges,
    border_sides,
    different_pairs,
    edges_of,
    numbered_edges,
    side_lengths,
    sides_of,
)


def test_different_pairs_are_those_of_unique_rows():
    """The order and numbers are those of `np.unique` over rows, also for no pairs."""
    for count in (0, 1, 500):
        pairs = np.random.default_rng(count).integers(0, 20, (count, 2)).astype(np.int32)
        rows, numbers = np.unique(pairs, axis=0, return_inverse=True)
        found, found_numbers = different_pairs(pairs)
        assert np.array_equal(found, rows)
        assert np.array_equal(found_numbers, numbers.ravel())


def test_side_lengths_are_distances_of_their_ends():
    """A right triangle has sides of 3, 4 and 5."""
    vertices = np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 0.0, 4.0]])
    lengths = side_lengths(vertices, sides_of(np.array([[0, 1, 2]])))
    assert lengths.tolist() == [3.0, 5.0, 4.0]


def test_edges_of_two_triangles():
    """Their common edge counts once, has both sides, and is no border."""
    faces = np.array([[0, 1, 2], [3, 2, 1]])
    edges, number_of_side = numbered_edges(faces)
    assert edges.tolist() == [[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]]
    # Sides: 0-1 and 3-2, then 1-2 and 2-1, then 2-0 and 1-3.
    assert number_of_side.tolist() == [0, 4, 2, 2, 1, 3]
    assert edges_of(faces).tolist() == edges.tolist()
    assert border_edges(faces).tolist() == [[0, 1], [0, 2], [1, 3], [2, 3]]
    assert border_edges(faces[:0]).shape == (0, 2)
    assert border_sides(faces).tolist() == [[0, 1], [3, 2], [2, 0], [1, 3]]
