"""The criterion that knows a finer mesh."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

import refine
from tests import meshes

Points = npt.NDArray[np.float64]


def hill(points: Points) -> Points:
    """A flat mesh with a hill in its left half."""
    raised = points.copy()
    x, y = points[:, 0] - 2.0, points[:, 1] - 3.0
    raised[:, 2] = 0.6 * np.exp(-0.8 * (x * x + y * y))
    return raised


def coarse_and_finer() -> tuple[meshes.Mesh, tuple[Points, npt.NDArray[np.int32]]]:
    """A grid of 12 x 6 cells that is flat, and the hill that it was made from."""
    coarse, fine = meshes.open_grid(12, 6), meshes.open_grid(96, 48)
    flat = coarse.vertices.copy()
    return meshes.Mesh(flat, coarse.faces), (hill(fine.vertices / 8.0), fine.faces)


def test_splits_where_detail_is() -> None:
    """At rest already edges on the hill are split, and none in the flat half."""
    mesh, finer = coarse_and_finer()
    refiner = refine.create("kahler", mesh.faces, mesh.vertices, criterion=refine.Gap(finer))
    refined = refiner.refine(mesh.vertices)
    refine.check(refiner, refined, mesh.vertices)
    middles = mesh.vertices[refiner.edges].mean(axis=1)
    assert (refiner.splits[middles[:, 0] > 7.0] == 0).all()
    on_hill = np.linalg.norm(middles[:, :2] - [2.0, 3.0], axis=1) < 0.9
    assert (refiner.splits[on_hill] == 2).all()


def test_bending_adds() -> None:
    """Where the mesh bends further, other edges are split too; a rigid motion adds none."""
    mesh, finer = coarse_and_finer()
    refiner = refine.create("kahler", mesh.faces, mesh.vertices, criterion=refine.Gap(finer))
    refiner.refine(mesh.vertices)
    at_rest = refiner.splits.copy()
    refiner.refine(mesh.vertices @ meshes.rotation(3).T + 5.0)
    assert (refiner.splits == at_rest).all()
    bent = mesh.vertices.copy()
    bent[:, 2] += 0.8 * np.sin(1.2 * bent[:, 0])
    refiner.refine(bent)
    assert (refiner.splits >= at_rest).all()
    assert refiner.splits.sum() > at_rest.sum() + 50


def test_need_is_what_is_marked() -> None:
    """Needs above 0 and 1 are one and two splits, and the thresholds lie there."""
    mesh, finer = coarse_and_finer()
    connectivity = refine.connect(mesh.faces, len(mesh.vertices))
    plain = refine.create("none", mesh.faces, mesh.vertices)
    normals = plain.refine(mesh.vertices).normals
    criterion = refine.Gap(finer, 0.05, 0.2)
    criterion.bind(connectivity, mesh.vertices, normals)
    need = np.zeros(len(connectivity.edges), dtype=np.float32)
    splits = np.zeros(len(connectivity.edges), dtype=np.uint8)
    criterion.measure(mesh.vertices, normals, need)
    criterion.mark(mesh.vertices, normals, splits)
    assert (splits == (need > 0).astype(int) + (need > 1)).all()
    assert set(splits.tolist()) == {0, 1, 2}
    lengths = np.linalg.norm(np.diff(mesh.vertices[connectivity.edges], axis=1), axis=2)
    distance = (0.05 + 0.15 * need) * lengths.mean()
    middles = mesh.vertices[connectivity.edges].mean(axis=1)
    nearest = np.linalg.norm(finer[0][None] - middles[:, None], axis=2).min(axis=1)
    assert np.abs(distance - nearest).max() < 0.05


@pytest.mark.parametrize("scheme", ["cubic", "detail"])
def test_goes_with_blending(scheme: str) -> None:
    """It measures, so that new points may grow out of their edges."""
    mesh, finer = coarse_and_finer()
    options = {"detail": finer} if scheme == "detail" else {}
    refiner = refine.create(
        "kahler", mesh.faces, mesh.vertices, scheme=scheme, criterion=refine.Gap(finer), **options
    )
    refined = refiner.refine(mesh.vertices)
    refine.check(refiner, refined, mesh.vertices)
    assert len(refined.triangles) > len(mesh.faces)


def test_bad_finer_mesh() -> None:
    """What is no mesh is refused with its name."""
    with pytest.raises(ValueError, match=r"finer\[1\]"):
        refine.Gap((np.eye(3), np.array([[0, 1, 3]])))
    with pytest.raises(ValueError, match="distances in mean edge lengths"):
        refine.Gap((np.eye(3), np.array([[0, 1, 2]])), 0.2, 0.1)
