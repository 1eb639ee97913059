"""How far a refined surface goes in a frame."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

from risorius import refine
from risorius.bench.refinement.flicker import PLACES, at_places, largest_jump
from tests import meshes

VIEW = refine.View((0.0, 0.0, 10.0))
Points = npt.NDArray[np.float64]


def shifted(points: Points, by: float) -> Points:
    """Moved to the right."""
    return points + np.array([by, 0.0, 0.0])


class Switching(refine.Criterion):
    """A criterion that splits every edge twice in every other frame."""

    def __init__(self) -> None:
        self.is_on = False

    def mark(self, positions: object, normals: object, splits: npt.NDArray[np.uint8]) -> None:
        """Write 2 or 0 for every edge."""
        splits[:] = 2 * self.is_on
        self.is_on = not self.is_on


@pytest.mark.parametrize("name", ["none", "loop", "kahler"])
def test_places_of_a_flat_mesh(name: str) -> None:
    """Wherever rows lie, the same places are found: on a flat mesh where they are at rest."""
    mesh = meshes.open_grid(3, 2)
    options = {"criterion": Switching()} if name == "kahler" else {}
    refiner = refine.create(name, mesh.faces, mesh.vertices, **options)
    for _ in range(2):
        points = at_places(refiner, mesh.faces, refiner.refine(mesh.vertices))
        inside = slice(None) if name == "none" else ~_at_border(mesh.vertices[mesh.faces])
        wanted = np.einsum("pk,fki->fpi", PLACES, mesh.vertices[mesh.faces])
        np.testing.assert_allclose(points[inside], wanted[inside], atol=1e-5)


def _at_border(corners: Points) -> npt.NDArray[np.bool_]:
    """Triangles at the border of a grid, where rounding corners moves points within the plane."""
    low, high = corners.min(axis=(0, 1))[:2], corners.max(axis=(0, 1))[:2]
    at_border = (corners[..., :2] == low) | (corners[..., :2] == high)
    return np.asarray(at_border.any(axis=(1, 2)))


def test_a_rigid_motion_does_not_jump() -> None:
    """The surface goes as far as its input."""
    mesh = meshes.octahedron()
    refiner = refine.create("loop", mesh.faces, mesh.vertices)
    frames = [shifted(mesh.vertices, 0.1 * k) for k in range(5)]
    jump = largest_jump(refiner, mesh.faces, frames, VIEW)
    assert jump == pytest.approx(1.0, abs=1e-5)


def test_a_pop_is_found() -> None:
    """Vertices of an octahedron that are drawn inward and let go jump farther than the input."""
    mesh = meshes.octahedron()
    refiner = refine.create("kahler", mesh.faces, mesh.vertices, criterion=Switching())
    frames = [shifted(mesh.vertices, 0.01 * k) for k in range(5)]
    jump = largest_jump(refiner, mesh.faces, frames, VIEW)
    split = refine.create("loop", mesh.faces, mesh.vertices)
    inward = 1.0 - np.linalg.norm(split.refine(mesh.vertices).positions[: len(mesh.vertices)][0])
    assert jump == pytest.approx(inward / 0.01, rel=0.1)


def test_slow_frames_count() -> None:
    """A pop while the input all but stands still is measured by a tenth of its fastest motion."""
    mesh = meshes.octahedron()
    refiner = refine.create("kahler", mesh.faces, mesh.vertices, criterion=Switching())
    still = [mesh.vertices, mesh.vertices, shifted(mesh.vertices, 1.0)]
    alone = largest_jump(refiner, mesh.faces, still, VIEW)
    assert 1.0 < alone < 10.0
