"""A fine mesh that follows a coarse one: rest, rigid motion, continuity, filters and errors."""

import re
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.linalg import norm
from numpy.testing import assert_allclose, assert_array_equal

from risorius import refine
from risorius.geometry.directions import unit_vectors
from tests import meshes

from .twin import Twin


def around(mesh, count=300, away=0.2):
    """Points near the triangles of a mesh, on both sides and beyond borders."""
    rng = np.random.default_rng(5)
    corners = mesh.vertices[mesh.faces[rng.integers(len(mesh.faces), size=count)]]
    shares = rng.dirichlet([1.0, 1.0, 1.0], size=count)
    return np.einsum("nc,nci->ni", shares, corners) + away * rng.normal(size=(count, 3))


def turned(points):
    """Points after a rigid motion: more than half a turn about a slanted axis, and a shift."""
    axis = np.array([1.0, 2.0, -0.5]) / np.sqrt(5.25)
    angle = 3.3
    upright = np.outer(points @ axis, axis)
    aside = points - upright
    moved = upright + np.cos(angle) * aside + np.sin(angle) * np.cross(axis, aside)
    return np.asarray(moved + np.array([3.0, -2.0, 5.0]))


SURFACES = {
    "ball": meshes.ball(),
    "fan": meshes.fan(),
    "tetrahedron": meshes.tetrahedron(),
    "three sheets on an edge": meshes.Mesh(
        np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, -1, 0.3], [0.2, 0.1, 1]], dtype=float),
        np.array([[0, 1, 2], [1, 0, 3], [0, 1, 4]], dtype=np.int32),
    ),
    "both sides of a triangle": meshes.Mesh(
        meshes.triangle().vertices, np.array([[0, 1, 2], [0, 2, 1]], dtype=np.int32)
    ),
}


POINTS = around(SURFACES["ball"])


class Flawed:
    """An embedding with one deliberate fault."""

    def __init__(self, embedding, flaw):
        self._embedding = embedding
        self._flaw = flaw

    def evaluate(self, positions):
        found = self._embedding.evaluate(positions)
        return found._replace(positions=self._flaw(found.positions))


@pytest.mark.parametrize("mesh", SURFACES.values(), ids=SURFACES)
def test_the_checker_passes_embeddings(mesh):
    """The checker passes embeddings of all test surfaces, also far from the origin.

    Some points belong to no triangle.
    """
    points = around(mesh)
    refine.check_embedding(
        refine.Embedding(mesh.faces, mesh.vertices, points), mesh.vertices, points
    )
    away = np.vstack([mesh.vertices + 1e4, [[np.nan] * 3]])
    refine.check_embedding(refine.Embedding(mesh.faces, away, points + 1e4), away, points + 1e4)


@pytest.mark.parametrize(
    ("flaw", "relation"),
    [
        (lambda points: points + np.array([0.0, 1e-3, 0.0]), "at rest points are where they were"),
        (lambda points: points * np.nan, "at rest points are where they were"),
        (lambda points: points - points[:1] + POINTS[:1], "a shift carries"),
        (lambda points: points.mean(axis=0) + POINTS - POINTS.mean(axis=0), "a turn carries"),
    ],
)
def test_the_checker_names_the_broken_relation(flaw, relation):
    """The checker reports points that move at rest, that stay behind, or that do not turn."""
    ball = SURFACES["ball"]
    embedding = Flawed(refine.Embedding(ball.faces, ball.vertices, POINTS), flaw)
    with pytest.raises(refine.BrokenMeshError, match=relation):
        refine.check_embedding(embedding, ball.vertices, POINTS)


@pytest.mark.parametrize("mesh", SURFACES.values(), ids=SURFACES)
def test_rest_is_rest_and_rigid_motion_is_exact(mesh):
    """The fine mesh is at rest if the coarse mesh is, and follows its rigid motion exactly."""
    fine = around(mesh)
    embedding = refine.Embedding(
        mesh.faces, mesh.vertices, fine, binding=refine.Binding(normals=fine)
    )
    rest = embedding.evaluate(mesh.vertices)
    assert rest.normals is not None
    assert_allclose(rest.positions, fine, atol=1e-12)
    unit = unit_vectors(fine)
    assert_allclose(rest.normals, unit, atol=1e-6)
    moved = embedding.evaluate(turned(mesh.vertices))
    assert moved.normals is not None
    assert_allclose(moved.positions, turned(fine), atol=1e-10)
    origin = turned(np.zeros((1, 3)))
    assert_allclose(moved.normals, turned(unit) - origin, atol=1e-6)


@given(st.integers(0, 2**32 - 1))
def test_any_soup_is_carried(seed):
    """For random triangles, also without area, rest and rigid motion are exact; all is finite."""
    rng = np.random.default_rng(seed)
    vertices = rng.normal(size=(8, 3))
    faces = rng.integers(6, size=(rng.integers(2, 12), 3)).astype(np.int32)
    faces[0] = 0, 1, 2
    fine = rng.normal(size=(40, 3))
    embedding = refine.Embedding(faces, vertices, fine)
    assert_allclose(embedding.evaluate(vertices).positions, fine, atol=1e-9)
    assert_allclose(embedding.evaluate(turned(vertices)).positions, turned(fine), atol=1e-7)
    assert np.isfinite(embedding.evaluate(rng.normal(size=(8, 3))).positions).all()
    assert np.isfinite(embedding.evaluate(np.zeros((8, 3))).positions).all()


@settings(max_examples=20)
@given(st.integers(0, 2**32 - 1), st.sampled_from(["ball", "double cone"]))
def test_equal_to_its_twin_in_plain_numpy(seed, name):
    """For any deformation of a closed mesh, fine points equal those of the twin in plain numpy."""
    mesh = meshes.ball(1) if name == "ball" else meshes.double_cone(7)
    rng = np.random.default_rng(seed)
    rest = mesh.vertices + 0.05 * rng.normal(size=mesh.vertices.shape)
    fine = around(meshes.Mesh(rest, mesh.faces), count=30, away=0.1)
    embedding = refine.Embedding(mesh.faces, rest, fine)
    bent = turned(rest * rng.uniform(0.6, 1.5, 3) + 0.1 * rng.normal(size=rest.shape))
    places = embedding.triangles, embedding.weights, embedding.offsets
    twin = Twin(mesh.faces, rest)
    assert_allclose(twin.evaluate(rest, *places), fine, atol=1e-9)
    expected = twin.evaluate(bent, *places)
    assert_allclose(embedding.evaluate(bent).positions, expected, atol=1e-8)


def test_continuous_over_coarse_edges():
    """Neighbouring fine points stay neighbours when the coarse mesh, of any triangles, moves."""
    mesh = meshes.ball(2)
    angle = np.linspace(0.0, 2.0 * np.pi, 20_001)
    ring = np.stack([np.cos(angle), np.sin(angle), 0.3 * np.cos(3 * angle)], axis=1)
    ring *= 1.03 / norm(ring, axis=1, keepdims=True)
    embedding = refine.Embedding(mesh.faces, mesh.vertices, ring)
    assert len(np.unique(embedding.triangles)) > 20
    rng = np.random.default_rng(1)
    moved = mesh.vertices * [1.5, 0.7, 1.0] + 0.05 * rng.normal(size=mesh.vertices.shape)
    steps = norm(np.diff(embedding.evaluate(moved).positions, axis=0), axis=1)
    assert steps.max() < 4.0 * norm(np.diff(ring, axis=0), axis=1).max()


def two_lips():
    """Two sheets that face each other and nearly touch; each has a fine point beyond the other.

    Each point is nearer to the other sheet than to its own, and has its own sheet's normal.
    """
    sheet = meshes.fan()
    upper = sheet.vertices + np.array([0.0, 0.0, 0.01])
    faces = np.concatenate([sheet.faces, sheet.faces[:, ::-1] + len(upper)])
    both = meshes.Mesh(np.concatenate([sheet.vertices, upper]), faces)
    fine = np.array([[0.3, 0.1, 0.007], [0.2, 0.2, 0.003]])
    return both, fine, np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])


def test_normals_and_labels_keep_lips_apart():
    """Normals or labels bind a point to its own surface, even if another surface is nearer."""
    lips, fine, normals = two_lips()
    is_upper = np.arange(len(lips.faces)) >= len(lips.faces) // 2
    nearest = refine.Embedding(lips.faces, lips.vertices, fine)
    assert is_upper[nearest.triangles].tolist() == [True, False]
    looking = refine.Embedding(
        lips.faces, lips.vertices, fine, binding=refine.Binding(normals=normals)
    )
    assert is_upper[looking.triangles].tolist() == [False, True]
    named = refine.Embedding(
        lips.faces,
        lips.vertices,
        fine,
        binding=refine.Binding(labels=([7, 9], np.where(is_upper, 9, 7))),
    )
    assert is_upper[named.triangles].tolist() == [False, True]


def test_unused_points_and_triangles_without_area_do_no_harm():
    """A point that no triangle uses may be NaN, and no point is bound to a sliver."""
    mesh = meshes.fan()
    vertices = np.vstack([mesh.vertices, [[np.nan, 0.0, 0.0]], [[2.0, 0.0, 0.0]]])
    faces = np.vstack([mesh.faces, [[0, 1, 8], [0, 1, 1]]]).astype(np.int32)
    fine = np.array([[1.5, 0.0, 0.1], [0.5, 0.0, 0.1]])
    embedding = refine.Embedding(faces, vertices, fine)
    assert (embedding.triangles < len(mesh.faces)).all()
    vertices[7] = np.inf
    assert_allclose(embedding.evaluate(vertices).positions, fine, atol=1e-12)


def test_offsets_keep_their_length_or_are_stretched():
    """On a growing surface, offsets keep their length, or on request grow with the surface."""
    mesh = meshes.ball(2)
    fine = 1.3 * mesh.vertices
    larger = 2.0 * mesh.vertices
    as_they_are = refine.Embedding(mesh.faces, mesh.vertices, fine)
    found = norm(as_they_are.evaluate(larger).positions, axis=1)
    assert_allclose(found, 2.3, atol=2e-3)
    stretched = refine.Embedding(mesh.faces, mesh.vertices, fine, stretch_offsets=True)
    assert_allclose(stretched.evaluate(larger).positions, 2.0 * fine, atol=1e-9)


def hairs():
    """A ball, its deformed shape, points of slanted hairs (roots first), and their hair numbers."""
    mesh = meshes.ball(2)
    rng = np.random.default_rng(3)
    roots = mesh.vertices[mesh.faces[::7]].mean(axis=1)
    ways = 0.1 * (roots + rng.normal(size=roots.shape))
    points = roots[:, None] + np.arange(5)[None, :, None] * ways[:, None]
    bent = turned(mesh.vertices * [1.4, 0.8, 1.0] + 0.05 * rng.normal(size=mesh.vertices.shape))
    return mesh, bent, points.reshape(-1, 3), np.repeat(np.arange(len(roots)), 5)


def test_groups_keep_their_shape_and_go_with_their_root():
    """A hair keeps its length and bend from rest; its root moves like a single bound point."""
    mesh, bent, points, hair = hairs()
    embedding = refine.Embedding(
        mesh.faces, mesh.vertices, points, binding=refine.Binding(groups=10 * hair)
    )
    assert_allclose(embedding.evaluate(mesh.vertices).positions, points, atol=1e-12)
    moved = embedding.evaluate(bent).positions.reshape(-1, 5, 3)
    at_rest = points.reshape(-1, 5, 3)
    for k in range(5):
        apart = norm(moved - moved[:, [k]], axis=2)
        assert_allclose(apart, norm(at_rest - at_rest[:, [k]], axis=2))
    alone = refine.Embedding(mesh.faces, mesh.vertices, at_rest[:, 0]).evaluate(bent)
    assert_allclose(moved[:, 0], alone.positions, atol=1e-12)


def test_given_places_replace_the_search():
    """An embedding with the places of another embedding has the same motion.

    Places are given per vertex or per group.
    """
    mesh, bent, points, hair = hairs()
    searched = refine.Embedding(mesh.faces, mesh.vertices, points)
    places = searched.triangles, searched.weights
    given_to_all = refine.Embedding(
        mesh.faces, mesh.vertices, points, binding=refine.Binding(places=places)
    )
    expected = searched.evaluate(bent).positions
    assert_array_equal(given_to_all.evaluate(bent).positions, expected)
    of_roots = searched.triangles[::5], searched.weights[::5]
    rooted = refine.Embedding(
        mesh.faces, mesh.vertices, points, binding=refine.Binding(places=of_roots, groups=hair)
    )
    assert rooted.triangles.tolist() == of_roots[0][hair].tolist()
    assert_allclose(rooted.evaluate(bent).positions[::5], expected[::5], atol=1e-12)


def test_inputs_stay_and_values_are_carried():
    """The given arrays stay unchanged.

    Values at coarse vertices are interpolated linearly in triangles.
    """
    mesh = meshes.ball(1)
    fine = around(mesh)
    before = [each.tobytes() for each in (mesh.vertices, mesh.faces, fine)]
    embedding = refine.Embedding(
        mesh.faces, mesh.vertices, fine, binding=refine.Binding(normals=fine)
    )
    embedding.evaluate(mesh.vertices)
    assert [each.tobytes() for each in (mesh.vertices, mesh.faces, fine)] == before
    assert_allclose(embedding.carry(np.ones(len(mesh.vertices))), 1.0)
    assert embedding.carry(mesh.vertices).shape == fine.shape
    for table in (embedding.triangles, embedding.weights, embedding.offsets):
        assert not table.flags.writeable


BAD_ARGUMENTS: dict[str, tuple[dict[str, Any], str]] = {
    "no points": ({"points": [[0.0, 0.0]]}, "points must be numbers of shape (N, 3)"),
    "not finite": ({"points": [[0.0, np.nan, 0.0]]}, "points must be finite"),
    "few normals": ({"normals": np.ones((3, 3))}, "normals must be numbers of shape (2, 3)"),
    "one label": ({"labels": [1, 1]}, "labels[0] must be integers of shape (2,)"),
    "few labels": ({"labels": ([1], [1])}, "labels[0] must be integers of shape (2,)"),
    "unknown label": ({"labels": ([1, 2], [1])}, "faces must have a triangle with la"),
    "no triangle": ({"faces": np.zeros((0, 3), dtype=int)}, "faces must have a triangle with an"),
    "no area": ({"faces": [[0, 1, 1]]}, "faces must have a triangle with an area"),
    "few groups": ({"groups": [1]}, "groups must be integers of shape (2,)"),
    "few places": ({"places": ([0], [[1.0, 0.0, 0.0]])}, "places must be one for each fine vertex"),
    "no such group": (
        {"places": ([0], [[1.0, 0.0, 0.0]]), "groups": [0, 1]},
        "places must be one for each group, numbered from 0: integers of shape (2,)",
    ),
    "no such triangle": (
        {"places": ([0, 1], np.full((2, 3), 1 / 3))},
        "places must be on triangles with an area, numbered below 1",
    ),
    "off the triangle": (
        {"places": ([0, 0], [[1.0, 0.0, 0.0], [1.5, -0.5, 0.0]])},
        "places must be on triangles with an area",
    ),
    "places and labels": (
        {"places": ([0, 0], np.full((2, 3), 1 / 3)), "labels": ([1, 1], [1])},
        "places and labels exclude each other",
    ),
    "an angle": ({"crease_angle": 200}, "crease_angle must be None or"),
}


@pytest.mark.parametrize(("changes", "message"), BAD_ARGUMENTS.values(), ids=BAD_ARGUMENTS)
def test_errors_say_what_is_allowed(changes, message):
    """Invalid input gives one clear message, and no embedding."""
    mesh = meshes.triangle()
    good = {"faces": mesh.faces, "rest_positions": mesh.vertices, "points": np.zeros((2, 3))}
    with pytest.raises(ValueError, match="^" + re.escape(message)):
        own = {name: changes[name] for name in changes if hasattr(refine.Binding, name)}
        others = {name: changes[name] for name in changes if name not in own}
        refine.Embedding(**{**good, **others}, binding=refine.Binding(**own))


def test_a_bad_frame_is_refused():
    """A frame with another number of vertices, or with infinite positions or NaN, is refused."""
    mesh = meshes.triangle()
    embedding = refine.Embedding(mesh.faces, mesh.vertices, np.zeros((2, 3)))
    with pytest.raises(ValueError, match="positions must be floats of shape"):
        embedding.evaluate(mesh.vertices[:2])
    with pytest.raises(ValueError, match="positions must be finite"):
        embedding.evaluate(mesh.vertices * np.nan)
    with pytest.raises(ValueError, match="values must be one for each of 3"):
        embedding.carry(np.ones(2))


def test_borders_beside_corners_are_those_of_cubic():
    """Points without offset follow the curves of the scheme `cubic`, also at corners of a rim."""
    angles = np.radians([0.0, 45.0, 90.0, 135.0, 180.0])
    rim = np.stack([np.cos(angles), np.sin(angles), np.zeros(5)], axis=1)
    rest = np.vstack([np.zeros((1, 3)), rim])
    faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]], dtype=np.uint32)
    splits = np.full(len(refine.connect(faces, 6).edges), 2)
    cubic = refine.create("kahler", faces, rest, scheme="cubic", splits=splits)
    points = cubic.refine(rest).positions.astype(np.float64)
    on_rim = points[norm(points, axis=1) > 0.95]
    assert len(on_rim) == 5 + 4 * 3
    assert np.abs(refine.Embedding(faces, rest, on_rim).offsets).max() < 1e-6
