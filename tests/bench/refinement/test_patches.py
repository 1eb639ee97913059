"""PN and Phong triangles: through the corners, round on a sphere, without cracks."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from risorius.bench.refinement.patches import phong_triangles, pn_triangles
from tests import meshes

PATCHES = pytest.mark.parametrize("patches", [pn_triangles, phong_triangles])


@PATCHES
@pytest.mark.parametrize("pieces", [1, 2, 4])
def test_sphere(patches: Callable[..., Any], pieces: int) -> None:
    """On an octahedron with normals of a sphere: near the sphere, closed, corners kept."""
    mesh = meshes.octahedron()
    points, normals, triangles = patches(mesh.vertices, mesh.vertices, mesh.faces, pieces)
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


@PATCHES
def test_flat_stays_flat(patches: Callable[..., Any]) -> None:
    """A flat mesh with its true normals is only cut up."""
    mesh = meshes.open_grid(2, 2)
    up = np.tile([0.0, 0.0, 1.0], (len(mesh.vertices), 1))
    points, normals, _ = patches(mesh.vertices, up, mesh.faces, 4)
    assert np.abs(points[:, 2]).max() == 0.0
    assert (normals == [0.0, 0.0, 1.0]).all()
    assert (np.abs(4.0 * points[:, :2] - np.rint(4.0 * points[:, :2])) < 1e-12).all()


def test_phong_is_between_triangle_and_tangent_planes() -> None:
    """The middle of an edge of an octahedron: 1/2, and the mean on both tangent planes is 3/4."""
    mesh = meshes.octahedron()
    points, *_ = phong_triangles(mesh.vertices, mesh.vertices, mesh.faces, 2)
    middles = np.isclose(np.linalg.norm(points, axis=1), 0.6875 * np.sqrt(2.0))
    assert middles.sum() == 3 * len(mesh.faces)
    assert (np.isclose(np.abs(points[middles]), 0.6875).sum(axis=1) == 2).all()
