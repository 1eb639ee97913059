"""Attributes of any width are interpolated; inputs of any type and order are accepted."""

import itertools

import numpy as np
import pytest

from risorius import refine
from risorius.refine.border.corner_values import _different_rows
from tests import meshes
from tests.refine.cases import (
    GivenMetric,
    edge_count_of,
    kahler,
    places_in_source,
    scheme_of,
    sound_frame,
)

REFINERS = [
    ("none", {}),
    ("loop", {"levels": 2}),
    ("kahler", {}),
    ("kahler", {"scheme": "cubic"}),
    ("kahler", {"blend": True}),
]


@pytest.mark.parametrize(("name", "options"), REFINERS)
def test_attributes_are_linear(name, options):
    """An attribute is linear in each triangle, on both sides of seams."""
    tube = meshes.tube(10, 6)
    assert tube.face_uv is not None
    deformed = meshes.wrinkled(tube, 3, 0.3)
    generator = np.random.default_rng(4)
    colours = generator.random((len(tube.vertices), 4))
    corner_rows = generator.integers(5, size=tube.faces.shape)
    parts = generator.random((5, 1))
    refiner = refine.create(
        name,
        tube.faces,
        tube.vertices,
        uv=tube.uv,
        face_uv=tube.face_uv,
        attributes={"colour": colours, "part": (parts, corner_rows)},
        **options,
    )
    refined = sound_frame(refiner, deformed)
    assert refiner.vertex_columns == 6 + 2 + 4 + 1
    assert refined.uv is not None
    places = places_in_source(refiner.origins(), refined.triangles, tube.faces[refined.source])
    for values, found in (
        (tube.uv[tube.face_uv], refined.uv),
        (colours[tube.faces], refined.attributes["colour"]),
        (parts[corner_rows], refined.attributes["part"]),
    ):
        expected = np.einsum("tci,tiu->tcu", places, values[refined.source])
        np.testing.assert_allclose(found[refined.triangles], expected, rtol=0, atol=1e-6)


@pytest.mark.parametrize("scheme", ["loop", "cubic", "detail"])
def test_any_type_and_order(scheme):
    """float32 or float64, C or Fortran order, strides, int32 or int64 all give the same frame."""
    mesh = meshes.irregular(6)
    rest = mesh.vertices.astype(np.float32)
    deformed = meshes.wrinkled(mesh, 7).astype(np.float32)
    expected = None
    orders = (np.ascontiguousarray, np.asfortranarray, lambda a: np.repeat(a, 2, axis=0)[::2])
    kinds = itertools.product((np.float32, np.float64), (np.int32, np.int64, np.uint16), orders)
    for number, index, order in kinds:
        refiner = refine.create(
            "kahler",
            order(mesh.faces.astype(index)),
            order(rest.astype(number)),
            scheme=scheme_of(scheme, rest, mesh.faces),
        )
        frame = [a.tobytes() for a in refiner.refine(order(deformed.astype(number)))[:4]]
        expected = expected or frame
        assert frame == expected


def room(mesh):
    """Bytes of the arrays that hold a frame."""
    arrays = [part.base for part in (mesh.positions, mesh.triangles, mesh.source)]
    return sum(array.nbytes for array in arrays if array is not None)


@pytest.mark.parametrize("blend", [False, True])
def test_own_stream_grows(blend):
    """A refiner's own stream has room for its frames, not for the worst case, and never shrinks."""
    mesh = meshes.irregular(8, 30, 30)
    edge_count = edge_count_of(mesh)
    needed = GivenMetric(np.full(edge_count, -1.0))
    refiner = kahler(mesh, criterion=needed, blend=blend)
    unsplit = room(refiner.refine(mesh.vertices))
    assert unsplit < 1.5 * (24 * len(mesh.vertices) + 16 * len(mesh.faces))
    needed.metric[:] = 2.0
    all_split = sound_frame(refiner, mesh.vertices)
    assert len(all_split.triangles) == refiner.triangle_capacity
    most = room(all_split)
    assert most > 5 * unsplit
    rows = all_split.positions.base
    assert rows is not None and len(rows) == refiner.vertex_capacity  # no unused room
    needed.metric[:] = -1.0
    none_split = sound_frame(refiner, mesh.vertices)
    assert room(none_split) == most


@pytest.mark.parametrize("name", ["none", "loop", "kahler"])
def test_values_of_corners_where_there_is_no_triangle(name):
    """Values given at corners are zero at all vertices of a mesh without triangles."""
    nothing = np.zeros((0, 3), int)
    refiner = refine.create(name, nothing, np.eye(3), uv=np.ones((4, 2)), face_uv=nothing)
    mesh = refiner.refine(np.eye(3))
    assert mesh.uv is not None
    np.testing.assert_array_equal(mesh.uv, np.zeros((3, 2)))


def test_different_rows_are_those_of_numpy(generator):
    """Rows of corners are numbered as `np.unique` numbers them, for one to four attributes."""
    for columns, count in itertools.product((1, 2, 4), (1, 50, 2000)):
        rows = generator.integers(0, 1 + count // 3, (count, columns))
        different, number = np.unique(rows, axis=0, return_inverse=True)
        found = _different_rows(rows)
        assert (found[0] == different).all()
        assert (found[1] == number.reshape(-1)).all()
