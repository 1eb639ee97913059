"""The paper's refiner compared with its simple twin and with the checker."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from risorius import refine
from tests import meshes
from tests.refine.cases import Forced, as_lists, assert_equals_twin, kahler, sound_frame, soups
from tests.refine.plain_twin import edge_name
from tests.refine.plain_twin import refine as refine_plainly


def refine_and_check(mesh, deformed, **options):
    """Refine one frame, run the checker, and check that inputs have not changed."""
    inputs = [mesh.faces, mesh.vertices, deformed]
    before = [array.tobytes() for array in inputs]
    refiner = kahler(mesh, **options)
    refined = sound_frame(refiner, deformed)
    assert [array.tobytes() for array in inputs] == before
    return refiner, refined


def assert_is_twin(mesh, deformed, refiner, refined, *, normals_cancel=False):
    """Check that a frame equals the simple twin's for these splits."""
    ends = [edge_name(a, b) for a, b in refiner.edges]
    splits = dict(zip(ends, refiner.splits.tolist(), strict=True))
    twin = refine_plainly(*as_lists(deformed, mesh.faces), splits)
    assert_equals_twin(refiner, refined, twin, normals_cancel=normals_cancel)


@pytest.mark.parametrize("name", meshes.NAMED_MESHES)
@pytest.mark.parametrize("amplitude", [0.2, 0.8])
def test_named_meshes(name, amplitude):
    """Every test mesh, deformed, passes the checker and equals the twin's result."""
    mesh = meshes.NAMED_MESHES[name]()
    for seed in range(6):
        deformed = meshes.wrinkled(mesh, seed, amplitude)
        refiner, refined = refine_and_check(mesh, deformed, threshold_once=0.01)
        assert_is_twin(mesh, deformed, refiner, refined)


@settings(max_examples=200, deadline=None)
@given(soup=soups(), data=st.data())
def test_soups(soup, data):
    """Random triangles with random splits pass the checker and equal the twin's result.

    Neighbouring triangles agree along edges.
    """
    positions, faces = soup
    mesh = meshes.Mesh(positions, faces)
    edge_count = len(refine.connect(faces, len(positions)).edges)
    splits = data.draw(st.lists(st.integers(0, 2), min_size=edge_count, max_size=edge_count))
    refiner, refined = refine_and_check(mesh, positions, criterion=Forced(splits))
    assert_is_twin(mesh, positions, refiner, refined, normals_cancel=True)


def test_capacity_is_reached():
    """With every edge split twice, the output has the full capacity.

    The capacity is ten subtriangles per triangle.
    """
    mesh = meshes.octahedron()
    refiner, refined = refine_and_check(mesh, mesh.vertices, criterion=Forced(np.full(12, 2)))
    assert len(refined.triangles) == refiner.triangle_capacity == 80
    assert len(refined.positions) == refiner.vertex_capacity == 6 + 36


def test_frames_are_independent():
    """A frame does not depend on earlier frames (section 3)."""
    mesh = meshes.irregular(5)
    frames = [meshes.wrinkled(mesh, seed) for seed in range(4)]
    reused = kahler(mesh)
    for deformed in [*frames, mesh.vertices, frames[0]]:
        fresh = kahler(mesh)
        for ours, theirs in zip(
            reused.refine(deformed)[:4], fresh.refine(deformed)[:4], strict=True
        ):
            assert ours.tobytes() == theirs.tobytes()
