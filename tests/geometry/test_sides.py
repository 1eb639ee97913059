"""Sides of triangles as pairs of vertices."""

import numpy as np

from risorius.geometry.sides import different_pairs, side_lengths, sides_of


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
