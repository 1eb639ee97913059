"""The tension map: known strains, rigid motion, and a second implementation."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from scipy.spatial.transform import Rotation

from risorius.refine import Tension
from tests import meshes

Array = npt.NDArray[np.float64]


def plain_twin(faces: npt.NDArray[np.int32], rest: Array, now: Array) -> tuple[Array, ...]:
    """Stretch, compression and direction once more: vertex by vertex, by numpy's eigenvectors."""
    stretch, compression = np.zeros(len(rest)), np.zeros(len(rest))
    direction = np.zeros((len(rest), 3))
    edges = [[x[faces[:, k]] - x[faces[:, 0]] for k in (1, 2)] for x in (rest, now)]
    (rest_normals, normals) = (np.cross(u, v) for u, v in edges)
    for v in range(len(rest)):
        around = np.flatnonzero((faces == v).any(axis=1))
        normal = normals[around].sum(axis=0)
        tensor, total = np.zeros((3, 3)), 0.0
        for t in around:
            before, after = (np.stack([u[t], w[t]], axis=1) for u, w in edges)
            turn, _ = Rotation.align_vectors(normal[None], normals[t][None])
            gradient = turn.as_matrix() @ after @ np.linalg.pinv(before)
            area = 0.5 * np.linalg.norm(rest_normals[t])
            tensor += area * gradient @ gradient.T
            total += area
        if total == 0.0:
            continue
        plane = np.linalg.svd(normal[None])[2][1:]
        values, vectors = np.linalg.eigh(plane @ (tensor / total) @ plane.T)
        stretch[v] = max(np.sqrt(values[1]) - 1.0, 0.0)
        compression[v] = max(1.0 - np.sqrt(values[0]), 0.0)
        direction[v] = vectors[:, 1] @ plane
    return stretch, compression, direction


@pytest.mark.parametrize("seed", range(5))
def test_equals_twin(seed: int) -> None:
    """The kernel and the plain twin agree on irregular meshes in random deformations."""
    mesh = meshes.irregular(seed)
    now = meshes.wrinkled(mesh, seed + 10)
    measured = Tension(mesh.faces, mesh.vertices).measure(now)
    stretch, compression, direction = plain_twin(mesh.faces, mesh.vertices, now)
    np.testing.assert_allclose(measured.stretch, stretch, atol=2e-5)
    np.testing.assert_allclose(measured.compression, compression, atol=2e-5)
    is_clear = (stretch + compression) > 0.02
    cosine = np.abs(np.sum(measured.direction * direction, axis=1))
    assert (cosine[is_clear] > 0.999).all()


@pytest.mark.parametrize("name", meshes.NAMED)
def test_named_meshes(name: str) -> None:
    """Debris, borders and fins: all is finite and within limits, directions have length 1 or 0."""
    mesh = meshes.NAMED[name]()
    measured = Tension(mesh.faces, mesh.vertices).measure(meshes.wrinkled(mesh, 3))
    assert all(np.isfinite(values).all() for values in measured)
    assert (measured.stretch >= 0.0).all()
    assert ((measured.compression >= 0.0) & (measured.compression <= 1.0)).all()
    length = np.linalg.norm(measured.direction, axis=1)
    assert (np.isclose(length, 1.0, atol=1e-5) | (length == 0.0)).all()


def test_stretched_sheet() -> None:
    """A flat grid pulled along x and squeezed along y, then turned anywhere in space."""
    mesh = meshes.open_grid(6, 5)
    turn = meshes.rotation(4)
    now = (mesh.vertices * [1.5, 0.8, 1.0]) @ turn.T + 7.0
    measured = Tension(mesh.faces, mesh.vertices).measure(now)
    np.testing.assert_allclose(measured.stretch, 0.5, atol=1e-5)
    np.testing.assert_allclose(measured.compression, 0.2, atol=1e-5)
    np.testing.assert_allclose(np.abs(measured.direction @ turn[:, 0]), 1.0, atol=1e-5)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e4])
def test_rigid_motion(scale: float) -> None:
    """Moved rigidly, at any scale, there is no tension and no direction."""
    mesh = meshes.irregular(2)
    rest = scale * mesh.vertices
    measured = Tension(mesh.faces, rest).measure(rest @ meshes.rotation(5).T + scale)
    assert measured.stretch.max() < 1e-5
    assert measured.compression.max() < 1e-5
    assert not measured.direction.any()


def test_flipped_triangles() -> None:
    """Triangles that look the other way than the skin around them are as tense as they would be."""
    mesh = meshes.open_grid(6, 5)
    faces = mesh.faces.copy()
    faces[::7] = faces[::7, ::-1]
    stretched = mesh.vertices * [1.5, 0.8, 1.0]
    measured = Tension(faces, mesh.vertices).measure(stretched)
    used = np.linalg.norm(measured.direction, axis=1) > 0.0
    assert used.mean() > 0.9  # a vertex between as much of both has no normal
    np.testing.assert_allclose(measured.stretch[used], 0.5, atol=1e-5)
    np.testing.assert_allclose(measured.compression[used], 0.2, atol=1e-5)


@pytest.mark.parametrize(
    ("faces", "rest", "text"),
    [
        ([[0, 1, 2]], [[0.0, 0.0]], r"rest_positions must be numbers of shape \(V, 3\)"),
        ([[0, 1, 2]], np.full((3, 3), np.nan), "rest_positions must be finite"),
        ([[0, 1, 3]], np.eye(3), r"indices from 0 to 2 .* triangle 0 is \[0, 1, 3\]"),
        ([[0.0, 1.0, 2.0]], np.eye(3), "faces must be integers"),
    ],
)
def test_bad_meshes(faces: npt.ArrayLike, rest: npt.ArrayLike, text: str) -> None:
    """What cannot be measured against is refused with its shape."""
    with pytest.raises(ValueError, match=text):
        Tension(faces, rest)


def test_bad_positions() -> None:
    """A frame of another mesh is refused, and one that is not finite, without harm to the next."""
    mesh = meshes.octahedron()
    tension, broken = Tension(mesh.faces, mesh.vertices), mesh.vertices.copy()
    broken[4, 1] = np.nan
    with pytest.raises(ValueError, match=r"positions must be finite .* but vertex 4 is"):
        tension.measure(broken)
    assert not tension.measure(mesh.vertices).stretch.any()
    with pytest.raises(ValueError, match=r"positions must be floats of shape \(6, 3\)"):
        Tension(mesh.faces, mesh.vertices).measure(np.zeros((5, 3)))
