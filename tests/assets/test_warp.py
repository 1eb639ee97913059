"""The warp of a head is an interpolant that keeps similarities."""

import numpy as np
import pytest
from pytest import approx
from scipy.interpolate import RBFInterpolator

from risorius.assets.fitting.warp import Similarity, ThinPlateSpline, landmark_warp


def test_the_warp_is_the_interpolant_of_scipy(generator):
    """The warp equals scipy's interpolant, exactly through points and with a tolerance.

    It is evaluated at many points, and at none.
    """
    source = generator.normal(0.0, 50.0, (60, 3))
    target = source + generator.normal(0.0, 4.0, (60, 3))
    places = generator.normal(0.0, 60.0, (300, 3))
    for give in (0.0, 0.2, np.linspace(0.0, 2.0, 60)):
        wanted = RBFInterpolator(source, target, smoothing=give, kernel="linear", degree=1)
        warp = ThinPlateSpline(source, target, give)
        assert warp.points(places) == approx(wanted(places), abs=1e-9)
        assert warp.points(np.zeros((0, 3))).shape == (0, 3)


def test_no_warp_starts_from_a_plane(generator):
    """Landmarks in one plane are refused, because they leave the other direction undetermined."""
    source = generator.normal(0.0, 50.0, (60, 3)) * [1.0, 1.0, 0.0]
    with pytest.raises(np.linalg.LinAlgError, match="plane"):
        ThinPlateSpline(source, source)


def test_warp_meets_its_points_and_keeps_similarities(generator):
    """The warp maps landmarks exactly to their targets, and continues a similarity everywhere."""
    source = generator.normal(size=(20, 3))
    target = source + 0.2 * generator.normal(size=(20, 3))
    assert np.abs(ThinPlateSpline(source, target).points(source) - target).max() < 1e-9
    turn, _ = np.linalg.qr(generator.normal(size=(3, 3)))
    moved = Similarity(2.0, turn, np.array([1.0, 2.0, 3.0]))
    far = 5.0 * generator.normal(size=(50, 3))
    assert (
        np.abs(ThinPlateSpline(source, moved.points(source)).points(far) - moved.points(far)).max()
        < 1e-7
    )
    again = Similarity.between(source, moved.points(source))
    assert np.abs(again.points(far) - moved.points(far)).max() < 1e-9
    assert again.is_mirrored == (np.linalg.det(turn) < 0.0)


def test_low_brows_keep_their_height(head):
    """Brows 8 mm lower keep their height, but for the tails; they were 0.7 times as high."""
    source = head.vertices[head.landmarks]
    target = source.copy()
    target[17:27, 1] -= 8.0
    heights = []
    for warp in (landmark_warp(source, target), ThinPlateSpline(source, target)):
        high, low = (warp.points(source[[19, 24]] + [0.0, y, 0.0])[:, 1] for y in (3.0, -3.0))
        heights.append((high - low) / 6.0)
    assert (heights[0] > 0.95).all()
    assert (heights[1] < 0.75).all()
