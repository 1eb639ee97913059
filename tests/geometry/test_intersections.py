"""The search for intersections, and for pairs of touching boxes, against simple tests."""

import numpy as np

from risorius.geometry.intersections import near_pairs, self_intersections


def test_pairs_are_those_of_a_plain_comparison():
    """For random small and large triangles, every pair of touching boxes is found exactly once."""
    random = np.random.default_rng(2)
    sizes = np.exp(random.uniform(-3.0, 1.0, (120, 1, 1)))
    corners = random.uniform(-2.0, 2.0, (120, 1, 3)) + sizes * random.normal(size=(120, 3, 3))
    low = corners.min(axis=1)
    high = corners.max(axis=1)
    touches = (low[:, None] <= high).all(axis=2) & (low <= high[:, None]).all(axis=2)
    expected = np.argwhere(np.triu(touches, 1)).tolist()
    assert 100 < len(expected) < 6000
    assert sorted(near_pairs(corners).tolist()) == expected


def test_no_triangles_have_no_pairs():
    """An empty mesh is not an error."""
    assert near_pairs(np.zeros((0, 3, 3))).shape == (0, 2)


def test_more_pairs_than_expected_are_all_found():
    """In a stack of equal triangles every two triangles touch."""
    stack = np.tile(np.eye(3), (40, 1, 1))
    expected = np.argwhere(np.triu(np.ones((40, 40)), 1)).tolist()
    assert sorted(near_pairs(stack).tolist()) == expected


def test_large_and_small_triangles_are_compared():
    """Every crossing in a random heap is found, also between large and small triangles."""
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
