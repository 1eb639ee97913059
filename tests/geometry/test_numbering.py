"""Numbers of things among some of them."""

import numpy as np

from risorius.geometry.numbering import numbered_by_first_use, places_among


def test_places_among_some_things():
    """Faces between chosen vertices get their places in the choice; other vertices get -1."""
    places = places_among(np.array([4, 0, 3]), 5)
    assert places.tolist() == [1, -1, -1, 2, 0]
    assert places[[[0, 3, 4]]].tolist() == [[1, 2, 0]]


def test_equal_things_have_one_index():
    """Numbers and rows are numbered in the order of their first use, also if there are none."""
    first, index = numbered_by_first_use(np.array([7, 3, 7, 9, 3]))
    assert first.tolist() == [0, 1, 3]
    assert index.tolist() == [0, 1, 0, 2, 1]
    first, index = numbered_by_first_use(np.array([[2.0, 0.0], [1.0, 5.0], [2.0, 0.0]]))
    assert first.tolist() == [0, 1]
    assert index.tolist() == [0, 1, 0]
    first, index = numbered_by_first_use(np.zeros(0, np.int64))
    assert len(first) == len(index) == 0
