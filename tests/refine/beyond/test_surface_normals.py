"""Normals of the refined surface: correct, continuous, and independent of splits."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.linalg import norm
from numpy.testing import assert_allclose
from scipy.spatial import KDTree

from risorius import refine
from risorius.geometry.directions import unit_vectors
from risorius.refine.beyond import whole_surface
from risorius.refine.mesh.threads import parallel_for
from tests import meshes
from tests.refine.cases import (
    SOME_PLACES,
    GivenMetric,
    edge_count_of,
    kahler,
    scheme_of,
    surface_at,
)

SCHEMES = ("loop", "cubic", "detail")
STEPS = 800
"""Of a motion. What pops does so at once, however small the steps are."""


def bound(mesh, scheme, criterion, normals="refined", blend=True):
    """A refiner; the finer mesh of `detail` is the mesh itself, a little higher."""
    scheme = scheme_of(scheme, mesh.vertices + np.array([0.0, 0.0, 0.02]), mesh.faces)
    return kahler(mesh, scheme=scheme, criterion=criterion, normals=normals, blend=blend)


def metrics(mesh, seed=None, metric=0.0):
    """Metrics of all edges: the same, or random ones of no, one and two splits."""
    count = edge_count_of(mesh)
    if seed is None:
        return np.full(count, metric)
    return np.random.default_rng(seed).uniform(-0.7, 2.0, count)


def turns(some, others):
    """Angles [radians] between unit vectors, shape (...,)."""
    chords = norm(np.asarray(some, dtype=np.float64) - others, axis=-1)
    return 2.0 * np.arcsin(np.minimum(0.5 * chords, 1.0))


@pytest.mark.parametrize("scheme", SCHEMES)
def test_edges_have_normals_where_they_are_needed(scheme, monkeypatch):
    """Normals of edges are computed for split edges only, or for all if a criterion measures them.

    Both ways give the same bits.
    """
    found = []

    def counted(kernel, count, *arguments):
        found.append((kernel.__name__, count))
        parallel_for(kernel, count, *arguments)

    monkeypatch.setattr(whole_surface, "parallel_for", counted)
    mesh = meshes.irregular(4)
    quiet = bound(mesh, scheme, "normal")
    measured = bound(mesh, scheme, ["normal", refine.Displacement(levels=0)])
    for seed in range(3):
        deformed = meshes.wrinkled(mesh, seed, 0.05)
        found.clear()
        one = quiet.refine(deformed)
        split_count = np.count_nonzero(quiet.splits)
        assert 0 < split_count < len(quiet.edges)
        assert ("surface_normals_of_edges", split_count) in found
        assert "measure_edges" not in dict(found)
        found.clear()
        other = measured.refine(deformed)
        assert found.count(("measure_edges", len(quiet.edges))) == 1
        assert "surface_normals_of_edges" not in dict(found)
        for alone, beside in zip(one[:4], other[:4], strict=True):
            assert alone.tobytes() == beside.tobytes()


@pytest.mark.parametrize("scheme", SCHEMES)
def test_normals_do_not_depend_on_splits(scheme):
    """A vertex's normal has the same bits for all splits.

    The same holds for the normal of a fully grown middle.
    """
    mesh = meshes.irregular(3)
    deformed = meshes.wrinkled(mesh, 4, 0.2)
    count = len(mesh.vertices)
    whole = bound(mesh, scheme, GivenMetric(metrics(mesh, metric=0.9)))
    still = whole.refine(deformed)
    vertices = still.normals[:count].copy()
    middles = {}
    for edge, normal in zip(whole.edges.tolist(), still.normals[count:], strict=False):
        middles[tuple(edge)] = normal.copy()
    for criterion in ("displacement", "normal", "rest", 0, 1, 2):
        decides = GivenMetric(metrics(mesh, criterion)) if isinstance(criterion, int) else criterion
        blend = isinstance(criterion, str)
        refiner = bound(mesh, scheme, decides, blend=blend)
        refined = refiner.refine(deformed)
        assert np.array_equal(refined.normals[:count], vertices)
        if blend:
            continue  # not all points have grown
        origins = refiner.origins()
        rows = np.flatnonzero((origins.weights == 0.5).sum(axis=1) == 2)
        assert len(rows) == (refiner.splits > 0).sum()
        for row in rows:
            a, b = origins.vertices[row][origins.weights[row] > 0.0]
            expected = middles[(a, b)] if (a, b) in middles else middles[(b, a)]
            assert np.array_equal(refined.normals[row], expected)


def smooth_wave(mesh, height):
    """A grid with one wave along each axis.

    Normals at the ends of an edge are within 50 degrees.
    """
    x = mesh.vertices[:, 0]
    y = mesh.vertices[:, 1]
    along = np.sin(0.9 * x)
    across = 0.6 * np.cos(0.8 * y + 0.3 * x)
    return np.column_stack([x, y, height * (along + across)])


@pytest.mark.slow
@pytest.mark.parametrize("scheme", SCHEMES)
def test_normals_do_not_pop(scheme):
    """In a smooth motion through all thresholds, shading turns in proportion to the motion.

    The largest ratio seen is 1.7 times the turn of the surface's own normals. Without blending it
    is 54 to 62, and twice that with steps of half the size.
    """
    mesh = meshes.open_grid(8, 6)

    def most(blend):
        refiner = bound(mesh, scheme, [refine.Displacement(0.02, 0.08)], blend=blend)
        own = bound(mesh, scheme, GivenMetric(metrics(mesh, metric=0.9)))
        before = None
        largest = 0.0
        seen = set()
        for step in range(STEPS):
            positions = smooth_wave(mesh, 0.6 * step / STEPS)
            shown = surface_at(refiner, refiner.refine(positions), mesh.faces, SOME_PLACES)[..., 3:]
            surface = own.refine(positions).normals.copy()
            seen.add(refiner.splits.tobytes())
            if before is not None:
                turn = turns(surface, before[1]).max()
                largest = max(largest, float(turns(shown, before[0]).max() / turn))
            before = shown, surface
        assert len(seen) > 50
        assert set(refiner.splits.tolist()) == {0, 1, 2}
        return largest

    assert most(True) < 4.0 < 40.0 < most(False)


@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 2**16),
    scheme=st.sampled_from(SCHEMES),
    edge=st.integers(0, 1000),
    at=st.sampled_from([0.0, 0.25, 1.0, 1.25]),
)
def test_geomorph_has_no_steps(seed, scheme, edge, at):
    """Shading does not jump when an edge passes a threshold, for any splits around it.

    The remaining change comes from interpolation between more points: 3 degrees for turns of 80.
    """
    mesh = meshes.open_grid(5, 4)
    positions = smooth_wave(mesh, 0.4)
    metric = metrics(mesh, seed)

    def shading(value):
        metric[edge % len(metric)] = value
        refiner = bound(mesh, scheme, GivenMetric(metric))
        return surface_at(refiner, refiner.refine(positions), mesh.faces, SOME_PLACES)[..., 3:]

    assert turns(shading(at - 1e-4), shading(at + 1e-4)).max() < 0.05


def torus(around=16, across=10):
    """A torus of radii 1 and 0.4."""
    grid = meshes.open_grid(around, across)
    u = 2.0 * np.pi * grid.vertices[:, 0] / around
    v = 2.0 * np.pi * grid.vertices[:, 1] / across
    out = 1.0 + 0.4 * np.cos(v)
    points = np.column_stack([out * np.cos(u), out * np.sin(u), 0.4 * np.sin(v)])
    column = grid.vertices[:, 0].astype(int)
    row = grid.vertices[:, 1].astype(int)
    number = (row % across) * around + column % around
    first = np.unique(number, return_index=True)[1]
    return meshes.Mesh(points[first], number[grid.faces].astype(np.int32))


def exact(name, points):
    """Unit normals of the exact surface at points near it, shape (..., 3)."""
    if name == "torus":
        ring = points * [1.0, 1.0, 0.0]
        directions = points - unit_vectors(ring)
    else:
        directions = points / np.square([1.0, 0.6, 1.5])
    return directions / norm(directions, axis=-1, keepdims=True)


@pytest.mark.parametrize("metric", [0.9, 2.0])
@pytest.mark.parametrize("name", ["ellipsoid", "torus"])
def test_nearer_to_the_exact_normals(name, metric):
    """On surfaces with known normals, refined normals are nearer to these than linear ones."""
    ball = meshes.ball(2)
    ellipsoid = meshes.Mesh(ball.vertices * [1.0, 0.6, 1.5], ball.faces)
    mesh = torus() if name == "torus" else ellipsoid
    places = np.random.default_rng(6).dirichlet([1, 1, 1], 40)
    off = {}
    for normals in ("linear", "refined"):
        refiner = bound(mesh, "cubic", GivenMetric(metrics(mesh, metric=metric)), normals)
        seen = surface_at(refiner, refiner.refine(mesh.vertices), mesh.faces, places)
        off[normals] = turns(seen[..., 3:], exact(name, seen[..., :3])).mean()
    assert off["refined"] < 0.75 * off["linear"]


@pytest.mark.parametrize("scheme", SCHEMES)
def test_points_stay(scheme):
    """The option `normals` only changes normals: positions and triangles have the same bits."""
    mesh = meshes.irregular(5)
    deformed = meshes.wrinkled(mesh, 6)
    frames = []
    for normals in ("linear", "refined"):
        refiner = bound(mesh, scheme, GivenMetric(metrics(mesh, 7)), normals)
        refined = refiner.refine(deformed)
        frames.append((refined.positions.tobytes(), refined.triangles.tobytes()))
    assert frames[0] == frames[1]


@pytest.mark.parametrize("scheme", ["loop", "cubic"])
def test_symmetric_stays_symmetric(scheme):
    """An opened slit that is symmetric in x and y has normals with the same symmetry."""
    mesh = meshes.slit()
    positions = meshes.opened(mesh, 0.8)
    x = positions[:, 0]
    y = positions[:, 1]
    positions[:, 2] = 0.5 * np.cos(0.8 * x) * np.cos(0.9 * y)
    refined = bound(mesh, scheme, [refine.Displacement(0.01, 0.05)]).refine(positions)
    assert len(refined.positions) > 1.5 * len(positions)
    for mirror in ([-1.0, 1.0, 1.0], [1.0, -1.0, 1.0]):
        mirrored = np.hstack([refined.positions * mirror, 0.1 * refined.normals * mirror])
        shown = np.hstack([refined.positions, 0.1 * refined.normals])
        distance, _ = KDTree(shown).query(mirrored)
        assert distance.max() < 1e-5


@pytest.mark.parametrize("scheme", ["loop", "cubic"])
@pytest.mark.parametrize("blend", [False, True])
def test_planar_is_exact(scheme, blend):
    """All normals of a plane have the same bits, also with borders and holes."""
    mesh = meshes.irregular(2)
    flat = mesh.vertices * [1.0, 1.0, 0.0]
    criterion = GivenMetric(metrics(mesh, 3))
    refiner = bound(meshes.Mesh(flat, mesh.faces), scheme, criterion, blend=blend)
    normals = refiner.refine(flat).normals
    assert (normals[:, :2] == 0.0).all()
    is_used = np.ones(len(normals), dtype=bool)
    is_used[: len(flat)] = np.isin(np.arange(len(flat)), mesh.faces)
    assert_allclose(np.abs(normals[is_used, 2]), 1.0, rtol=0, atol=1e-6)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_moves_with_the_mesh(scheme):
    """A rigid motion turns all normals with it, also over a distance of 100 000 edge lengths."""
    mesh = meshes.irregular(8)
    deformed = meshes.wrinkled(mesh, 9, 0.2)
    turn = meshes.rotation(1)
    refiner = bound(mesh, scheme, GivenMetric(metrics(mesh, 2)))
    still = refiner.refine(deformed).normals.copy()
    moved = refiner.refine(deformed @ turn.T + [3.0, -2.0, 5.0]).normals
    assert_allclose(moved, still @ turn.T, rtol=0, atol=1e-4)
    far = refiner.refine(deformed + 1e5).normals
    assert_allclose(far, still, rtol=0, atol=2e-5)
