"""Intersections of lines and triangles."""

import numpy as np
from numpy.testing import assert_allclose

from risorius.geometry.directions import unit_vectors
from risorius.geometry.normals import cross_products
from risorius.geometry.rays import crossings, cutting, exits
from risorius.geometry.read_only import read_only
from tests.meshes import cube


def test_weights_and_distance_name_one_point():
    """Weights and distance give the same point on triangle and line.

    The sign of the volume gives the side, and is 0 for a line in the triangle's plane.
    """
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


def test_triangles_cut_each_other_where_an_edge_of_one_crosses_the_other():
    """A common vertex is not a cut; `crossings` finds the same edges."""
    random = np.random.default_rng(3)
    vertices = random.normal(size=(30, 3))
    faces = np.array([random.permutation(30)[:3] for _ in range(60)], dtype=np.int32)
    corners = vertices[faces]
    pairs = np.argwhere(np.triu(np.ones((60, 60)), 1))
    ends = np.roll(corners, -1, axis=1)
    expected = np.zeros(len(pairs), dtype=bool)
    for one, other in (pairs.T, pairs.T[::-1]):
        for k in range(3):
            start = corners[one, k]
            _, u, v, along = crossings(start, ends[one, k] - start, corners[other])
            expected |= (np.stack([u, v, 1.0 - u - v, along, 1.0 - along]) > 1e-6).all(axis=0)
    one, other = faces[pairs.T]
    shares_vertex = (one[:, :, None] == other[:, None, :]).any(axis=(1, 2))
    expected &= ~shares_vertex
    assert expected.sum() > 100
    pairs = np.ascontiguousarray(pairs)
    assert np.array_equal(cutting(corners, read_only(faces), pairs), expected)


def test_rays_leave_a_cube_where_its_walls_are():
    """A ray from a point inside a cube has one exit; distance and cosine are those of its wall."""
    random = np.random.default_rng(1)
    vertices = 2.0 * cube().vertices - 1.0
    faces = cube().faces
    origin = np.array([0.3, -0.2, 0.5])
    directions = random.normal(size=(300, 3))
    directions = unit_vectors(directions)
    ray, distance, cosine = exits(origin, directions, vertices, faces)
    order = np.argsort(ray)
    assert np.array_equal(ray[order], np.arange(300))
    to_walls = (np.sign(directions) - origin) / directions
    assert_allclose(distance[order], to_walls.min(axis=1), rtol=1e-9)
    walls = to_walls.argmin(axis=1)
    assert_allclose(cosine[order], np.abs(directions[np.arange(300), walls]), rtol=1e-9)


def test_only_exits_of_a_ray_are_counted():
    """A ray that enters an inner box from outside has one exit: the far side of the outer box."""
    vertices = 2.0 * cube().vertices - 1.0
    faces = cube().faces
    small = 0.2 * vertices + [0.6, 0.1, 0.2]
    both = np.vstack([vertices, small])
    numbers = np.vstack([faces, faces + len(vertices)])
    ray, distance, _ = exits(np.zeros(3), np.array([[1.0, 0.13, 0.29]]), both, numbers)
    assert np.array_equal(ray, [0, 0])
    assert_allclose(np.sort(distance), [0.8, 1.0])
