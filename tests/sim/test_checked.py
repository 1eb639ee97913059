"""Public calls of `sim`: every wrong argument is a ValueError that names the allowed values."""

from operator import attrgetter
from types import SimpleNamespace

import numpy as np
import pytest

from risorius import sim
from risorius.sim.layers import read_layers
from tests.meshes import open_grid

HUGE = 10**400
NAN = float("nan")
INF = float("inf")
# Values that no call accepts as a number, an array of numbers or a name.
NONSENSE = (None, "0.5", b"1", [], [[1], [1, 2]], object(), 1j, [None], "x" * 10**6, len, {1: 2})
NO_NUMBER = (*NONSENSE, NAN, INF, -INF, HUGE, -HUGE, 10**5000, [0.5], np.array([0.5]))
COUNT = 9
MAY_BE = r"must|allowed|did you mean|see \.limits|Allowed|is lower case|leave|give|reads"
POINTS = np.zeros((2, 3))
IS_WIDER = np.finfo(np.longdouble).max > np.finfo(np.float64).max
WIDE_NUMBERS = [np.full((2, 3), np.finfo(np.longdouble).max)] if IS_WIDER else []
WRONG_ARRAYS = (  # values that are not (2, 3) finite numbers
    *NONSENSE, *WIDE_NUMBERS, 3, HUGE, np.zeros(3), np.zeros((3, 2)), np.zeros((2, 3, 1)),
    POINTS + NAN, POINTS - INF, [[HUGE] * 3] * 2, POINTS.astype(str), POINTS.astype(object),
    POINTS.astype(complex), POINTS.astype("M8[s]"),
)  # fmt: skip
WRONG_INDICES = (  # values that are not two different vertices of nine
    *NONSENSE, [0.7], [0.7, 1.0], [1, 1], [0, -1], [0, COUNT], [0, HUGE], [2**63, 1], 1, [[0, 1]],
    [True, False], [NAN, 1.0], np.array(["0", "1"]), np.array([0, 2**64 - 1], np.uint64),
)  # fmt: skip
SHARES = (
    *NONSENSE,
    [0.5],
    [0.5, 1.1],
    [-0.1, 0.5],
    [NAN, 0.5],
    [HUGE, 0.5],
    0.5,
    [[0.5], [0.5]],
)
WRONG_NAMES = (
    None,
    3,
    "",
    "nonsense",
    b"jaw_open",
    NAN,
    HUGE,
    ("jaw_open",),
    "x" * 10**6,
    "\n",
)
WRONG_TABLES = (*NONSENSE[:-1], 3, NAN, ["jaw_open"], np.zeros(3))

TRIANGLE = {"vertices": np.eye(3) * 10.0, "faces": np.array([[0, 1, 2]])}

# Method, the wrong argument, its name in the message, and its wrong values.
WRONG_ARGUMENTS = [
    ("controls.set", "name", "control", (*WRONG_NAMES, [], {})),
    ("controls.set", "value", "control 'jaw_open'", (*NO_NUMBER, -1, 2)),
    ("controls.set_all", "values", "values", WRONG_TABLES),
    ("controls.set_all", "values", "control", tuple({name: 1.0} for name in WRONG_NAMES)),
    ("controls.set_all", "values", "control 'jaw_open'", tuple({"jaw_open": v} for v in NO_NUMBER)),
    ("controls.pose", "values", "values", WRONG_TABLES),
    ("controls.pose", "values", "control 'jaw_open'", tuple({"jaw_open": v} for v in NO_NUMBER)),
    ("controls.set_array", "values", "values", WRONG_ARRAYS),
    ("copy_from", "other", "other", (*NONSENSE, 3, sim.create(SimpleNamespace(**TRIANGLE)))),
    ("touch.kick", "velocities", "velocities", WRONG_ARRAYS),
    (
        "touch.drag",
        "vertices",
        "vertices",
        WRONG_INDICES[:3] + WRONG_INDICES[4:],
    ),  # 4 alone is valid
    ("touch.drag", "targets", "targets", WRONG_ARRAYS),
    ("touch.drag", "firmness", "firmness", SHARES),
    ("step", "dt", "dt", (*NO_NUMBER, 0, -1, 1, True)),
]
RIGHT_ARGUMENTS = {
    "controls.set": {"name": "jaw_open", "value": 0.5},
    "controls.set_all": {"values": {"jaw_open": 0.5}},
    "controls.pose": {"values": {"jaw_open": 0.5}},
    "touch.drag": {"vertices": [0, 1], "targets": POINTS, "firmness": [0.5, 1.0]},
    "touch.kick": {"velocities": np.zeros((COUNT, 3))},
    "step": {"dt": 1 / 60},
}


def grid():
    """A small mesh without optional attributes."""
    mesh = open_grid(2, 2)
    return SimpleNamespace(vertices=10.0 * mesh.vertices, faces=mesh.faces)


@pytest.fixture(scope="module")
def small() -> sim.Simulation:
    """A mesh with a jaw as its only attribute."""
    mesh = grid()
    mesh.mandible_weight = np.linspace(0.0, 1.0, COUNT)
    mesh.jaw_axis = [[-10.0, 10.0, -5.0], [10.0, 10.0, -5.0]]
    return sim.create(mesh)


def refused(call, begins):
    """Check that a call raises a ValueError with the shortened wrong value and the allowed ones."""
    with pytest.raises(ValueError, match=MAY_BE) as error:
        call()
    text = str(error.value)
    assert text.startswith((begins, "there is no control called")) and len(text) < 500, text


@pytest.mark.parametrize(("method", "argument", "begins", "values"), WRONG_ARGUMENTS)
def test_wrong_arguments_are_reported(small, method, argument, begins, values):
    """A wrong argument raises a ValueError with its name, and changes nothing."""
    small.reset()
    for value in values:
        wrong = {**RIGHT_ARGUMENTS.get(method, {}), argument: value}
        refused(lambda wrong=wrong: attrgetter(method)(small)(**wrong), begins)
    assert not any(small.controls.values.values())
    small.step(1 / 60)
    assert np.array_equal(small.positions, small.rest_positions)


EYE = SimpleNamespace(name="left", centre=[0.0, 0.0, 0.0], radius=1.0)
PART = SimpleNamespace(name="teeth_upper", bone="cranium", vertices=np.zeros((2, 3)))
WRONG_LISTS = (
    *NONSENSE[1:3],
    object(),
    3,
    NAN,
    [3],
    [None],
    [[]],
)  # no lists of the expected objects


def with_(thing, name, *values):
    """Lists of one object with one wrong attribute."""
    return tuple([SimpleNamespace(**{**vars(thing), name: value})] for value in values)


def under(*keys):
    """A function that makes rigs with a wrong value at one place."""

    def rigs(*values):
        return tuple({keys[0]: {keys[1]: value}} for value in values)

    return rigs


WRONG_HEADS = [
    ("vertices", "head.vertices", (*WRONG_ARRAYS, np.zeros((0, 3)))),
    ("faces", "head.faces", NONSENSE[:3] + NONSENSE[4:]),
    ("faces", "head.faces", ([[0, 1, COUNT]], [[0, 1, -1]], [[0.0, 1, 2]], [[0, 1, HUGE]])),
    ("faces", "head.faces", ([[0, 1]], [0, 1, 2], [[NAN] * 3], [["0", "1", "2"]])),
    ("landmarks", "head.landmarks", (*NONSENSE[1:], 3, np.zeros(68), np.full(68, COUNT))),
    ("mandible_weight", "head.mandible_weight", (*NONSENSE[1:], 3, [NAN] * COUNT, [HUGE] * COUNT)),
    ("jaw_axis", "head.jaw_axis", WRONG_ARRAYS[1:]),
    ("rig", "rig", (3, "rig", b"rig", object(), [1], {"muscle": 3}, {3: 4}, {None: 1})),
    ("rig", "rig", ({"format": [1]}, {"format": HUGE}, {"format": np.ones(2)}, {"tissue": "x"})),
    ("rig", "rig, 'tissue'", under("tissue", "shear")(*NO_NUMBER)),
    ("rig", "rig, 'jaw'", under("jaw", "opening_glide")(*WRONG_ARRAYS, [HUGE] * 3)),
    ("rig", "rig, 'jaw'", under("jaw", "seeds")(3, [], {"²": 1.0}, {"9" * 5000: 1.0}, {"1": HUGE})),
    ("eyes", "head.eyes", (*WRONG_LISTS, *with_(EYE, "name", *WRONG_NAMES))),
    ("eyes", "head.eyes", with_(EYE, "centre", *NONSENSE, 3, POINTS, [NAN] * 3, [HUGE] * 3)),
    ("eyes", "head.eyes", with_(EYE, "radius", *NO_NUMBER, 0, -1)),
    ("parts", "head.parts", (*WRONG_LISTS, *with_(PART, "vertices", 3, [NAN], "x", [[HUGE] * 3]))),
]  # fmt: skip


@pytest.mark.parametrize(("attribute", "begins", "values"), WRONG_HEADS)
def test_wrong_heads_are_refused(attribute, begins, values):
    """`create` names the wrong attribute of a head."""
    for value in values:
        head = grid()
        setattr(head, attribute, value)
        refused(lambda head=head: sim.create(head), begins)


@pytest.mark.parametrize("given", WRONG_LISTS)
def test_wrong_layers_are_reported(given):
    """A head's layers must be a list of objects with titles and rows."""
    refused(lambda: read_layers(given, ["a"]), "head.layers")


@pytest.mark.parametrize("head", [None, 3, "head", [], {}, object(), SimpleNamespace(vertices=1)])
def test_heads_without_a_mesh_are_reported(head):
    """A head must have vertices and faces."""
    with pytest.raises(ValueError, match=r"head: .* has no attribute '(vertices|faces)'; give any"):
        sim.create(head)


@pytest.mark.parametrize(
    "layout",
    [
        np.asfortranarray,
        lambda array: np.repeat(array, 2, axis=0)[::2],
        lambda array: array.astype(array.dtype.newbyteorder()),
        lambda array: array.astype(np.int16),
        lambda array: array.tolist(),
    ],
)
def test_arrays_of_any_layout_are_taken(layout):
    """Arrays with any memory order, strides, byte order or integer size, and lists, are accepted.

    Results are equal.
    """
    plain = sim.create(grid())
    mesh = grid()
    mesh.vertices = layout(mesh.vertices)
    mesh.faces = layout(mesh.faces)
    other = sim.create(mesh)
    push = np.arange(3.0 * COUNT).reshape(COUNT, 3)
    rows = np.array([1, 2])
    plain.touch.kick(push)
    other.touch.kick(layout(push))
    plain.touch.drag(rows, push[:2], [1.0, 1.0])
    other.touch.drag(layout(rows), layout(push[:2]), layout(np.ones(2)))
    for each in (plain, other):
        each.step(1 / 60)
    assert np.array_equal(plain.positions, other.positions)
    assert not np.array_equal(plain.positions, plain.rest_positions)
