"""The limit surface of Loop subdivision, evaluated at vertices."""

from __future__ import annotations

import numpy as np
import pytest

from risorius.bench.refinement.loop_limit import LoopLimit, ordered_rings, vertex_masks
from tests import meshes


def test_finer_levels_lie_on_the_same_surface() -> None:
    """A vertex has one limit, from whichever level it is taken; normals agree, too."""
    mesh = meshes.octahedron()
    coarse, normals, _ = LoopLimit(mesh.faces, len(mesh.vertices), 1).mesh(mesh.vertices)
    fine, fine_normals, triangles = LoopLimit(mesh.faces, len(mesh.vertices), 3).mesh(mesh.vertices)
    assert len(triangles) == 64 * len(mesh.faces)
    np.testing.assert_allclose(fine[: len(coarse)], coarse, atol=1e-6)
    np.testing.assert_allclose(fine_normals[: len(coarse)], normals, atol=1e-6)
    assert np.einsum("ni,ni->n", fine, fine_normals).min() > 0.0  # they point outward


def test_normals_are_those_of_the_surface() -> None:
    """Beside the triangles of a deep level, inside and along the border of a bent sheet."""
    mesh = meshes.open_grid(3, 3)
    bent = mesh.vertices.astype(np.float64)
    bent[:, 2] = 0.3 * np.sin(bent[:, 0]) * np.cos(1.3 * bent[:, 1])
    points, normals, triangles = LoopLimit(mesh.faces, len(bent), 4).mesh(bent)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    flat = np.cross(b - a, c - a)
    flat /= np.linalg.norm(flat, axis=1, keepdims=True)
    cosine = np.einsum("ti,tki->tk", flat, normals[triangles])
    assert np.degrees(np.arccos(cosine.min())) < 5.0


@pytest.mark.parametrize("count", [2, 3, 4, 5, 7])
def test_masks_are_of_points_and_of_directions(count: int) -> None:
    """Weights of a position add up to 1, those of tangents to 0, inside and on a border."""
    for is_closed in (True, False) if count > 2 else (False,):
        position, along, across = vertex_masks(0, list(range(1, count + 1)), is_closed)
        assert sum(position.values()) == pytest.approx(1.0)
        assert sum(along.values()) == pytest.approx(0.0, abs=1e-12)
        assert sum(across.values()) == pytest.approx(0.0, abs=1e-12)


def test_rings() -> None:
    """Closed and open rings go round counter-clockwise; where two surfaces touch there is none."""
    fan = meshes.fan()
    rings = dict(ordered_rings(fan.faces.astype(np.int64), len(fan.vertices)))
    centre = next(vertex for vertex, (_, is_closed) in rings.items() if is_closed)
    ring, _ = rings[centre]
    assert len(ring) == 6
    turns = np.cross(fan.vertices[ring] - fan.vertices[centre], fan.vertices[np.roll(ring, -1)])
    assert (turns[:, 2] > 0.0).all()
    bow = np.array([[0, 1, 2], [0, 3, 4]])
    assert dict(ordered_rings(bow, 5))[0] == ([], False)


@pytest.mark.parametrize("count", [3, 4, 5, 6])
def test_tangents_survive_a_level(count: int) -> None:
    """At a border vertex of any number of triangles, a finer level has the same tangent plane."""
    turn = np.pi * np.linspace(0.0, 1.0, count) ** 1.3
    rim = np.stack([np.cos(turn), np.sin(turn), 0.3 * np.cos(3.0 * turn)], axis=1)
    points = np.concatenate([[[0.1, -0.3, 0.2]], rim])
    faces = np.array([[0, k, k + 1] for k in range(1, count)])
    coarse, fine = (LoopLimit(faces, len(points), levels).mesh(points)[1][0] for levels in (0, 3))
    np.testing.assert_allclose(fine, coarse, atol=1e-9)
