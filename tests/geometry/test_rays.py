"""Where lines meet triangles."""

import numpy as np
from numpy.testing import assert_allclose

from risorius.geometry.normals import cross_products
from risorius.geometry.rays import crossings


def test_weights_and_distance_name_one_point() -> None:
    """On the triangle as on the line; the volume tells from which side, 0 for from its edge."""
    random = np.random.default_rng(0)
    origins, directions = random.normal(size=(2, 200, 3))
    corners = random.normal(size=(200, 3, 3))
    directions[:50] = corners[:50, 1] - corners[:50, 2]
    volume, u, v, along = crossings(origins, directions, corners)
    assert np.abs(volume[:50]).max() < 1e-12 < np.abs(volume[50:]).min()
    assert not np.any([u[:50], v[:50], along[:50]])
    normals = cross_products(corners[50:].reshape(-1, 3), np.arange(450).reshape(-1, 3))
    assert_allclose(volume[50:], -(normals * directions[50:]).sum(axis=1), atol=1e-12)  # outside
    on_triangle = np.einsum("kn,nkj->nj", [1.0 - u - v, u, v], corners)[50:]
    assert_allclose(on_triangle, (origins + along[:, None] * directions)[50:], atol=1e-6)
