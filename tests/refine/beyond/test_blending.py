"""Blending: the refined surface is a continuous function of the positions, so nothing pops."""

import numpy as np
import pytest
import trimesh
from numpy.linalg import norm
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from risorius import refine
from risorius.geometry.directions import unit_vectors
from tests import meshes
from tests.refine.cases import (
    SOME_PLACES,
    Forced,
    GivenMetric,
    edge_count_of,
    kahler,
    scheme_of,
    sound_frame,
    surface_at,
)

SCHEMES = ("loop", "cubic", "detail")
QUICK_SCHEMES = [
    "cubic",
    *(pytest.param(scheme, marks=pytest.mark.slow) for scheme in ("loop", "detail")),
]
LARGEST_RATIO = 12.0
"""No point of the surface moves more than this many times the largest motion of the input.

Largest seen: 3.9 for curved edges, 5.0 for detail, 4.7 for the paper's rules; a quarter of the
thresholds' distance, over which a point grows, is a small turn. Without blending 26 to 65, more the
smaller the steps are."""
STEPS = 400


def jumps(scheme, blend, criterion, mesh=None):
    """The surface's largest motion per input motion, and a normal's largest change per step.

    A grid is bent in small steps from flat to strongly wrinkled and back, so that edges pass both
    thresholds in both directions, one after the other. Changes of normals are lengths of
    differences.
    """
    mesh = mesh or meshes.irregular(4, 4, 3, 0)
    wave = meshes.wrinkled(mesh, 5, 0.5) - mesh.vertices
    scheme = scheme_of(scheme, mesh.vertices + 0.02, mesh.faces)
    refiner = kahler(mesh, scheme=scheme, blend=blend, criterion=criterion)
    before = None
    most = 0.0
    turn = 0.0
    positions_before = mesh.vertices
    seen = set()
    for step in range(1, STEPS):
        positions = mesh.vertices + np.sin(1.6 * step / STEPS * np.pi) * wave
        now = surface_at(refiner, refiner.refine(positions), mesh.faces, SOME_PLACES)
        seen.add(refiner.splits.tobytes())
        moved = norm(positions - positions_before, axis=1).max()
        if before is not None and moved > 1e-6:  # the motion reverses once
            most = max(most, float(norm((now - before)[..., :3], axis=2).max() / moved))
            turn = max(turn, float(norm((now - before)[..., 3:], axis=2).max()))
        before = now
        positions_before = positions
    assert len(seen) > 20
    return most, turn


@pytest.mark.parametrize("scheme", SCHEMES)
def test_nothing_pops(scheme):
    """With blending every point of the surface moves at most in proportion to the input."""
    most, turn = jumps(scheme, True, "normal")
    assert most < LARGEST_RATIO
    # Edges crumple until the normals of neighbours are 120 degrees apart. An added point between
    # them changes interpolated shading by up to 0.15 at once, for steps of any size.
    assert turn < 0.5


@pytest.mark.parametrize("scheme", QUICK_SCHEMES)
@pytest.mark.parametrize("name", ["seam", "valence 20"])
def test_nothing_pops_at_seams_and_tips(name, scheme):
    """Nothing pops on a small tube with a seam, or at a tip, where normals turn fastest."""
    mesh = meshes.tube(6, 3) if name == "seam" else meshes.double_cone(20)
    blended = jumps(scheme, True, "normal", mesh)[0]
    assert blended < 2 * LARGEST_RATIO
    assert blended < 0.7 * jumps(scheme, False, "normal", mesh)[0]


@pytest.mark.parametrize("scheme", QUICK_SCHEMES[::2])
@pytest.mark.parametrize("criterion", ["displacement", "normal+rest"])
def test_nothing_pops_by_other_criteria(criterion, scheme):
    """Nothing pops with the other criteria, or with their maximum."""
    assert jumps(scheme, True, criterion)[0] < LARGEST_RATIO


@pytest.mark.parametrize("scheme", QUICK_SCHEMES[:2])
@pytest.mark.parametrize("name", ["icosahedron", "box", "cone"])
def test_outlines_do_not_pop(name, scheme):
    """Nothing jumps on a body that rolls in the view.

    All its edges turn by 40 degrees or more. In these steps points move 53 to 104 times as far as
    the input without blending, and 1.7 to 3.5 times with blending.
    """
    body = {
        "icosahedron": trimesh.creation.icosahedron,
        "box": trimesh.creation.box,
        "cone": lambda: trimesh.creation.cone(1.0, 2.0, sections=8),
    }[name]()
    eye = np.array([0.0, 0.0, 8.0])

    def most(blend):
        refiner = refine.create(
            "kahler",
            body.faces,
            body.vertices,
            scheme=scheme,
            blend=blend,
            criterion="silhouette",
        )
        largest = 0.0
        before = None
        for step in range(STEPS):
            turn = Rotation.from_rotvec(np.array([0.3, 0.5, 0.1]) * step / STEPS)
            positions = turn.apply(body.vertices)
            refined = refiner.refine(positions, view=refine.View(eye))
            points = surface_at(refiner, refined, body.faces, SOME_PLACES)[..., :3]
            if before is not None:
                moved = norm(positions - before[0], axis=1).max()
                jump = norm(points - before[1], axis=2).max()
                largest = max(largest, float(jump / moved))
            before = positions, points
        return largest

    assert most(True) < LARGEST_RATIO < most(False)


@pytest.mark.parametrize("scheme", QUICK_SCHEMES[:2])
def test_any_change_of_needs_is_followed(scheme):
    """For any metrics of its three edges, a triangle does not jump.

    The largest jump seen is 0.8 of the change of the metrics. A diagonal that turns would jump 0.1
    at once.
    """
    vertices = [[0, 0, 0], [1, 0, 0], [0.3, 0.9, 0], [1.2, 1, -0.6], [-0.6, 0.5, -0.6]]
    positions = np.array([*vertices, [0.4, -0.9, -0.6]])
    faces = np.array([[0, 1, 2], [1, 3, 2], [0, 2, 4], [0, 5, 1]], dtype=np.int32)
    edges = refine.connect(faces, len(positions)).edges
    numbers = {frozenset(edge): k for k, edge in enumerate(edges.tolist())}
    inner = [numbers[frozenset(edge)] for edge in ((0, 1), (1, 2), (0, 2))]
    places = np.random.default_rng(1).dirichlet([1, 1, 1], 20)

    def surface(metrics):
        metric = np.full(len(edges), -1.0)
        metric[inner] = metrics
        criterion = GivenMetric(metric)
        refiner = refine.create(
            "kahler", faces, positions, scheme=scheme, blend=True, criterion=criterion
        )
        refined = sound_frame(refiner, positions)
        return surface_at(refiner, refined, faces, places)[0, :, :3]

    generator = np.random.default_rng(0)
    step = 1e-4
    for _ in range(300):
        metrics = generator.uniform(-0.2, 1.5, 3)
        metrics[generator.integers(3)] = generator.choice([0.0, 0.25, 1.0, 1.25, metrics[0]])
        change = generator.uniform(-step, step, 3)
        assert np.abs(surface(metrics + change) - surface(metrics)).max() < 2.0 * step


def test_folds_have_no_scales():
    """On a cylinder with two grown edges per triangle, no subtriangle is tilted along the axis.

    Lines from the centroid to the corners would tilt subtriangles by up to 5.5 degrees.
    """
    grid = meshes.open_grid(9, 9)
    angle = 0.5 * grid.vertices[:, 0]
    along = grid.vertices[:, 1]
    rolled = np.stack([2.0 * np.sin(angle), along, 2.0 * np.cos(angle)], axis=1)
    refiner = kahler(grid, scheme="cubic", criterion=GivenMetric(_across(grid)))
    refined = refiner.refine(rolled)
    corners = refined.positions[refined.triangles].astype(np.float64)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = unit_vectors(normals)
    inside = np.abs(corners[..., 1] - along.mean()).max(axis=1) < 0.3 * np.ptp(along)
    assert inside.sum() > 100
    assert np.degrees(np.abs(np.arcsin(normals[inside, 1]))).max() < 0.5


def _across(grid):
    """Metrics of edges: none for edges along y, 0.9 of a split for all others."""
    edges = refine.connect(grid.faces, len(grid.vertices)).edges
    is_along = np.ptp(grid.vertices[edges][..., 0], axis=1) < 1e-9
    return np.where(is_along, -1.0, 0.9)


def test_without_blending_it_pops():
    """Without blending the measure detects pops, because the paper's rules have some."""
    assert jumps("loop", False, "normal")[0] > 2 * LARGEST_RATIO


@pytest.mark.parametrize("scheme", SCHEMES)
def test_begins_at_the_unrefined_surface(scheme):
    """Metrics near 0 give the surface of the unrefined mesh; there is no step at a metric of 1."""
    mesh = meshes.irregular(7, 5, 4, 0)
    deformed = meshes.wrinkled(mesh, 8)
    edge_count = edge_count_of(mesh)
    places = np.random.default_rng(9).dirichlet([1, 1, 1], 8)

    def surface(metric):
        refiner = kahler(
            mesh,
            scheme=scheme_of(scheme, mesh.vertices + 0.02, mesh.faces),
            blend=True,
            criterion=GivenMetric(np.full(edge_count, metric)),
        )
        return surface_at(refiner, refiner.refine(deformed), mesh.faces, places)[..., :3]

    assert_allclose(surface(1e-6), surface(-1.0), rtol=0, atol=1e-5)
    assert_allclose(surface(1.0 + 1e-6), surface(1.0 - 1e-6), rtol=0, atol=1e-5)
    assert abs(surface(0.5) - surface(-1.0)).max() > 0.01


def test_splits_as_a_measure():
    """A criterion of whole splits works as a metric.

    Its blended points reach their final places.
    """
    mesh = meshes.octahedron()
    wanted = np.arange(12) % 3
    refiner = kahler(mesh, blend=True, criterion=Forced(wanted))
    sound_frame(refiner, mesh.vertices)
    assert refiner.splits.tolist() == wanted.tolist()
