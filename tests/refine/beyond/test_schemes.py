"""Every scheme, with blending and without, compared with its simple twin and the checker."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.linalg import norm

from risorius import refine
from tests import meshes
from tests.refine import plain_schemes
from tests.refine.cases import (
    GivenMetric,
    as_lists,
    assert_equals_twin,
    edge_count_of,
    kahler,
    scheme_of,
    sound_frame,
    soups,
)
from tests.refine.plain_normals import RefinedNormals
from tests.refine.plain_twin import PaperRules, splits_of
from tests.refine.plain_twin import refine as refine_plainly

SCHEMES = ("loop", "cubic")
TOLERANCES = {"linear": (5e-7, 8e-6), "refined": (5e-7, 3e-5)}
"""Of positions, and of normals; refined ones stand on differences of float32 rows."""
NORMALS_OPTIONS = tuple(TOLERANCES)
VALENCES = {f"fan of {n}": lambda n=n: meshes.double_cone(n) for n in (3, 4, 5, 7, 60, 90)}
MESHES = {**meshes.NAMED_MESHES, **VALENCES, "irregular": lambda: meshes.irregular(3, 6, 5, 1)}


def bound(mesh, scheme, blend, metric, **options):
    """A refiner whose edges have given metrics; the finer mesh of `detail` is the mesh itself."""
    scheme = scheme_of(scheme, mesh.vertices + np.array([0.0, 0.0, 0.01]), mesh.faces)
    return kahler(mesh, scheme=scheme, blend=blend, criterion=GivenMetric(metric), **options)


def twin_of(mesh, deformed, scheme, normals, blend, needed, edges):
    """The same frame by the simple implementation."""
    points, faces = as_lists(deformed, mesh.faces)
    rest, _ = as_lists(mesh.vertices, mesh.faces)
    rules = PaperRules(points, faces)
    if scheme == "cubic":
        rules = plain_schemes.cubic(rest, points, faces)
    if normals == "refined":
        rules = RefinedNormals(rules, faces)
    geomorph = needed.geomorph(edges)
    splits = splits_of(edges, needed.metric)
    return refine_plainly(points, faces, splits, geomorph=geomorph if blend else None, rules=rules)


def random_metrics(mesh, seed):
    """Random metrics from -0.7 to 2 for every edge.

    They mean no split, one split or two, and all values between.
    """
    count = edge_count_of(mesh)
    return np.random.default_rng(seed).uniform(-0.7, 2.0, count)


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("blend", [False, True])
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("normals", NORMALS_OPTIONS)
def test_equals_plain_twin(normals, scheme, blend, name):
    """Points, normals and triangles are those of the simple twin, on meshes of every kind."""
    mesh = MESHES[name]()
    for seed in range(2):
        needed = GivenMetric(random_metrics(mesh, seed))
        deformed = meshes.wrinkled(mesh, seed, 0.2)
        refiner = bound(mesh, scheme, blend, needed.metric, normals=normals)
        refined = sound_frame(refiner, deformed)
        twin = twin_of(mesh, deformed, scheme, normals, blend, needed, refiner.edges)
        cancel = name == "pillow" and normals == "refined"
        if name != "pillow" or not blend:  # the pillow's two middles have one name
            assert_equals_twin(
                refiner, refined, twin, normals_cancel=cancel, tolerance=TOLERANCES[normals]
            )


@settings(max_examples=60, deadline=None)
@given(
    soup=soups(),
    data=st.data(),
    scheme=st.sampled_from(SCHEMES),
    normals=st.sampled_from(NORMALS_OPTIONS),
    blend=st.booleans(),
)
def test_soups_equal_twin(soup, data, scheme, normals, blend):
    """For any triangles with any metrics, the fast kernels agree with the simple twin."""
    positions, faces = soup
    edge_count = len(refine.connect(faces, len(positions)).edges)
    strategy = st.floats(-1, 3, width=32)
    needed = GivenMetric(data.draw(st.lists(strategy, min_size=edge_count, max_size=edge_count)))
    mesh = meshes.Mesh(positions, faces)
    refiner = bound(mesh, scheme, blend, needed.metric, normals=normals)
    refined = refiner.refine(positions)
    corners = [tuple(sorted(face)) for face in faces.tolist()]
    if len(set(corners)) == len(corners) and _has_normals(refined):
        twin = twin_of(mesh, positions, scheme, normals, blend, needed, refiner.edges)
        assert_equals_twin(refiner, refined, twin, normals_cancel=True)


def _has_normals(refined):
    """Whether all normals are larger than rounding errors, which cubic edges would follow."""
    lengths = norm(refined.normals, axis=1)
    return bool((lengths > 0.5).all())


@pytest.mark.parametrize("blend", [False, True])
@pytest.mark.parametrize("scheme", ["cubic", "detail"])
def test_vertices_stay(scheme, blend):
    """Interpolating schemes keep every original vertex in place, to the last bit."""
    mesh = meshes.irregular(5)
    deformed = meshes.wrinkled(mesh, 6)
    refiner = bound(mesh, scheme, blend, random_metrics(mesh, 7))
    refined = refiner.refine(deformed)
    assert (refined.positions[: len(deformed)] == deformed.astype(np.float32)).all()


@pytest.mark.parametrize("scheme", SCHEMES)
def test_flat_stays_flat(scheme):
    """A plane refines into a plane: all weights have the sum one."""
    mesh = meshes.irregular(2)
    flat = mesh.vertices * [1.0, 1.0, 0.0]
    tilted = flat @ np.array([[1, 0, 0.5], [0, 1, -0.3], [0, 0, 1.0]])
    refined = bound(meshes.Mesh(flat, mesh.faces), scheme, True, random_metrics(mesh, 3)).refine(
        tilted
    )
    heights = 0.5 * refined.positions[:, 0] - 0.3 * refined.positions[:, 1]
    np.testing.assert_allclose(refined.positions[:, 2], heights, rtol=0, atol=1e-5)


def test_borders_beside_corners_are_parabolas():
    """Beside a corner, the rim of a half disc follows a parabola, and is not flatter there."""
    angles = np.radians([0.0, 45.0, 90.0, 135.0, 180.0])
    rim = np.stack([np.cos(angles), np.sin(angles), np.zeros(5)], axis=1)
    half_disc = meshes.Mesh(
        np.vstack([np.zeros((1, 3)), rim]),
        np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]], np.uint32),
    )
    edge_count = len(refine.connect(half_disc.faces, 6).edges)
    refiner = bound(half_disc, "cubic", False, np.full(edge_count, 2.0))
    refined = refiner.refine(half_disc.vertices)
    corner, next_to_it, after = rim[:3]
    chord = next_to_it - corner
    at_corner = 2.0 * chord - 0.5 * (after - corner)
    for share in (0.25, 0.5, 0.75):
        expected = corner + share * at_corner + share**2 * (chord - at_corner)
        distances = norm(refined.positions - expected, axis=1)
        assert distances.min() < 1e-5
