"""The search for closest points compared with brute force."""

import numpy as np
import pytest
from numpy.linalg import norm

from risorius.geometry.closest import MeshSearch, closest_points
from tests import meshes


@pytest.mark.parametrize("name", ["triangle", "octahedron", "open_grid", "with_debris"])
def test_equals_brute_force(name):
    """No point of a dense sampling of the mesh is closer, and the found point is on the mesh."""
    mesh = meshes.NAMED_MESHES[name]()
    generator = np.random.default_rng(3)
    points = generator.uniform(-2.0, 4.0, (100, 3))
    found = closest_points(points, mesh.vertices, mesh.faces)
    there = found.interpolate(mesh.vertices)
    np.testing.assert_allclose(norm(there - points, axis=1), found.distances, atol=1e-12)
    assert (found.corners == mesh.faces[found.triangles]).all()
    assert (found.weights >= -1e-12).all()
    weights = generator.dirichlet([0.5, 0.5, 0.5], 1000)
    samples = np.einsum("wi,fij->fwj", weights, mesh.vertices[mesh.faces]).reshape(-1, 3)
    sampled = norm(points[:, None] - samples[None], axis=2).min(axis=1)
    assert (found.distances <= sampled + 1e-12).all()
    assert (sampled - found.distances).max() < 0.2


def test_points_on_the_mesh():
    """A point on the mesh has distance zero, also in a large mesh of uneven triangles."""
    mesh = meshes.irregular(4, 60, 40)
    generator = np.random.default_rng(5)
    chosen = generator.integers(0, len(mesh.faces), 500)
    weights = generator.dirichlet([1.0, 1.0, 1.0], 500)
    points = np.einsum("ni,nij->nj", weights, mesh.vertices[mesh.faces[chosen]])
    found = closest_points(points, mesh.vertices, mesh.faces)
    assert found.distances.max() < 1e-12
    assert (found.triangles == chosen).mean() > 0.99


def test_finds_the_surface_with_the_same_direction():
    """Of two grids facing away from each other, the one with the point's direction is found."""
    grid = meshes.open_grid(6, 6)
    count = len(grid.vertices)
    vertices = np.concatenate([grid.vertices, grid.vertices - [0.0, 0.0, 0.01]])
    faces = np.concatenate([grid.faces, grid.faces[:, ::-1] + count])
    points = np.tile([[3.3, 2.2, -0.005]], (2, 1))
    ways = np.array([[0, 0, 1.0], [0, 0, -1.0]])
    found = closest_points(points, vertices, faces, ways, wrong_side=1.0)
    assert found.triangles[0] < len(grid.faces) <= found.triangles[1]


def test_a_mesh_is_searched_as_often_as_wanted(generator):
    """One search object, used repeatedly, gives the same results as a new one each time."""
    vertices = generator.normal(size=(40, 3))
    faces = np.arange(39).reshape(-1, 3)
    search = MeshSearch.from_mesh(vertices, faces)
    for count in (5, 1, 0, 9):
        points, normals = generator.normal(size=(2, count, 3))
        found = search.closest(points, normals, 0.5)
        wanted = closest_points(points, vertices, faces, normals, 0.5)
        for name in ("distances", "triangles", "corners", "weights"):
            assert (getattr(found, name) == getattr(wanted, name)).all()


def test_curved_triangles_are_round():
    """On a ball of 128 triangles, curved ones lie ten times nearer to the sphere than flat ones."""
    mesh = meshes.ball()
    radius = norm(mesh.vertices, axis=1).mean()
    generator = np.random.default_rng(3)
    found = closest_points(generator.normal(size=(500, 3)), mesh.vertices, mesh.faces)
    flat = found.interpolate(mesh.vertices)
    curved = found.interpolate_round(mesh.vertices, mesh.vertices / radius)
    off = [np.abs(norm(points, axis=1) / radius - 1.0).max() for points in (flat, curved)]
    assert off[1] < 0.1 * off[0]
    flat = found.interpolate_round(mesh.vertices, np.zeros_like(mesh.vertices))
    np.testing.assert_allclose(flat, found.interpolate(mesh.vertices))
