"""Points that no triangle uses change no triangle, wherever they are."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from risorius import refine
from tests import meshes

STRAY_POINTS = {
    "far": [900.0, -700.0, 40.0],
    "very far": [1e14, 0.0, 0.0],
    "too far": [1e200, 1.0, -1e20],
    "not a number": [np.nan, 0.0, 0.0],
    "infinite": [0.0, -np.inf, np.inf],
}
REFINERS = [
    ("none", {}),
    ("loop", {"levels": 2}),
    ("kahler", {}),
    ("kahler", {"normals": "refined", "criterion": "displacement+rest"}),
    ("kahler", {"scheme": "cubic", "criterion": "displacement+rest"}),
    ("kahler", {"scheme": "cubic", "criterion": "silhouette+rest", "coherent": True}),
]
EYE = refine.View([5.0, 6.0, 30.0])


def with_strays(points, faces, place):
    """The same mesh with unused points before the first point, among the others and at the end."""
    where = [0, 0, 3, len(points)]
    number = np.insert(np.arange(len(points)), where, -1)
    renamed = np.empty(len(points), dtype=np.int64)
    renamed[number[number >= 0]] = np.flatnonzero(number >= 0)
    return np.insert(points, where, place, axis=0), renamed[faces]


@pytest.mark.parametrize(("name", "options"), REFINERS)
@pytest.mark.parametrize("stray", STRAY_POINTS)
def test_triangles_are_the_same(name, options, stray):
    """Triangles are equal to the last bit, at rest and in frames, and all output is finite."""
    mesh = meshes.irregular(4)
    bent = meshes.wrinkled(mesh, 5)
    faces = mesh.faces.astype(np.int64)
    plain = refine.create(name, faces, mesh.vertices, **options)
    expected = plain.refine(bent, view=EYE)
    rest, renamed = with_strays(mesh.vertices, faces, STRAY_POINTS[stray])
    frame, _ = with_strays(bent, faces, STRAY_POINTS[stray])
    refiner = refine.create(name, renamed, rest, **options)
    found = refiner.refine(frame, view=EYE)
    assert_array_equal(found.positions[found.triangles], expected.positions[expected.triangles])
    assert_array_equal(found.normals[found.triangles], expected.normals[expected.triangles])
    assert_array_equal(refiner.splits, plain.splits)
    assert np.isfinite(found.positions).all()
    refine.check(refiner, found, frame)


@pytest.mark.parametrize("stray", STRAY_POINTS)
def test_welded_and_measured(stray):
    """Welding, detail and strain ignore unused points."""
    mesh = meshes.irregular(4)
    faces = mesh.faces.astype(np.int64)
    rest, renamed = with_strays(mesh.vertices, faces, STRAY_POINTS[stray])
    count = refine.WeldedRefiner(mesh.vertices, faces).refine(mesh.vertices).triangle_count
    assert refine.WeldedRefiner(rest, renamed).refine(rest).triangle_count == count
    scheme = refine.DetailScheme((rest, renamed))
    assert refine.create("kahler", faces, mesh.vertices, scheme=scheme).refine(mesh.vertices)
    along = np.ones((len(rest), 1, 3))
    assert np.isfinite(refine.Shortening(renamed, rest, along).measure(rest)).all()


def test_points_of_triangles_are_still_looked_at():
    """A used point must be a finite number; the error names only used points."""
    mesh = meshes.irregular(4)
    rest, renamed = with_strays(
        mesh.vertices, mesh.faces.astype(np.int64), STRAY_POINTS["not a number"]
    )
    refiner = refine.create("kahler", renamed, rest)
    broken = rest.copy()
    broken[renamed[7, 1], 1] = np.nan
    with pytest.raises(ValueError, match=rf"vertex {renamed[7, 1]} .* \(1 such vertices in all\)"):
        refiner.refine(broken)
    with pytest.raises(ValueError, match=rf"vertex {renamed[7, 1]} .* \(1 such vertices in all\)"):
        refine.create("kahler", renamed, broken)


def test_a_stray_twin_moves_nothing():
    """An unused point at the place of a vertex is not welded with the vertex."""
    mesh = meshes.irregular(4)
    faces = mesh.faces.astype(np.int64)
    twin = np.concatenate([mesh.vertices[faces[:1, 0]], mesh.vertices])
    refiner = refine.WeldedRefiner(twin, faces + 1)
    frame = np.concatenate([[[np.nan] * 3], meshes.wrinkled(mesh, 5)])
    found = refiner.refine(frame)
    expected = refine.WeldedRefiner(mesh.vertices, faces).refine(frame[1:])
    assert_array_equal(found.positions[found.triangles], expected.positions[expected.triangles])
