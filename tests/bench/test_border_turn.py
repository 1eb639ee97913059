"""The criterion of Fig. 10, written with public names, on meshes with an opening slit."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.linalg import norm

from risorius import refine
from risorius.bench.reproduce.border_turn import BorderTurn
from risorius.geometry.directions import unit_vectors
from risorius.geometry.sides import side_lengths
from tests import meshes
from tests.refine.cases import as_lists, kahler, sound_frame, soups
from tests.refine.plain_schemes import is_corner
from tests.refine.plain_twin import Surroundings

seeds = st.integers(0, 2**16)
heights = st.floats(0.0, 1.5)
SLIT = meshes.slit()
EDGES = refine.connect(SLIT.faces, len(SLIT.vertices)).edges


def splits_of(mesh, deformed, criterion=None):
    """Splits of every edge."""
    refiner = kahler(mesh, criterion=BorderTurn() if criterion is None else criterion)
    sound_frame(refiner, deformed)
    return refiner.splits.copy()


def metrics_of(mesh, *poses):
    """The metric of every edge in each pose."""
    connectivity = refine.connect(mesh.faces, len(mesh.vertices))
    none = refine.create("none", mesh.faces, mesh.vertices)
    criterion = BorderTurn()
    criterion.bind(connectivity, mesh.vertices, none.refine(mesh.vertices).normals.copy())
    metrics = []
    for pose in poses:
        metric = np.zeros(len(connectivity.edges), dtype=np.float32)
        criterion.measure(pose, none.refine(pose).normals.copy(), metric)
        metrics.append(metric)
    return metrics


@settings(max_examples=60, deadline=None)
@given(seeds, st.floats(-1e3, 1e3), st.booleans())
def test_nothing_at_rest(seed, away, has_holes):
    """No edge is split at rest or after a rigid motion."""
    mesh = meshes.irregular(seed % 50) if has_holes else SLIT
    moved = mesh.vertices @ meshes.rotation(seed).T + away
    assert not splits_of(mesh, mesh.vertices).any()
    assert not splits_of(mesh, moved).any()


@settings(max_examples=60, deadline=None)
@given(soups())
def test_any_triangles(soup):
    """Fins, flips and debris split nothing at rest.

    After a motion the refined mesh has no crack.
    """
    positions, faces = soup
    mesh = meshes.Mesh(positions, faces)
    assert not splits_of(mesh, positions).any()
    splits_of(mesh, positions[::-1].copy())


def test_a_slit_that_opens_in_its_plane():
    """Edges along the slit and beside it are split.

    Criteria of normals and of rest split nothing there.
    """
    deformed = meshes.opened(SLIT, 0.8)
    assert not splits_of(SLIT, deformed, "normal+rest").any()
    splits = splits_of(SLIT, deformed)
    x = np.abs(SLIT.vertices[EDGES][..., 0])
    y = np.abs(SLIT.vertices[EDGES][..., 1])
    runs_along = np.ptp(y, axis=1) == 0.0
    on_sides = runs_along & (y == 0.0).all(axis=1) & (x <= 3.0).all(axis=1)
    next_row = runs_along & (y == 1.0).all(axis=1) & (x <= 2.0).all(axis=1)
    across = (np.ptp(x, axis=1) == 0.0) & (y.min(axis=1) == 0.0)
    assert on_sides.sum() == 12
    assert splits[on_sides].min() >= 1
    assert splits[next_row].min() >= 1
    assert not splits[across].any()


@settings(max_examples=40, deadline=None)
@given(heights, heights)
def test_symmetric_in_symmetric_out(height, lower):
    """A border that is symmetric in x, or in x and y, has splits with the same symmetry."""
    for axis, sides in ((0, (height, lower)), (1, (height, height))):
        deformed = meshes.opened(SLIT, sides[0])
        is_below = deformed[:, 1] < 0.0
        deformed[is_below] = meshes.opened(SLIT, sides[1])[is_below]
        splits = splits_of(SLIT, deformed)
        middles = deformed[EDGES].mean(axis=1)
        mirrored = middles * np.where(np.arange(3) == axis, -1.0, 1.0)
        distances = norm(mirrored[:, None] - middles, axis=2)
        # In a shut slit the upper side lies on the lower side, and their splits are equal anyway.
        assert distances.min(axis=1).max() < 1e-9
        np.testing.assert_array_equal(splits, splits[distances.argmin(axis=1)])


@settings(max_examples=60, deadline=None)
@given(seeds, st.floats(0.0, 0.5))
def test_needs_are_continuous(seed, amplitude):
    """Metrics change at most 200 times as much as the mesh moves, in lengths of the shortest edge.

    The factor is large because thresholds are small. Motions include sides that fold back.
    """
    mesh = meshes.irregular(seed % 50)
    start = meshes.wrinkled(mesh, seed, amplitude)
    end = meshes.wrinkled(mesh, seed + 1, amplitude)
    shares = np.linspace(0.0, 1.0, 200)
    poses = [start + share * (end - start) for share in shares]
    edges = refine.connect(mesh.faces, len(start)).edges
    shortest = min(side_lengths(pose, edges).min() for pose in poses)
    step = norm(end - start, axis=1).max() / 199 / max(shortest, 1e-3)
    for before, after in pairwise(metrics_of(mesh, *poses)):
        assert np.abs(after - before).max() <= 200.0 * step + 1e-3


def plain_metric(mesh, normals, pose, rest_normals):
    """The criterion again, with dictionaries, from the description in its file."""
    _, faces = as_lists(mesh.vertices, mesh.faces)
    around = Surroundings(faces)

    def unit(a, b, points):
        return unit_vectors(points[b] - points[a])

    def turn(v, points, n):
        p, q = sorted(around.border_ring[v])
        u = unit(p, v, points)
        w = unit(v, q, points)
        return np.array([u @ w, n[v] @ np.cross(u, w), n[v] @ (w - u)])

    turns = {}
    squares = {}
    for v, ring in around.border_ring.items():
        squares[v] = np.zeros((3, 3))
        for w in ring:
            way = unit(v, w, mesh.vertices)
            squares[v] += np.outer(way, way) / 2
        points = [tuple(map(float, mesh.vertices[w])) for w in (ring[0], v, ring[-1])]
        turns[v] = 0.0
        if len(ring) == 2 and not is_corner(*points):
            change = turn(v, pose, normals) - turn(v, mesh.vertices, rest_normals)
            turns[v] = float(norm(change))
    for k in range(1, 5):
        fade = (5 - k) / (6 - k)
        added = {}
        for v, ring in around.ring.items():
            nearer = [w for w in ring if w in turns]
            if v in turns or not nearer:
                continue
            squares[v] = np.mean([squares[w] for w in nearer], axis=0)
            added[v] = fade * float(np.mean([turns[w] for w in nearer]))
        turns |= added
    metrics = {}
    for a, b in around.opposite:
        e = unit(a, b, mesh.vertices)
        none = np.zeros((3, 3))
        along = e @ (squares.get(a, none) + squares.get(b, none)) @ e / 2
        share = along if (a, b) in around.inner else 1.0
        measure = share * (turns.get(a, 0.0) + turns.get(b, 0.0)) / 2
        metrics[a, b] = (measure - 0.03) / 0.09
    return metrics


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_equals_plain_twin(seed):
    """The metrics equal those of the simple implementation."""
    mesh = meshes.irregular(seed, columns=16, rows=16)
    pose = meshes.wrinkled(mesh, seed)
    none = refine.create("none", mesh.faces, mesh.vertices)
    rest_normals = none.refine(mesh.vertices).normals.copy()
    normals = none.refine(pose).normals.copy()
    (metric,) = metrics_of(mesh, pose)
    plain = plain_metric(mesh, normals.astype(float), pose, rest_normals.astype(float))
    edges = refine.connect(mesh.faces, len(mesh.vertices)).edges
    expected = np.array([plain[min(a, b), max(a, b)] for a, b in edges.tolist()])
    np.testing.assert_allclose(metric, expected, atol=2e-4)
    assert 0.1 < (metric > 0).mean() < 0.95


def outline(positions, triangles, middle, reach):
    """Sorted angles of the border around a place [degrees], without its two corners."""
    mesh = refine.connect(triangles, len(positions))
    after = dict(mesh.edges[~mesh.around.is_interior].tolist())
    before = {b: a for a, b in after.items()}
    curves = np.array([(before[v], v, after[v]) for v in after])
    curves = curves[norm(positions[curves[:, 1]] - middle, axis=1) < reach]
    u, w = np.diff(positions[curves].astype(float), axis=1).swapaxes(0, 1)
    lengths = norm(u, axis=1) * norm(w, axis=1)
    turns = np.arccos(np.clip((u * w).sum(axis=1) / lengths, -1.0, 1.0))
    return np.sort(np.degrees(turns))[:-2]


@pytest.mark.parametrize("scheme", ["loop", "cubic"])
def test_round_outline_of_a_slit(scheme):
    """An opened slit turns less than half as much per vertex after refinement.

    With `loop` this does not hold beside the two corners.
    """
    deformed = meshes.opened(SLIT, 1.2)
    refiner = kahler(SLIT, criterion=BorderTurn(), scheme=scheme, blend=False)
    mesh = refiner.refine(deformed)
    middle = np.zeros(3)
    coarse = outline(deformed, SLIT.faces, middle, 3.1)
    refined = outline(mesh.positions, mesh.triangles, middle, 3.1)
    assert np.median(refined) < 0.5 * np.median(coarse)
    assert scheme == "loop" or refined[-1] < 0.5 * coarse[-1]
