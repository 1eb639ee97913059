"""The search for nearest points against brute force."""

from __future__ import annotations

import numpy as np
import pytest

from risorius.bench.nearest import nearest_points
from tests import meshes


@pytest.mark.parametrize("name", ["triangle", "octahedron", "open_grid", "with_debris"])
def test_equals_brute_force(name: str) -> None:
    """No point of a dense sampling of the mesh is nearer, and the point found is on the mesh."""
    mesh = meshes.NAMED[name]()
    generator = np.random.default_rng(3)
    points = generator.uniform(-2.0, 4.0, (100, 3))
    found = nearest_points(points, mesh.vertices, mesh.faces)
    corners = mesh.vertices[mesh.faces]
    there = np.einsum("ni,nij->nj", found.weights, corners[found.triangle])
    np.testing.assert_allclose(np.linalg.norm(there - points, axis=1), found.distance, atol=1e-12)
    assert (found.weights >= -1e-12).all()
    weights = generator.dirichlet([0.5, 0.5, 0.5], 1000)
    samples = np.einsum("wi,fij->fwj", weights, corners).reshape(-1, 3)
    sampled = np.linalg.norm(points[:, None] - samples[None], axis=2).min(axis=1)
    assert (found.distance <= sampled + 1e-12).all()
    assert (sampled - found.distance).max() < 0.2


def test_points_on_the_mesh() -> None:
    """Points of the mesh are at distance zero, also in a large mesh of uneven triangles."""
    mesh = meshes.irregular(4, 60, 40)
    generator = np.random.default_rng(5)
    chosen = generator.integers(0, len(mesh.faces), 500)
    weights = generator.dirichlet([1.0, 1.0, 1.0], 500)
    points = np.einsum("ni,nij->nj", weights, mesh.vertices[mesh.faces[chosen]])
    found = nearest_points(points, mesh.vertices, mesh.faces)
    assert found.distance.max() < 1e-12
    assert (found.triangle == chosen).mean() > 0.99
