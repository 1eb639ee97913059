"""Distances between all points of two sets."""

import numpy as np
import pytest

from risorius.geometry.distances import distances_between


@pytest.mark.parametrize("counts", [(7, 5), (1, 1), (0, 3), (4, 0)])
def test_distances_are_those_of_numpy(generator, counts):
    """The distances equal those of numpy, for any memory order and for empty arrays."""
    points, others = (np.asfortranarray(generator.normal(size=(n, 3))) for n in counts)
    wanted = np.linalg.norm(points[:, None] - others, axis=2)
    assert distances_between(points, others) == pytest.approx(wanted, rel=1e-14)
