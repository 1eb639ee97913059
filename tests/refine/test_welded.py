"""Welding: vertices at one place are refined as one, and their values are kept apart."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_array_equal

from risorius import refine
from risorius.geometry.sides import border_edges
from risorius.refine.mesh.seams import number_places
from tests import meshes
from tests.refine.cases import Forced, GivenMetric


def doubled(mesh, seed):
    """The same mesh, in which some corners have their own vertex at the same place."""
    generator = np.random.default_rng(seed)
    faces = np.array(mesh.faces, dtype=np.int64)
    own = generator.random(faces.shape) < 0.3
    points = np.concatenate([mesh.vertices, mesh.vertices[faces[own]]])
    faces[own] = len(mesh.vertices) + np.arange(np.count_nonzero(own))
    return points, faces


@settings(max_examples=50)
@given(
    name=st.sampled_from(sorted(meshes.NAMED_MESHES)),
    seed=st.integers(0, 2**16),
    options=st.sampled_from([{}, {"blend": False}, {"scheme": "loop", "criterion": "normal"}]),
)
def test_carried_as_if_bound(name, seed, options):
    """`carry` gives the same values as a refiner with these values bound at every corner."""
    mesh = meshes.NAMED_MESHES[name]()
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
    got = welded.refine(moved)
    expected = bound.refine(moved[used])
    assert_array_equal(got.positions, expected.positions)
    assert_array_equal(got.triangles, expected.triangles)
    is_proper = np.array([len(set(face)) == 3 for face in joined.tolist()])
    rows = np.unique(got.triangles[is_proper[got.source]])
    np.testing.assert_allclose(welded.carry(values)[rows], expected.uv[rows], rtol=0, atol=1e-6)


def one_triangle(**options):
    """The refiner of one triangle, after its first frame.

    Each edge is split once, or as the options state.
    """
    options = {"criterion": Forced([1, 1, 1]), "blend": False, **options}
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    refiner = refine.WeldedRefiner(points, [[0, 1, 2]], **options)
    refiner.refine(points)
    return refiner


def box():
    """A tube with four sides, each with four vertices of its own."""
    corners = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
    points = []
    faces = []
    for k in range(4):
        x, y = corners[k]
        next_x, next_y = corners[(k + 1) % 4]
        a, b, c, d = range(4 * k, 4 * k + 4)
        faces += [[a, b, c], [a, c, d]]
        points += [[x, y, 0.0], [next_x, next_y, 0.0], [next_x, next_y, 2.0], [x, y, 2.0]]
    return np.array(points), np.array(faces)


def heights_of_borders(mesh):
    """Heights of the edges that belong to one triangle only; vertices at one place count as one."""
    places, number = np.unique(mesh.positions, axis=0, return_inverse=True)
    border = border_edges(number.reshape(-1)[mesh.triangles])
    return set(places[border, 2].ravel().tolist())


@pytest.mark.parametrize("seams", [False, True])
def test_no_crack_opens_between_doubled_vertices(seams):
    """Only the two ends of the tube are open; without welding, each side stays flat."""
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
def test_types_stay(values, expected):
    """New points have the mean of both ends, rounded for integer types; types are kept."""
    refiner = one_triangle()
    carried = refiner.carry(values)
    assert carried.dtype == values.dtype
    assert_array_equal(carried[:3], values)
    assert len(carried) == 6
    assert_array_equal(carried[3:], np.array(expected, dtype=values.dtype))


@pytest.mark.parametrize("seams", [False, True])
def test_values_of_a_frame_are_its_attributes(seams):
    """The values of a frame, of any type, are its attributes, as returned by `carry`.

    A frame without values has no attributes.
    """
    points, faces = box()
    refiner = refine.WeldedRefiner(points, faces, seams=seams)
    heat = np.arange(16, dtype=np.int64) + 2**60
    mesh = refiner.refine(points * 1.5, values={"heat": heat, "place": points})
    assert set(mesh.attributes) == {"heat", "place"}
    assert_array_equal(mesh.attributes["heat"], refiner.carry(heat))
    assert mesh.attributes["heat"].dtype == np.int64
    assert_array_equal(mesh.attributes["place"], refiner.carry(points))
    assert not refiner.refine(points).attributes
    with pytest.raises(ValueError, match="3 values for a mesh of 16 points"):
        refiner.refine(points, values={"heat": [1, 2, 3]})


def test_texts_are_those_of_one_end():
    """Texts cannot be averaged, so a new point has the text of one end."""
    assert set(one_triangle().carry(["a", "b", "c"])) == {"a", "b", "c"}


def test_splits_that_stay():
    """With the splits of a clip, all frames have the same triangles, and carry the same values."""
    ball = meshes.ball()
    points = ball.vertices[ball.faces].reshape(-1, 3)  # each triangle is separate
    triangles = np.arange(len(points)).reshape(-1, 3)
    moved = [points * scale for scale in ((1.0, 1.0, 1.0), (1.0, 0.5, 1.0), (1.0, 1.0, 2.0))]
    splits = refine.splits_of_clip(refine.WeldedRefiner(points, triangles), moved)
    fixed = refine.WeldedRefiner(points, triangles, splits=splits)
    frames = []
    for each in moved:
        mesh = fixed.refine(each)
        frames.append([mesh.triangles.tobytes(), fixed.carry(points).tobytes()])
        assert (fixed.splits == splits).all()
    assert frames[0] == frames[1] == frames[2]
    assert len(splits) == len(fixed.edges) == 192


def test_mistakes_are_reported():
    """Wrong numbers of points or values, and a call before the first frame, are reported."""
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


def vase():
    """A surface of revolution; vertices of its seam are computed twice, at 0 and at 2 pi."""
    turn = np.linspace(0.0, 2.0 * np.pi, 13)
    height = np.linspace(0.0, 2.0, 7)
    turns, heights = np.meshgrid(turn, height, indexing="ij")
    radius = 0.6 + 0.25 * np.sin(3.0 * heights)
    grid = np.stack([radius * np.cos(turns), radius * np.sin(turns), heights], axis=2)
    number = np.arange(13 * 7).reshape(13, 7)
    a = number[:-1, :-1]
    b = number[1:, :-1]
    c = number[1:, 1:]
    d = number[:-1, 1:]
    first_half = np.stack([a, b, c], axis=2)
    second_half = np.stack([a, c, d], axis=2)
    faces = np.concatenate([first_half, second_half])
    return grid.reshape(-1, 3), faces.reshape(-1, 3)


@pytest.mark.parametrize("kind", [np.float64, np.float32])
@pytest.mark.parametrize("moved", [0.0, 3000.0])
def test_seams_equal_but_for_the_last_bits(kind, moved):
    """Both sides of a seam have the same normal, in single and double precision."""
    turned = np.linalg.qr(np.random.default_rng(3).random((3, 3)))[0]
    points, faces = vase()
    points = (points @ turned + moved).astype(kind)
    mesh = refine.WeldedRefiner(points, faces).refine(points)
    upright = vase()[0]
    assert heights_of_borders(refine.WeldedRefiner(upright, faces).refine(upright)) == {0, 2}
    used, joined = refine.weld(points, faces)
    assert len(used) == 12 * 7
    seam = np.flatnonzero(np.bincount(joined[:, 0], minlength=84) > 0)
    assert len(seam) > 0
    places, number = np.unique(mesh.positions, axis=0, return_inverse=True)
    assert len(places) < mesh.vertex_count
    first = np.zeros(len(places), dtype=np.int64)
    first[number.reshape(-1)] = np.arange(mesh.vertex_count)
    assert_array_equal(mesh.normals, mesh.normals[first[number.reshape(-1)]])


def test_how_far_apart_welded_vertices_may_lie():
    """The tolerance of welding is relative to the mesh's size: 1e-9 by default.

    A tolerance of 0 joins equal points only.
    """
    points, faces = box()
    size = 2.0
    for apart, tolerance, count in (
        (0.0, 0.0, 8),
        (1e-13, 0.0, 16),
        (1e-13, None, 8),
        (0.9e-9 * size, None, 8),
        (1.2e-9 * size, None, 16),
        (1.2e-9 * size, 1e-8, 8),
        (0.004 * size, 0.005, 8),
        (0.006 * size, 0.005, 16),
    ):
        shifted = points.copy()
        shifted[[1, 2, 5, 6, 9, 10, 13, 14], 0] += apart
        assert len(refine.weld(shifted, faces, tolerance=tolerance)[0]) == count
    for wrong in (-1e-9, np.nan, 1.0, "small"):
        with pytest.raises(ValueError, match="tolerance must be a number from 0 to 1"):
            refine.WeldedRefiner(points, faces, weld_tolerance=wrong)


@settings(max_examples=40)
@given(seed=st.integers(0, 2**16), distance=st.sampled_from([1e-9, 1e-4, 0.03, 0.2]))
def test_places_are_those_of_all_pairs(seed, distance):
    """Points linked by a chain of near points have one number, as brute force confirms."""
    generator = np.random.default_rng(seed)
    points = generator.random((40, 3)).round(int(generator.integers(1, 4)))
    points += distance * generator.uniform(-1.0, 1.0, points.shape)
    near = np.linalg.norm(points[:, None] - points, axis=2) <= distance
    while True:
        further = near @ near
        if (further == near).all():
            break
        near = further
    numbers = number_places(points, distance)
    assert_array_equal(numbers[:, None] == numbers, near)


WIDE_INDICES = (2**53, 2**53 + 1, 2**62 + 3)


@pytest.mark.parametrize("blend", [False, True])
@pytest.mark.parametrize(
    "values",
    [
        np.array(WIDE_INDICES, np.int64),
        -np.array(WIDE_INDICES, np.int64),
        np.array([2**64 - 1, 2**64 - 3, 1], np.uint64),
        np.array([-(2**63), 2**63 - 1, 0], np.int64),
        np.array([[7, 2**60 + 1], [9, 2**60 + 1], [5, 2**60 + 1]], ">i8"),
        np.array([np.inf, 1.0, -0.0]),
        np.array([0.1, 0.1, 0.1], np.float32),
        np.array([np.pi] * 3, np.longdouble) + np.longdouble(2) ** -60,
        np.array([1e300 + 1e300j, 1.0, np.inf]),
        np.array(["2026-11-28", "NaT", "1970-01-01"], "datetime64[D]"),
        np.array([(1, 2.5), (3, 4.5), (5, 6.5)], [("a", "i8"), ("b", "f4")]),
        np.array([{"a": 1}, None, "word"], object),
    ],
    ids=str,
)
def test_points_of_the_input_keep_their_values(values, blend):
    """Points of the input keep their values exactly, in any type.

    Values of new points lie between those of their corners, and equal values stay equal.
    """
    asks = GivenMetric([1.1, 0.9, 0.3]) if blend else Forced([2, 1, 1])
    carried = one_triangle(criterion=asks, blend=blend).carry(values)
    assert carried.dtype == values.dtype
    kept = carried[:3]
    looks_the_same = str(kept) == str(values)  # NaN and NaT equal nothing, not even themselves
    assert looks_the_same or kept.tolist() == values.tolist()
    if values.dtype.kind in "iu":
        exact = [int(value) for value in carried.ravel()]
        assert min(exact) == int(values.min())
        assert max(exact) == int(values.max())
    if values.dtype.kind == "f" and np.isfinite(values).all():
        assert (carried == values[0]).all()


def test_wide_integers_are_rounded_as_all_numbers_are():
    """The mean of wide integers is rounded to the nearest, halves to even; infinite values stay."""
    refiner = one_triangle()
    a = 2**62
    b = 2**62 + 1
    c = 2**62 + 5
    for kind in (np.int64, np.uint64):
        carried = refiner.carry(np.array([a, b, c], kind))
        assert carried[3:].tolist() == [2**62, 2**62 + 3, 2**62 + 2]
    assert refiner.carry(np.array([1, 2, 4], np.int64))[3:].tolist() == [2, 3, 2]
    assert refiner.carry(np.array([1, 2, 4], np.int32))[3:].tolist() == [2, 3, 2]
    assert refiner.carry(np.array([np.inf, 1.0, 2.0]))[3:].tolist() == [np.inf, 1.5, np.inf]
