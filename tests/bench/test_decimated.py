"""Meshes of fewer triangles stay surfaces."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from risorius.assets.topology import boundary_loops, collapsed, grid_faces, is_manifold
from risorius.bench.subjects import decimated
from tests.assets import checks

TUBE_ROWS = 60


def crumpled_tube(seed):
    """A long thin tube whose walls are pressed together and crumpled: vertices and faces."""
    ring_count = 8
    turn = np.linspace(0.0, 2.0 * np.pi, ring_count, endpoint=False)
    rows = np.arange(TUBE_ROWS * ring_count).reshape(TUBE_ROWS, ring_count)
    ring = np.stack([np.cos(turn), 0.05 * np.sin(turn), np.zeros(ring_count)], axis=1)
    places = np.tile(ring, (TUBE_ROWS, 1))
    places[:, 2] = 0.3 * np.repeat(np.arange(TUBE_ROWS), ring_count)
    noise = np.random.default_rng(seed).normal(0.0, 0.02, places.shape)
    return places + noise, grid_faces(rows, closed=True)


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10**6), count=st.integers(8, 400))
def test_a_surface_of_fewer_triangles_is_a_surface(seed, count):
    """No edge has three triangles, both openings stay, and triangles never become more."""
    vertices, faces = crumpled_tube(seed)
    points, triangles = decimated(vertices, faces, count)
    assert checks.is_manifold(triangles)
    assert len(boundary_loops(triangles)) == 2
    assert triangles.max() < len(points)
    assert len(triangles) <= len(faces)


def test_a_pinched_attempt_is_followed_by_another():
    """A tube that the first attempt pinches becomes a surface with fewer triangles."""
    count = 60
    pinched = 0
    for seed in range(30):
        vertices, faces = crumpled_tube(seed)
        first = collapsed(vertices, faces, count, 0)[1]
        assert is_manifold(first) == checks.is_manifold(first)
        if not is_manifold(first):
            pinched += 1
            found = decimated(vertices, faces, count)[1]
            assert checks.is_manifold(found)
            assert len(found) < len(faces)
    assert pinched > 0


def test_a_mesh_of_few_triangles_stays_as_it_is():
    """A mesh that has no more triangles than asked for is returned as it is."""
    vertices, faces = crumpled_tube(0)
    points, triangles = decimated(vertices, faces, len(faces))
    assert np.array_equal(points, vertices)
    assert np.array_equal(triangles, faces)
