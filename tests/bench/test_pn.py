"""PN triangles: through the corners, round on a sphere, without cracks."""

from __future__ import annotations

import numpy as np
import pytest

from risorius.bench.pn import tessellate
from tests import meshes


@pytest.mark.parametrize("pieces", [1, 2, 4])
def test_sphere(pieces: int) -> None:
    """On an octahedron with normals of a sphere: near the sphere, closed, corners kept."""
    mesh = meshes.octahedron()
    points, normals, triangles = tessellate(mesh.vertices, mesh.vertices, mesh.faces, pieces)
    assert len(triangles) == pieces**2 * len(mesh.faces)
    radius = np.linalg.norm(points, axis=1)
    assert np.abs(radius - 1.0).max() < (0.0 if pieces == 1 else 0.2) + 1e-12
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0)
    assert np.einsum("ni,ni->n", normals, points / radius[:, None]).min() > 0.99
    assert all((np.abs(points - vertex).sum(axis=1) < 1e-12).any() for vertex in mesh.vertices)
    places = np.unique(np.round(points, 9), axis=0)
    assert len(places) == 4 * pieces**2 + 2  # Euler: closed, so no point comes in two versions
    corners = points[triangles]
    outward = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (np.einsum("ni,ni->n", outward, corners.mean(axis=1)) > 0.0).all()


def test_flat_stays_flat() -> None:
    """A flat mesh with its true normals is only cut up."""
    mesh = meshes.open_grid(2, 2)
    up = np.tile([0.0, 0.0, 1.0], (len(mesh.vertices), 1))
    points, normals, _ = tessellate(mesh.vertices, up, mesh.faces, 4)
    assert np.abs(points[:, 2]).max() == 0.0
    assert (normals == [0.0, 0.0, 1.0]).all()
    assert (np.abs(4.0 * points[:, :2] - np.rint(4.0 * points[:, :2])) < 1e-12).all()
