"""The tension map: known strains, rigid motion, and a second implementation."""

import numpy as np
import numpy.typing as npt
import pytest

from risorius.refine import Tension
from tests import meshes

Array = npt.NDArray[np.float64]


def plain_twin(faces: npt.NDArray[np.int32], rest: Array, now: Array) -> tuple[Array, ...]:
    """Stretch and compression once more: vertex by vertex, by numpy's eigenvalues."""
    stretch, compression = np.zeros(len(rest)), np.zeros(len(rest))
    edges = [[x[faces[:, k]] - x[faces[:, 0]] for k in (1, 2)] for x in (rest, now)]
    normals = np.cross(*edges[0])
    for v in range(len(rest)):
        around = np.flatnonzero((faces == v).any(axis=1))
        normal = normals[around].sum(axis=0)
        if not normal.any():
            continue
        normal /= np.linalg.norm(normal)
        lateral = np.cross(normal, [1.0, 0.0, 0.0] if abs(normal[0]) < 0.6 else [0.0, 1.0, 0.0])
        lateral /= np.linalg.norm(lateral)
        plane = np.stack([lateral, np.cross(normal, lateral)])
        angles = np.pi / 3.0 * np.arange(3)
        gauges = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        squares, total = np.zeros(3), 0.0
        for t in around:
            before, after = (np.stack([u[t], w[t]], axis=1) for u, w in edges)
            along = np.linalg.pinv(before) @ plane.T @ gauges.T
            area = np.linalg.norm(normals[t])
            squares += area * ((after @ along) ** 2).sum(0) / ((before @ along) ** 2).sum(0)
            total += area
        terms = np.stack([gauges[:, 0] ** 2, 2.0 * gauges.prod(axis=1), gauges[:, 1] ** 2], axis=1)
        xx, xy, yy = np.linalg.solve(terms, squares / total)
        values = np.linalg.eigvalsh([[xx, xy], [xy, yy]])
        stretch[v] = max(np.sqrt(values[1]) - 1.0, 0.0)
        compression[v] = max(1.0 - np.sqrt(max(values[0], 0.0)), 0.0)
    return stretch, compression


@pytest.mark.parametrize("seed", range(5))
def test_equals_twin(seed: int) -> None:
    """The kernel and the plain twin agree on irregular meshes in random deformations."""
    mesh = meshes.irregular(seed)
    now = meshes.wrinkled(mesh, seed + 10)
    measured = Tension(mesh.faces, mesh.vertices).measure(now)
    stretch, compression = plain_twin(mesh.faces, mesh.vertices, now)
    np.testing.assert_allclose(measured.stretch, stretch, atol=2e-5)
    np.testing.assert_allclose(measured.compression, compression, atol=2e-5)


@pytest.mark.parametrize("name", meshes.NAMED)
def test_named_meshes(name: str) -> None:
    """Debris, borders and fins: all is finite and within limits."""
    mesh = meshes.NAMED[name]()
    measured = Tension(mesh.faces, mesh.vertices).measure(meshes.wrinkled(mesh, 3))
    assert all(np.isfinite(values).all() for values in measured)
    assert (measured.stretch >= 0.0).all()
    assert ((measured.compression >= 0.0) & (measured.compression <= 1.0)).all()


def test_stretched_sheet() -> None:
    """A flat grid pulled along x and squeezed along y, then turned anywhere in space."""
    mesh = meshes.open_grid(6, 5)
    turn = meshes.rotation(4)
    now = (mesh.vertices * [1.5, 0.8, 1.0]) @ turn.T + 7.0
    measured = Tension(mesh.faces, mesh.vertices).measure(now)
    np.testing.assert_allclose(measured.stretch, 0.5, atol=1e-5)
    np.testing.assert_allclose(measured.compression, 0.2, atol=1e-5)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e4])
def test_rigid_motion(scale: float) -> None:
    """Moved rigidly, at any scale, there is no tension."""
    mesh = meshes.irregular(2)
    rest = scale * mesh.vertices
    measured = Tension(mesh.faces, rest).measure(rest @ meshes.rotation(5).T + scale)
    assert measured.stretch.max() < 1e-5
    assert measured.compression.max() < 1e-5


def test_flipped_triangles() -> None:
    """Triangles that look the other way than the skin around them are as tense as they would be."""
    mesh = meshes.open_grid(6, 5)
    faces = mesh.faces.copy()
    faces[::7] = faces[::7, ::-1]
    stretched = mesh.vertices * [1.5, 0.8, 1.0]
    measured = Tension(faces, mesh.vertices).measure(stretched)
    used = measured.stretch > 0.0
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
