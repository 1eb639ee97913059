"""The search for intersections, compared with a simple test of all pairs."""

import numpy as np

from risorius.assets.intersections import self_intersections


def test_large_and_small_triangles_are_compared():
    """Every crossing in a seeded heap is found, although candidates are found by size classes."""
    random = np.random.default_rng(5)
    sizes = np.exp(random.uniform(-2.0, 2.5, 50))
    points = random.uniform(-3.0, 3.0, (50, 1, 3)) + sizes[:, None, None] * random.normal(
        size=(50, 3, 3)
    )
    vertices = points.reshape(-1, 3)
    faces = np.arange(150, dtype=np.int32).reshape(-1, 3)
    found = {tuple(sorted(pair)) for pair in self_intersections(vertices, faces).tolist()}
    expected = {
        (i, j)
        for i in range(50)
        for j in range(i + 1, 50)
        if len(self_intersections(points[[i, j]].reshape(-1, 3), faces[:2]))
    }
    assert len(expected) > 30
    assert found == expected
