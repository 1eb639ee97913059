"""Heights over a sheet compared with a plain search of the nearest vertices."""

import numpy as np
import pytest
import scipy

from risorius.geometry.directions import unit_vectors
from risorius.geometry.sheets import NEAR, heights_over, sheet_of


def searched(x, normals, depths, points, outward):
    """The simple implementation, by a k-d tree."""
    away, near = scipy.spatial.cKDTree(x).query(points, k=NEAR)
    is_faced = np.einsum("nkc,nc->nk", normals[near], outward) > 0.0
    weight = 1e-9 + is_faced * np.exp(-(away**2) / (0.35 * away[:, -1:] ** 2))
    weight /= weight.sum(axis=1, keepdims=True)
    off = np.einsum("nkc,nkc->nk", points[:, None] - x[near], normals[near])
    normal = unit_vectors(np.einsum("nk,nkc->nc", weight, normals[near]))
    return (weight * off).sum(axis=1), normal, (weight * depths[near]).sum(axis=1)


@pytest.mark.parametrize("count", [NEAR, 9, 60, 1000])
def test_heights_are_those_of_the_nearest_vertices(count):
    """Heights over a sphere equal the plain search's: for points on, below and far from it.

    Points come in rows or in no order, over few and many vertices.
    """
    rng = np.random.default_rng(count)
    normals = unit_vectors(rng.normal(size=(count, 3)))
    x = 80.0 * normals + (5.0, -20.0, 30.0)
    depths = rng.uniform(2.0, 9.0, count)
    row = np.linspace((-90.0, 0.0, 30.0), (90.0, 10.0, 60.0), 40)
    around = rng.normal(size=(200, 3)) * 60.0
    far = rng.normal(size=(9, 3)) * 900.0
    points = np.concatenate([row, around, far])
    outward = rng.normal(size=points.shape)
    found = heights_over(sheet_of(x, normals, depths), points, outward)
    for ours, plain in zip(found, searched(x, normals, depths, points, outward), strict=True):
        assert np.abs(ours - plain).max() < 1e-6


def test_a_flat_sheet_has_exact_heights():
    """Vertices in one plane give exact heights.

    Their cells form one layer, distances are equal, and one point lies outside the grid.
    """
    across, along = np.meshgrid(np.arange(6.0), np.arange(6.0))
    x = np.stack([across.ravel(), along.ravel(), np.zeros(36)], axis=1)
    up = np.tile((0.0, 0.0, 1.0), (36, 1))
    points = np.array([(2.5, 2.5, 0.25), (2.0, 3.0, -1.0), (-40.0, 2.0, 7.0), (2.5, 2.5, 0.25)])
    height, normal, depth = heights_over(sheet_of(x, up, np.full(36, 4.0)), points, up[:4])
    assert np.allclose(height, points[:, 2])
    assert np.allclose(normal, up[:4])
    assert np.allclose(depth, 4.0)
