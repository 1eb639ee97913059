"""The paper's refiner against its plain twin and against the checker."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from risorius import refine
from tests import meshes
from tests.refine.cases import Forced, as_lists, assert_equals_twin, kahler, soups
from tests.refine.plain_twin import edge_name
from tests.refine.plain_twin import refine as refine_plainly


def refine_and_check(
    mesh: meshes.Mesh, deformed: np.ndarray, **options: object
) -> tuple[refine.Refiner, refine.RefinedMesh]:
    """Refine one frame, run the checker, and see that nothing that was passed has changed."""
    inputs = [mesh.faces, mesh.vertices, deformed]
    before = [array.tobytes() for array in inputs]
    refiner = kahler(mesh, **options)
    refined = refiner.refine(deformed)
    refine.check(refiner, refined, deformed)
    assert [array.tobytes() for array in inputs] == before
    return refiner, refined


def assert_is_twin(
    mesh: meshes.Mesh,
    deformed: np.ndarray,
    refiner: refine.Refiner,
    refined: refine.RefinedMesh,
    *,
    normals_cancel: bool = False,
) -> None:
    """Compare with the plain twin for the splits that were found."""
    ends = [edge_name(int(a), int(b)) for a, b in refiner.edges]
    splits = dict(zip(ends, refiner.splits.tolist(), strict=True))
    twin = refine_plainly(*as_lists(deformed, mesh.faces), splits)
    assert_equals_twin(refiner, refined, twin, normals_cancel=normals_cancel)


@pytest.mark.parametrize("name", meshes.NAMED)
@pytest.mark.parametrize("amplitude", [0.2, 0.8])
def test_named_meshes(name, amplitude):
    """Every named mesh, deformed: proper, and the twin's."""
    mesh = meshes.NAMED[name]()
    for seed in range(6):
        deformed = meshes.wrinkled(mesh, seed, amplitude)
        refiner, refined = refine_and_check(mesh, deformed, threshold_once=0.01)
        assert_is_twin(mesh, deformed, refiner, refined)


@settings(max_examples=200, deadline=None)
@given(soup=soups(), data=st.data())
def test_soups(soup, data):
    """Any triangles with any splits: proper, and the twin's; whatever meets at an edge agrees."""
    positions, faces = soup
    mesh = meshes.Mesh(positions, faces)
    edge_count = len(refine.connect(faces, len(positions)).edges)
    splits = data.draw(st.lists(st.integers(0, 2), min_size=edge_count, max_size=edge_count))
    refiner, refined = refine_and_check(mesh, positions, criterion=Forced(splits))
    assert_is_twin(mesh, positions, refiner, refined, normals_cancel=True)


def test_capacity_is_reached():
    """With every edge split twice the output fills its capacities: ten for each triangle."""
    mesh = meshes.octahedron()
    refiner, refined = refine_and_check(mesh, mesh.vertices, criterion=Forced(np.full(12, 2)))
    assert len(refined.triangles) == refiner.triangle_capacity == 80
    assert len(refined.positions) == refiner.vertex_capacity == 6 + 36


def test_mirror_image():
    """A mirrored mesh in a mirrored deformation has mirrored points and normals."""
    mesh = meshes.irregular(8)
    deformed = meshes.wrinkled(mesh, 9)
    flip = np.array([-1.0, 1.0, 1.0])
    mirrored = meshes.Mesh(mesh.vertices * flip, mesh.faces[:, ::-1].copy())
    one, fine = refine_and_check(mesh, deformed)
    other, fine_mirrored = refine_and_check(mirrored, deformed * flip)
    number = {edge_name(int(a), int(b)): e for e, (a, b) in enumerate(other.edges)}
    twin_of = np.array([number[edge_name(int(a), int(b))] for a, b in one.edges])
    assert (one.splits == other.splits[twin_of]).all()
    assert one.splits.any()
    assert len(fine.triangles) == len(fine_mirrored.triangles)
    rows = [np.concatenate([m.positions, m.normals], axis=1) for m in (fine, fine_mirrored)]
    rows[1] *= np.concatenate([flip, flip])
    ordered = [np.array(sorted(np.round(r, 4).tolist())) for r in rows]
    np.testing.assert_allclose(ordered[0], ordered[1], rtol=0, atol=2e-4)


def test_order_of_triangles_does_not_matter():
    """Another order of triangles and corners gives the same subtriangles."""
    mesh = meshes.irregular(4)
    deformed = meshes.wrinkled(mesh, 5)
    generator = np.random.default_rng(6)
    shuffled = np.roll(mesh.faces[generator.permutation(len(mesh.faces))], 1, axis=1)
    corner_sets = []
    for faces in (mesh.faces, shuffled):
        _, refined = refine_and_check(meshes.Mesh(mesh.vertices, faces), deformed)
        centres = refined.positions[refined.triangles].mean(axis=1)
        corner_sets.append(np.array(sorted(np.round(centres, 4).tolist())))
    np.testing.assert_allclose(corner_sets[0], corner_sets[1], rtol=0, atol=2e-4)


def test_frames_are_independent():
    """A frame does not depend on the frames before it (section 3: no history)."""
    mesh = meshes.irregular(5)
    frames = [meshes.wrinkled(mesh, seed) for seed in range(4)]
    reused = kahler(mesh)
    for deformed in [*frames, mesh.vertices, frames[0]]:
        fresh = kahler(mesh)
        for ours, theirs in zip(
            reused.refine(deformed)[:4], fresh.refine(deformed)[:4], strict=True
        ):
            assert ours.tobytes() == theirs.tobytes()
