"""Pictures of meshes beside pictures of the truth."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

from risorius.bench.refinement.pictures import SIZE, Mesh, PictureError, Pictures, shaded
from risorius.bench.subjects import PosePair, Subject
from tests import meshes

Points = npt.NDArray[np.float64]


def tilted(points: Points, degrees: float) -> Points:
    """Turned about the upright axis."""
    angle = np.radians(degrees)
    turn = np.array(
        [
            [np.cos(angle), 0.0, np.sin(angle)],
            [0.0, 1.0, 0.0],
            [-np.sin(angle), 0.0, np.cos(angle)],
        ]
    )
    return np.asarray(points @ turn.T)


@pytest.fixture(scope="module")
def square() -> tuple[Points, npt.NDArray[np.int32]]:
    """A flat square of 2 x 2, seen from the front."""
    mesh = meshes.open_grid(2, 2)
    points = mesh.vertices - mesh.vertices.mean(axis=0)
    return points * 2.0 / np.ptp(points[:, 0]), mesh.faces


def errors_of(
    square: tuple[Points, npt.NDArray[np.int32]], truth: Points, mesh: Mesh
) -> PictureError:
    """Errors of a mesh where the dense one is `truth`."""
    points, faces = square
    subject = Subject(
        "square",
        "square",
        faces,
        faces,
        PosePair(points, points),
        {"pose": PosePair(truth, points)},
    )
    with Pictures(subject, views=("front",)) as pictures:
        return pictures.error("pose", mesh)


def test_the_truth_has_no_error(square: tuple[Points, npt.NDArray[np.int32]]) -> None:
    """It is what the others are compared with."""
    points, faces = square
    found = errors_of(square, points, shaded(points, faces))
    assert (found.rms, found.outline) == (0.0, 0.0)


def test_outline(square: tuple[Points, npt.NDArray[np.int32]]) -> None:
    """A square that is a tenth narrower misses a tenth of its pixels, and shading stays."""
    points, faces = square
    narrow = points * [0.9, 1.0, 1.0]
    found = errors_of(square, points, shaded(narrow, faces))
    whole = errors_of(square, points, shaded(0.0 * points, faces)).outline
    assert SIZE**2 * 0.5 < whole < SIZE**2
    assert found.outline == pytest.approx(0.1 * whole, rel=0.02)


def test_normals_alone_are_seen(square: tuple[Points, npt.NDArray[np.int32]]) -> None:
    """The same triangles with other normals differ in grey, not in outline."""
    points, faces = square
    normals = shaded(tilted(points, 40.0), faces)[1]
    found = errors_of(square, points, (points, normals, faces))
    assert found.outline == 0.0
    assert found.rms > 5.0
