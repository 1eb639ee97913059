"""Points along polylines."""

import numpy as np

from risorius.geometry.polylines import arc_lengths, evenly_spaced, polyline_at

CORNER = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 4.0]])


def test_points_of_a_corner():
    """A parameter gives a point; several give a row each; those beyond an end give the end."""
    along = arc_lengths(CORNER)
    assert along.tolist() == [0.0, 3.0, 7.0]
    assert polyline_at(5.0, along, CORNER).tolist() == [3.0, 2.0]
    assert polyline_at([1.5, 9.0], along, CORNER).tolist() == [[1.5, 0.0], [3.0, 4.0]]
    assert evenly_spaced(CORNER, along, 3).tolist() == [[0.0, 0.0], [3.0, 0.5], [3.0, 4.0]]
