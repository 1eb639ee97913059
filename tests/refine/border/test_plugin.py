"""The registry, binding errors, and an external refiner."""

from __future__ import annotations

import copy
import pickle
from functools import partial

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from risorius import refine
from risorius.refine.kahler.smoothing import LoopScheme
from tests import meshes
from tests.refine.cases import kahler, sound_frame

GOOD_MESH = meshes.octahedron()


class Outside:
    """The smallest external refiner: it follows the protocol, without the project's base class."""

    vertex_columns = 6

    def __init__(
        self,
        faces: np.ndarray,
        rest_positions: np.ndarray,
        *,
        uv: object = None,
        face_uv: object = None,
        offset: float = 0.0,
    ) -> None:
        self.faces = np.asarray(faces, dtype=np.uint32)
        connectivity = refine.connect(faces, len(rest_positions))
        self.edges = connectivity.edges
        self.triangle_edges = connectivity.triangle_edges
        self.splits = np.zeros(len(self.edges), dtype=np.uint8)
        self.vertex_capacity = len(rest_positions)
        self.triangle_capacity = len(faces)
        self.offset = offset

    def refine(self, positions: np.ndarray, out: refine.Stream | None = None) -> refine.RefinedMesh:
        """Return the mesh without normals."""
        points = (positions + self.offset).astype(np.float32)
        source = np.arange(len(self.faces), dtype=np.int32)
        return refine.RefinedMesh(points, np.zeros_like(points), self.faces, source, None)

    def origins(self) -> refine.Origins:
        """Every output vertex is the input vertex with the same number."""
        numbers = np.arange(self.vertex_capacity, dtype=np.int32)
        weights = np.tile(np.array([[1, 0, 0]], dtype=np.float32), (len(numbers), 1))
        return refine.Origins(np.stack([numbers] * 3, axis=1), weights)


@pytest.mark.usefixtures("own_refiners")
def test_registered_refiner():
    """A registered refiner is created by name with its options, and passes the checker."""
    refine.refiners.register("outside", Outside)
    assert "outside" in refine.refiners.available()
    refiner = refine.create("outside", GOOD_MESH.faces, GOOD_MESH.vertices, offset=0.0)
    assert isinstance(refiner, refine.Refiner)
    sound_frame(refiner, GOOD_MESH.vertices)
    moved = refine.create("outside", GOOD_MESH.faces, GOOD_MESH.vertices, offset=0.5)
    with pytest.raises(refine.BrokenMeshError, match="to the last bit"):
        sound_frame(moved, GOOD_MESH.vertices)


@pytest.mark.usefixtures("own_refiners")
@pytest.mark.parametrize(
    ("name", "factory", "text"),
    [
        ("kahler", Outside, "named 'kahler' exists already; taken are"),
        ("", Outside, "must be a word without .*, got ''"),
        (3, Outside, "must be a word without .*, got 3"),
        ("a+b", Outside, "must be a word without .*, got 'a.b'"),
        ("broken", 7, "must be callable, got 7"),
    ],
)
def test_bad_registration(name, factory, text):
    """Names cannot be registered twice, and factories must be callable."""
    with pytest.raises(ValueError, match=text):
        refine.refiners.register(name, factory)


def test_unknown_name():
    """The error lists the known names."""
    with pytest.raises(ValueError, match=r"refiner 'khaler' is unknown; there are .*'kahler'"):
        refine.create("khaler", GOOD_MESH.faces, GOOD_MESH.vertices)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        (
            "kahler",
            r"it takes \['attributes', 'blend', 'coherent', 'crease_angle', 'criterion', "
            "'normals', 'scheme', 's",
        ),
        ("loop", r"it takes \['attributes', 'crease_angle', 'levels'\]"),
        ("none", r"it takes \['attributes', 'crease_angle'\]"),
    ],
)
def test_unknown_option(name, text):
    """The error lists the known options."""
    with pytest.raises(ValueError, match=f"unknown option 'treshold' for refiner '{name}'; {text}"):
        refine.create(name, GOOD_MESH.faces, GOOD_MESH.vertices, treshold=0.1)


NAN_VERTICES = GOOD_MESH.vertices.copy()
NAN_VERTICES[4, 1] = np.nan


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"faces": GOOD_MESH.faces[:, :2]}, r"faces must be integers of shape \(F, 3\), got int32"),
        ({"faces": GOOD_MESH.faces.astype(float)}, "faces must be integers .* got float64"),
        (
            {"faces": GOOD_MESH.faces + 1},
            r"indices from 0 to 5 into rest_positions, but triangle 4 is",
        ),
        ({"faces": [[0, 1, 2, 3]]}, "cut polygons into triangles"),
        ({"rest_positions": GOOD_MESH.vertices[:, :2]}, r"numbers of shape \(V, 3\), got float64"),
        ({"faces": [[0, 1, 2], [0, 1]]}, "faces must be integers .* is not an array"),
        ({"faces": [[0, 1, 2**70]]}, "faces must be integers"),
        ({"faces": np.ma.masked_equal(GOOD_MESH.faces, 3)}, "faces .* has masked entries"),
        ({"rest_positions": NAN_VERTICES}, "must be finite and below 1e.15, but vertex 4 is"),
        ({"rest_positions": GOOD_MESH.vertices * 1e16}, "must be finite and below 1e.15"),
        (
            {"rest_positions": GOOD_MESH.vertices * 1e9},
            "must extend over 1e-06 to 1e.09 .* over 2e.09",
        ),
        ({"rest_positions": np.ma.masked_equal(GOOD_MESH.vertices, 1.0)}, "has masked entries"),
        ({"rest_positions": GOOD_MESH.vertices.astype(str)}, "rest_positions must be numbers"),
        ({"face_uv": GOOD_MESH.faces}, "face_uv points into uv, but uv is None"),
        ({"uv": np.zeros((6, 3))}, r"uv must be numbers of shape \(U, 2\)"),
        ({"uv": np.zeros((5, 2))}, "needs one row per vertex"),
        ({"uv": np.full((6, 2), np.inf)}, "uv must be finite as single precision, but row 0"),
        ({"attributes": [GOOD_MESH.vertices]}, "attributes must be arrays by name, .* got list"),
        (
            {"attributes": {"a": [GOOD_MESH.vertices, GOOD_MESH.faces]}},
            "a tuple of such values and the row",
        ),
        (
            {"attributes": {"a": np.zeros(6)}},
            r"attributes\['a'\] must be numbers of shape \(V, k\)",
        ),
        ({"attributes": {"a": np.zeros((5, 2))}}, "needs one row per vertex .6., got 5"),
        ({"attributes": {"a": np.full((6, 1), np.nan)}}, "must be finite"),
        (
            {"attributes": {"a": (np.eye(3), GOOD_MESH.faces)}},
            "indices from 0 to 2 into attributes",
        ),
        (
            {"attributes": {"a": (np.eye(6), GOOD_MESH.faces[:7])}},
            "one row per triangle .8., got 7",
        ),
        (
            {"uv": np.zeros((3, 2)), "face_uv": GOOD_MESH.faces},
            "face_uv must hold indices from 0 to 2",
        ),
    ],
)
@pytest.mark.parametrize("name", ["none", "kahler", "loop"])
def test_bad_binding(name, changes, text):
    """Arrays that do not fit together are refused.

    The error names the fault, its place, and the allowed values.
    """
    arguments = {"faces": GOOD_MESH.faces, "rest_positions": GOOD_MESH.vertices}
    arguments |= changes
    with pytest.raises(ValueError, match=text):
        refine.create(name, **arguments)


@pytest.mark.parametrize("name", ["none", "kahler", "loop"])
def test_binding_copies(name):
    """Later changes of the bound arrays have no effect, and binding changes no array."""
    faces = GOOD_MESH.faces.copy()
    rest = GOOD_MESH.vertices.copy()
    refiner = refine.create(name, faces, rest)
    deformed = GOOD_MESH.vertices * 1.5
    expected = refiner.refine(deformed).positions.copy()
    faces[:] = 0
    rest[:] = 7.0
    assert (refiner.refine(deformed).positions == expected).all()
    assert (deformed == GOOD_MESH.vertices * 1.5).all()


@pytest.mark.parametrize("name", ["none", "kahler", "loop"])
def test_splits_cannot_be_written(name):
    """The splits of the last frame are read-only."""
    refiner = refine.create(name, GOOD_MESH.faces, GOOD_MESH.vertices)
    assert refiner.splits.dtype == np.uint8
    assert refiner.splits.shape == (12,)
    with pytest.raises(ValueError, match="read-only"):
        refiner.splits[0] = 1


@pytest.mark.parametrize("name", ["none", "kahler", "loop"])
@pytest.mark.parametrize("faces", [[], (), np.zeros((0, 3), dtype=int)])
def test_no_triangles_in_none_out(name, faces):
    """A mesh without triangles gives none.

    An empty list, which has no second dimension, is accepted.
    """
    refiner = refine.create(name, faces, GOOD_MESH.vertices)
    assert len(refiner.refine(GOOD_MESH.vertices).triangles) == 0


@pytest.mark.parametrize("scheme", ["loop", "cubic"])
@pytest.mark.parametrize("unit", [1e-6, 5e7])
def test_units_of_length(unit, scheme):
    """Any unit of length within the limits of binding gives the same triangles."""
    grid = meshes.irregular(3)
    deformed = meshes.wrinkled(grid, 4)

    def refined(scale: float) -> refine.RefinedMesh:
        refiner = refine.create("kahler", grid.faces, scale * grid.vertices, scheme=scheme)
        return refiner.refine(scale * deformed)

    here = refined(1.0)
    there = refined(unit)
    assert_array_equal(there.triangles, here.triangles)
    assert_allclose(there.positions / unit, here.positions, atol=1e-5)
    assert_allclose(there.normals, here.normals, atol=1e-3)


def test_frames_can_be_kept():
    """Deep copies and pickles of a frame have their own arrays, which no later frame changes."""
    refiner = kahler(GOOD_MESH, attributes={"rest": GOOD_MESH.vertices}, threshold_once=0.0)
    refined = refiner.refine(GOOD_MESH.vertices * [1.0, 1.0, 4.0])
    kept = [copy.deepcopy(refined), pickle.loads(pickle.dumps(refined))]
    expected = refined.positions.copy(), refined.attributes["rest"].copy()
    refiner.refine(GOOD_MESH.vertices)
    for mesh in kept:
        assert isinstance(mesh, refine.RefinedMesh)
        assert_array_equal(mesh.positions, expected[0])
        assert_array_equal(mesh.attributes["rest"], expected[1])


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"threshold_once": "a"}, "threshold_once was a, must be a number, 0 or more"),
        ({"threshold_twice": True}, "threshold_twice was True, must be a number, 0 or more"),
        ({"blend": "no"}, r"blend was no, must be on or off \(True or False\)"),
        ({"coherent": "no"}, r"coherent was no, must be on or off \(True or False\)"),
        ({"criterion": refine.Silhouette}, "a name, a refine.Criterion, .*Silhouette"),
        ({"scheme": LoopScheme}, "scheme must be one of .*LoopScheme"),
        ({"threshold_once": -0.1}, "threshold_once was -0.1, must be a number, 0 or more"),
        ({"threshold_once": 0.3, "threshold_twice": 0.2}, "0 <= threshold_once <= threshold_twice"),
        ({"threshold_once": np.nan}, "threshold_once was nan, must be a number, 0 or more"),
        ({"criterion": "bending"}, r"'bending' is unknown; there are \('normal', 'rest'"),
        ({"criterion": "normal+"}, "criterion '' is unknown; there are"),
        ({"criterion": []}, "an empty list decides nothing"),
        ({"criterion": 7}, "criterion was 7, must be a word"),
        ({"scheme": "lop"}, "scheme 'lop' is unknown; there are"),
        ({"scheme": 3}, "scheme was 3, must be a word"),
        ({"scheme": "detail"}, r"detail needs a finer mesh: pass scheme=.* got NoneType"),
        ({"blend": True, "coherent": True}, "set one of the two"),
    ],
)
def test_bad_options(options, text):
    """Options of a wrong type, unknown or contradictory, are refused.

    The error names right values.
    """
    with pytest.raises(ValueError, match=text):
        kahler(GOOD_MESH, **options)


@pytest.mark.parametrize("name", ["criterion", "scheme"])
def test_an_object_serves_one_refiner(name):
    """A criterion or scheme that one refiner uses is refused by another, alone or in a list."""
    thing = refine.Displacement() if name == "criterion" else LoopScheme()
    create = partial(
        refine.create, "kahler", GOOD_MESH.faces, GOOD_MESH.vertices, normals="refined"
    )
    first = create(**{name: thing})
    for shared in (thing, [thing, "normal"])[: 2 if name == "criterion" else 1]:
        with pytest.raises(ValueError, match=r"serves another refiner already; make one for each"):
            create(**{name: shared})
    first.refine(GOOD_MESH.vertices)  # the refused call left it unchanged
    del first
    create(**{name: thing})
