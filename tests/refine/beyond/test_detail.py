"""Detail of a finer mesh: it appears at rest, and moves with the surface."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from risorius import refine
from risorius.geometry.closest import closest_points
from risorius.geometry.directions import unit_vectors
from risorius.geometry.normals import vertex_normals
from tests import meshes
from tests.refine import plain_twin
from tests.refine.cases import (
    GivenMetric,
    as_lists,
    assert_equals_twin,
    edge_count_of,
    kahler,
    point_names,
    scheme_of,
    sound_frame,
)
from tests.refine.plain_detail import detail_rules
from tests.refine.plain_normals import RefinedNormals


def bumpy(columns, rows):
    """A grid of 4 x 3 cells with bumps that a coarse grid cannot represent."""
    grid = meshes.open_grid(columns, rows)
    vertices = grid.vertices * [4.0 / columns, 3.0 / rows, 1.0]
    x = vertices[:, 0]
    y = vertices[:, 1]
    bumps = 0.1 * np.sin(4.0 * x) * np.cos(5.0 * y)
    vertices[:, 2] = bumps + 0.2 * np.sin(x)
    return meshes.Mesh(vertices, grid.faces)


COARSE_MESH = bumpy(8, 6)
FINE_MESH = bumpy(48, 36)


def distances(points, positions, triangles):
    """Distance of each point from a mesh."""
    return closest_points(points, positions, triangles).distances


def angles(some, others):
    """Degrees between unit vectors, shape (N, 3)."""
    return np.degrees(np.arccos(np.clip((some * others).sum(axis=1), -1.0, 1.0)))


def refined(scheme, positions, **options):
    """The coarse grid with all edges split twice."""
    edge_count = len(refine.connect(COARSE_MESH.faces, len(COARSE_MESH.vertices)).edges)
    criterion = GivenMetric(np.full(edge_count, 9.0))
    chosen = scheme_of(scheme, FINE_MESH.vertices, FINE_MESH.faces)
    refiner = kahler(COARSE_MESH, scheme=chosen, criterion=criterion, **options)
    mesh = sound_frame(refiner, positions)
    return mesh


@pytest.mark.parametrize("blend", [False, True])
def test_lies_on_the_finer_mesh(blend):
    """At rest, with all edges split, the detail scheme is much closer to the finer mesh."""
    errors = {}
    for scheme in ("cubic", "detail"):
        mesh = refined(scheme, COARSE_MESH.vertices, blend=blend)
        errors[scheme] = distances(FINE_MESH.vertices, mesh.positions, mesh.triangles).mean()
    coarse = distances(FINE_MESH.vertices, COARSE_MESH.vertices, COARSE_MESH.faces).mean()
    assert errors["detail"] < 0.25 * coarse
    assert errors["detail"] < 0.5 * errors["cubic"]


def test_normals_of_the_surface_are_the_finer_ones():
    """With all edges split, refined normals are nearer to the finer mesh's than mean normals."""
    fine_normals = vertex_normals(FINE_MESH.vertices, FINE_MESH.faces)
    off = {}
    for normals in ("linear", "refined"):
        mesh = refined("detail", COARSE_MESH.vertices, normals=normals)
        places = mesh.positions.astype(np.float64)
        expected = closest_points(places, FINE_MESH.vertices, FINE_MESH.faces).interpolate(
            fine_normals
        )
        expected = unit_vectors(expected)
        off[normals] = np.median(angles(expected, mesh.normals))
    assert off["refined"] < 0.4 * off["linear"]


def test_no_stars_in_folds():
    """With a finer mesh that adds nothing, normals of a folded grid are as smooth as cubic ones.

    Between a vertex and the quarter points around it, normals turn by a part of the fold. With one
    direction for a whole edge, they would turn by half of the fold at the first quarter point, and
    by nothing after it.
    """
    flat = meshes.open_grid(8, 6)
    x = flat.vertices[:, 0] - 4.0
    folded = np.stack([x, flat.vertices[:, 1], np.sqrt(x * x + 0.2)], axis=1)
    edge_count = len(refine.connect(flat.faces, len(folded)).edges)
    shown = {}
    off = {}
    for scheme in ("cubic", "detail"):
        chosen = scheme_of(scheme, flat.vertices, flat.faces)
        refiner = kahler(flat, scheme=chosen, criterion=GivenMetric(np.full(edge_count, 9.0)))
        mesh = refiner.refine(folded)
        is_middle = refiner.origins().weights.max(axis=1) < 0.4
        shown[scheme] = mesh.normals[~is_middle].copy()
        x = mesh.positions[is_middle, 0]
        true = np.stack([-x / np.sqrt(x * x + 0.2), np.zeros_like(x), np.ones_like(x)], axis=1)
        true = unit_vectors(true)
        off[scheme] = angles(true, mesh.normals[is_middle])
    assert angles(shown["cubic"], shown["detail"]).max() < 5.0
    # The middles of triangles lie elsewhere in both schemes, so they are compared with the fold
    # itself: up to 7.5 degrees, and 24 with linear normals.
    assert off["detail"].max() < off["cubic"].max() + 1.0


@pytest.mark.parametrize("seed", range(3))
def test_turns_with_the_mesh(seed):
    """A rigid motion of the mesh moves all detail rigidly: points, middles and normals."""
    turn = meshes.rotation(seed)
    still = refined("detail", COARSE_MESH.vertices)
    moved = refined("detail", COARSE_MESH.vertices @ turn.T + [1.0, 2.0, 3.0])
    assert_allclose(moved.positions, still.positions @ turn.T + [1, 2, 3], atol=2e-5)
    assert_allclose(moved.normals, still.normals @ turn.T, atol=2e-4)


@settings(max_examples=25, deadline=None)
@given(
    mesh=st.one_of(
        st.builds(meshes.irregular, st.integers(0, 99), st.just(5), st.just(4), st.integers(0, 2)),
        st.builds(meshes.double_cone, st.integers(3, 60)),
        st.sampled_from([meshes.octahedron(), meshes.tube(6, 2)]),
    ),
    seed=st.integers(0, 2**16),
    normals=st.sampled_from(["linear", "refined"]),
    blend=st.booleans(),
)
def test_equals_plain_twin(mesh, seed, normals, blend):
    """Detail moves as in the simple twin, for any splits and geomorph weights."""
    generator = np.random.default_rng(seed)
    lift = 0.05 * generator.standard_normal(mesh.vertices.shape)
    edge_count = edge_count_of(mesh)

    def refiner_of(metric, blend):
        return kahler(
            mesh,
            scheme=refine.DetailScheme((mesh.vertices + lift, mesh.faces)),
            blend=blend,
            criterion=GivenMetric(metric),
            normals=normals,
        )

    everything = refiner_of(np.full(edge_count, 2.0), True)
    still = everything.refine(mesh.vertices).positions.astype(float).tolist()
    seen = {
        name: tuple(each)
        for name, each in zip(point_names(everything.origins()), still, strict=True)
    }
    metric = generator.uniform(-0.7, 2.0, edge_count)
    deformed = meshes.wrinkled(mesh, seed, 0.1)
    refiner = refiner_of(metric, blend)
    refined = sound_frame(refiner, deformed)

    rest, faces = as_lists(mesh.vertices, mesh.faces)
    points, _ = as_lists(deformed, mesh.faces)
    needed = GivenMetric(metric)
    splits = plain_twin.splits_of(refiner.edges, needed.metric)
    rules = detail_rules(rest, points, faces, seen)
    if normals == "refined":
        rules = RefinedNormals(rules, faces)
    twin = plain_twin.refine(
        points,
        faces,
        splits,
        geomorph=needed.geomorph(refiner.edges) if blend else None,
        rules=rules,
    )
    # Short edges magnify errors: directions are rounded to single precision twice.
    assert_equals_twin(refiner, refined, twin, tolerance=(2e-5, 2e-4))


@pytest.mark.slow
def test_many_vertices_in_one_place():
    """Thousands of finer vertices in one place are searched in bounded time.

    Their detail is finite.
    """
    random = np.random.default_rng(3)
    positions = np.zeros((3000, 3))
    positions[:3] = np.eye(3)
    faces = random.integers(0, 3000, (4000, 3))
    scheme = refine.DetailScheme((positions, faces))
    refiner = refine.create("kahler", faces[:500], positions, scheme=scheme)
    assert np.isfinite(refiner.refine(positions).positions).all()


@pytest.mark.parametrize(
    ("finer", "text"),
    [
        (np.eye(3), "needs a finer mesh: pass scheme=.* got ndarray"),
        ((np.eye(3), [[0, 1, 3]]), r"finer\[1\] must hold indices"),
        ((np.eye(3), np.zeros((0, 3), int)), "must have triangles"),
    ],
)
def test_bad_finer_meshes(finer, text):
    """An invalid finer mesh is refused, and the error shows how to pass a valid one."""
    with pytest.raises(ValueError, match=text):
        refine.DetailScheme(finer)
