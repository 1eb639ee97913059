"""The paper's criterion: edges that must split, and edges that must not."""

import numpy as np
import pytest

from risorius import refine
from risorius.refine.kahler.criterion import DROP_ROUNDING
from tests import meshes
from tests.refine.cases import Forced, as_lists, kahler
from tests.refine.plain_twin import edge_dots, edge_name


@pytest.mark.parametrize("seed", range(5))
def test_undeformed_equals_pass_through(seed):
    """At threshold 0 the undeformed mesh equals that of the refiner `none`, to the last bit."""
    mesh = meshes.irregular(seed)
    refiner = kahler(mesh, threshold_once=0.0, threshold_twice=0.0)
    plain = refine.create("none", mesh.faces, mesh.vertices)
    for ours, theirs in zip(
        refiner.refine(mesh.vertices)[:4], plain.refine(mesh.vertices)[:4], strict=True
    ):
        assert ours.tobytes() == theirs.tobytes()
        assert (ours.shape, ours.dtype) == (theirs.shape, theirs.dtype)
    assert not refiner.splits.any()


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("distance", [0.0, 30.0, 1e5])
def test_rigid_motion(seed, distance):
    """A rigid motion splits nothing, even at threshold 0 and far from the origin."""
    mesh = meshes.irregular(seed)
    refiner = kahler(mesh, threshold_once=0.0, threshold_twice=0.0)
    moved = mesh.vertices @ meshes.rotation(seed).T + distance * np.array([1.0, -0.7, 0.4])
    refiner.refine(moved)
    assert not refiner.splits.any()


def test_rigid_motion_of_slivers():
    """Triangles with collinear corners have no normal that could turn, so they never split."""
    line = np.array([[0, 0, 0], [1, 1, 1], [2, 2, 2], [3, 3, 3.0]]) / 3.0
    faces = np.array([[0, 1, 2], [1, 3, 2]])
    refiner = refine.create("kahler", faces, line, threshold_once=0.0, threshold_twice=0.0)
    for seed in range(20):
        refiner.refine(line @ meshes.rotation(seed).T)
        assert not refiner.splits.any()


@pytest.mark.parametrize("seed", range(8))
def test_splits_follow_drops(seed):
    """Each edge is split according to its drop of the dot product, computed in plain arithmetic."""
    mesh = meshes.irregular(seed)
    deformed = meshes.wrinkled(mesh, seed + 100, amplitude=0.5)
    rest = edge_dots(*as_lists(mesh.vertices, mesh.faces))
    now = edge_dots(*as_lists(deformed, mesh.faces))
    refiner = kahler(mesh, threshold_once=0.1, threshold_twice=0.3)
    refiner.refine(deformed)
    seen = set()
    for (a, b), split in zip(refiner.edges, refiner.splits, strict=True):
        edge = edge_name(a, b)
        drop = rest[edge] - now[edge]
        if min(abs(drop - 0.1), abs(drop - 0.3)) > 1e-5:
            assert split == int(drop > 0.1) + int(drop > 0.3)
            seen.add(int(split))
    assert seen == {0, 1, 2}


def test_only_bending_counts():
    """Unbending never splits.

    A flattened cylinder has larger dot products than the cylinder at rest.
    """
    tube = meshes.tube()
    refiner = refine.create("kahler", tube.faces, tube.vertices, threshold_once=0.0)
    refiner.refine(tube.vertices * np.array([1.0, 1.0, 0.5]))
    assert not refiner.splits.any()


def test_rounding_guard():
    """At threshold 0 a drop as small as rounding errors does not count; a larger drop does."""
    mesh = meshes.half_shut_book()
    flat = np.array([[0, 0, 0], [0, 1, 0], [1, 0.5, 0], [-1, 0.5, 0.0]])
    refiner = refine.create("kahler", mesh.faces, flat, threshold_once=0.0, threshold_twice=1.0)
    for drop, expected in ((0.1 * DROP_ROUNDING, 0), (10 * DROP_ROUNDING, 4)):
        # The outer vertices have normals perpendicular to the slope, the inner vertices upright
        # ones.
        bent = flat.copy()
        bent[2:, 2] = np.tan(np.arccos(1.0 - drop))
        refiner.refine(bent)
        assert refiner.splits.sum() == expected


def test_thresholds_between_frames():
    """Changed thresholds, or a replaced pair of thresholds, take effect in the next frame."""
    mesh = meshes.irregular(3)
    deformed = meshes.wrinkled(mesh, 4)
    criterion = refine.NormalDrop(0.02, 0.08)
    refiner = kahler(mesh, criterion=criterion)
    refiner.refine(deformed)
    assert set(refiner.splits.tolist()) == {0, 1, 2}
    criterion.thresholds.twice = np.float32(np.inf)
    refiner.refine(deformed)
    assert set(refiner.splits.tolist()) == {0, 1}
    criterion.thresholds = refine.NormalDrop(3.0, 3.0).thresholds
    refiner.refine(deformed)
    assert not refiner.splits.any()


def test_criterion_from_outside():
    """A user's criterion replaces the thresholds; more than two splits of an edge are refused."""
    mesh = meshes.octahedron()
    refiner = kahler(mesh, criterion=Forced([1] * 12))
    assert len(refiner.refine(mesh.vertices).triangles) == 4 * 8
    wrong = kahler(mesh, criterion=Forced([1, 3] * 6))
    with pytest.raises(ValueError, match=r"Forced.mark must write 0, 1 or 2 .* edge 1 got 3"):
        wrong.refine(mesh.vertices)
