"""Doubled vertices are one while refining; what they carry parts again, as if bound by corners."""

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from risorius import refine
from tests import meshes
from tests.refine.cases import Forced

Points = npt.NDArray[np.float64]


def doubled(mesh: meshes.Mesh, seed: int) -> tuple[Points, npt.NDArray[np.int64]]:
    """The same mesh, some corners of which have a vertex of their own at the same place."""
    generator = np.random.default_rng(seed)
    faces = np.array(mesh.faces, dtype=np.int64)
    own = generator.random(faces.shape) < 0.3
    points = np.concatenate([mesh.vertices, mesh.vertices[faces[own]]])
    faces[own] = len(mesh.vertices) + np.arange(np.count_nonzero(own))
    return points, faces


@settings(max_examples=50)
@given(
    name=st.sampled_from(sorted(meshes.NAMED)),
    seed=st.integers(0, 2**16),
    options=st.sampled_from([{}, {"blend": False}, {"scheme": "loop", "criterion": "normal"}]),
)
def test_carried_as_if_bound(name: str, seed: int, options: dict[str, Any]) -> None:
    """`carry` gives what a refiner has that was bound with the values at every corner."""
    mesh = meshes.NAMED[name]()
    points, faces = doubled(mesh, seed)
    values = np.random.default_rng(seed).random((len(points), 2))
    welded = refine.WeldedRefiner(points, faces, **options)
    used, joined = refine.weld(points, faces)
    bound = refine.create(
        "kahler",
        joined,
        points[used],
        uv=values,
        face_uv=faces,
        **{"scheme": "cubic", "criterion": "displacement+rest", **options},
    )
    moved = points * [1.0, 1.0, 0.5] + 0.2 * np.sin(3.0 * points[:, [1, 2, 0]])
    got, expected = welded.refine(moved), bound.refine(moved[used])
    np.testing.assert_array_equal(got.positions, expected.positions)
    np.testing.assert_array_equal(got.triangles, expected.triangles)
    assert expected.uv is not None
    is_proper = np.array([len(set(face)) == 3 for face in joined.tolist()])
    rows = np.unique(got.triangles[is_proper[got.source]])
    np.testing.assert_allclose(welded.carry(values)[rows], expected.uv[rows], rtol=0, atol=1e-6)


def box() -> tuple[Points, npt.NDArray[np.int64]]:
    """A tube of four sides, each with four vertices of its own."""
    corners = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
    points, faces = [], []
    for k in range(4):
        a, b = corners[k], corners[(k + 1) % 4]
        faces += [[4 * k, 4 * k + 1, 4 * k + 2], [4 * k, 4 * k + 2, 4 * k + 3]]
        points += [[*a, 0.0], [*b, 0.0], [*b, 2.0], [*a, 2.0]]
    return np.array(points), np.array(faces)


def heights_of_borders(mesh: refine.RefinedMesh) -> set[float]:
    """Heights of the sides of triangles that no other triangle has, by places in space."""
    places, number = np.unique(mesh.positions, axis=0, return_inverse=True)
    sides = number.reshape(-1)[mesh.triangles[:, [0, 1, 1, 2, 2, 0]]].reshape(-1, 2)
    sides, counts = np.unique(np.sort(sides, axis=1), axis=0, return_counts=True)
    return set(places[sides[counts == 1], 2].ravel().tolist())


@pytest.mark.parametrize("seams", [False, True])
def test_no_crack_opens_between_doubled_vertices(seams: bool) -> None:
    """Only the two ends of the tube are open; without welding each side is flat."""
    points, faces = box()
    moved = points * [1.0, 1.0, 1.5]
    mesh = refine.WeldedRefiner(points, faces, seams=seams).refine(moved)
    assert mesh.triangle_count > 8
    assert heights_of_borders(mesh) == {0.0, 3.0}
    assert len(np.unique(mesh.positions, axis=0)) < mesh.vertex_count or not seams
    assert refine.WeldedRefiner(points, faces, weld=False).refine(moved).triangle_count == 8


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        (np.array([0, 10, 20], np.uint8), [5, 15, 10]),
        (np.array([0, 1, 3], np.int64), [0, 2, 2]),
        (np.array([0.0, 1.0, np.nan]), [0.5, np.nan, np.nan]),
        (np.array([False, True, True]), [False, True, False]),
        (np.array([1j, 2j, 3j]), [1.5j, 2.5j, 2.0j]),
        (np.array([[[0.0, 4.0]], [[2.0, 6.0]], [[4.0, 8.0]]]), [[[1, 5]], [[3, 7]], [[2, 6]]]),
    ],
    ids=["bytes", "integers", "not a number", "flags", "complex", "tables"],
)
def test_types_stay(values: npt.NDArray[Any], expected: list[Any]) -> None:
    """New points have the mean of both ends, rounded where the type has no fractions."""
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    refiner = refine.WeldedRefiner(points, [[0, 1, 2]], criterion=Forced([1, 1, 1]), blend=False)
    refiner.refine(points)
    carried = refiner.carry(values)
    assert carried.dtype == values.dtype
    np.testing.assert_array_equal(carried[:3], values)
    assert len(carried) == 6
    np.testing.assert_array_equal(carried[3:], np.array(expected, dtype=values.dtype))


def test_words_come_from_an_end() -> None:
    """What is no number cannot be mixed."""
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    refiner = refine.WeldedRefiner(points, [[0, 1, 2]], criterion=Forced([1, 1, 1]), blend=False)
    refiner.refine(points)
    assert set(refiner.carry(["a", "b", "c"])) == {"a", "b", "c"}


def test_mistakes_are_told() -> None:
    """Wrong numbers of points and values, and too early a call."""
    points, faces = box()
    refiner = refine.WeldedRefiner(points, faces)
    with pytest.raises(ValueError, match="nothing is refined yet; call refine"):
        refiner.carry(np.zeros(16))
    with pytest.raises(ValueError, match=r"the 16 points .* shape \(16, 3\), got shape \(15, 3\)"):
        refiner.refine(points[1:])
    with pytest.raises(ValueError, match="3 values for a mesh of 16 points"):
        refiner.carry([1.0, 2.0, 3.0])
    with pytest.raises(ValueError, match="unknown option 'sceme'"):
        refine.WeldedRefiner(points, faces, sceme="cubic")
