"""Numbers of things among some of them."""

import numpy as np

from risorius.geometry.numbering import places_among


def test_places_among_some_things():
    """Faces between chosen vertices get their places in the choice; other vertices get -1."""
    places = places_among(np.array([4, 0, 3]), 5)
    assert places.tolist() == [1, -1, -1, 2, 0]
    assert places[[[0, 3, 4]]].tolist() == [[1, 2, 0]]
