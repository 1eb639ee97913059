"""The tongue: it comes out between the teeth and over the lip, rises, and pierces nothing."""

import numpy as np
import pytest

from risorius import sim
from risorius.geometry.transforms import moved_points
from tests.assets.checks import part_of, winding_numbers
from tests.heads import person_of
from tests.sim.poses import FRAME_TIME, settled_displacement, without

LOWER_LIP = 66
UPPER_LIP = 62
POSES = (
    {"tongueOut": 0.3}, {"tongueOut": 0.7}, {"tongueOut": 1.0},
    {"tongue_out": 0.5, "jaw_open": 0.35}, {"tongue_out": 1.0, "jaw_open": 0.5},
    {"tongue_out": 1.0, "jaw_open": 0.3, "AU12": 0.6},
    {"tongue_up": 1.0, "jaw_open": 0.2}, {"viseme_TH": 1.0}, {"viseme_DD": 1.0},
    {"viseme_nn": 1.0}, {"tongue_out": 1.0},
)  # fmt: skip
QUICK_POSES = {"tongueOut": 1.0}, {"tongue_out": 0.5, "jaw_open": 0.35}, {"viseme_DD": 1.0}


def placed(simulation, points, bone):
    """A part's points, placed by its bone."""
    matrix = simulation.bones.transforms()[bone]
    return moved_points(matrix, points)


def tongue_now(simulation):
    """The tongue's vertices in the head's coordinates."""
    bent = simulation.anatomy.tongue()
    assert bent is not None
    return placed(simulation, bent, "mandible")


def is_within(points, vertices, faces):
    """Whether points are inside a closed surface."""
    return np.abs(winding_numbers(vertices, faces, points)) > 0.5


def with_middles(vertices, faces):
    """Vertices, and the middles of faces."""
    return np.vstack([vertices, vertices[faces].mean(axis=1)])


def test_a_resting_tongue_is_the_part(simulation, head):
    """Without its controls the tongue equals the rigid part, in any pose of the jaw."""
    settled_displacement(simulation, {"jaw_open": 0.6, "AU12": 1.0})
    bent = simulation.anatomy.tongue()
    assert bent is not None
    assert np.abs(bent - part_of(head, "tongue").vertices).max() < 1e-4


@pytest.mark.parametrize("jaw", [0.25, 0.35, 0.6])
def test_the_tongue_comes_out_over_the_lip(simulation, head, jaw):
    """The tongue comes out farther and farther, and finally hangs before the lower lip."""
    tip = part_of(head, "tongue").vertices[:, 2].argmax()
    reach = []
    for out in (0.0, 0.25, 0.5, 0.75, 1.0):
        settled_displacement(simulation, {"jaw_open": jaw, "tongue_out": out})
        reach.append(tongue_now(simulation)[:, 2].max())
    lip = simulation.positions[head.landmarks[LOWER_LIP]]
    assert np.all(np.diff(reach) > 0.3)
    assert reach[-1] > lip[2] + 2.0
    hangs = 8.0 if jaw < 0.3 else 18.0  # [mm]; a narrow mouth holds it up
    assert tongue_now(simulation)[tip, 1] < lip[1] - hangs


def test_a_tongue_that_is_out_has_a_groove(simulation, head):
    """A tongue that is out is lowest in the middle before the lip, but not at its tip."""
    tongue = part_of(head, "tongue")
    settled_displacement(simulation, {"jaw_open": 0.5, "tongue_out": 1.0})
    bent = simulation.anatomy.tongue()
    depth = tongue.vertices[:, 2].max() - tongue.vertices[:, 2]
    beside = np.abs(bent[:, 0])
    is_upper = tongue.normals[:, 1] > 0.6
    rows = is_upper & (depth > 12.0) & (depth < 16.0)
    ahead = bent[rows, 2] + bent[rows, 1]  # it hangs forward and down
    middle = ahead[beside[rows] < 1.0].mean()
    aside = ahead[(beside[rows] > 3.0) & (beside[rows] < 7.0)].mean()
    assert middle < aside - 0.7


def test_the_tongue_stays_in_a_shut_mouth(simulation, head):
    """Closed lips keep the tongue in, even over an open jaw."""
    for pose in ({"tongue_out": 1.0}, {"tongue_out": 1.0, "jawOpen": 0.5, "mouthClose": 0.5}):
        settled_displacement(simulation, pose)
        lips = simulation.positions[head.landmarks[[UPPER_LIP, LOWER_LIP]], 2]
        assert tongue_now(simulation)[:, 2].max() < lips.min() - 5.0


def test_the_tip_rises_behind_the_upper_teeth(simulation, head):
    """In t, d, n and l the tip is behind the incisors, near them, and above their edges."""
    teeth = part_of(head, "teeth_upper").vertices
    incisors = teeth[np.abs(teeth[:, 0]) < 5.0]
    tip = part_of(head, "tongue").vertices[:, 2].argmax()
    for sound in ("DD", "nn"):
        settled_displacement(simulation, {f"viseme_{sound}": 1.0})
        now = tongue_now(simulation)[tip]
        assert incisors[:, 1].min() - 2.0 < now[1] < incisors[:, 1].max()
        assert incisors[:, 2].min() - 8.0 < now[2] < incisors[:, 2].max() - 2.0


@pytest.mark.parametrize(
    "pose",
    [pytest.param(pose, marks=() if pose in QUICK_POSES else pytest.mark.slow) for pose in POSES],
    ids=str,
)
def test_the_tongue_pierces_nothing(simulation, head, pose):
    """Neither skin before the teeth nor a front tooth is inside the tongue."""
    settled_displacement(simulation, pose)
    tongue = tongue_now(simulation)
    faces = part_of(head, "tongue").faces
    skin = with_middles(simulation.positions, head.faces)
    x, y, z = skin.T
    skin = skin[(np.abs(x) < 30.0) & (z > 88.0) & (y < -40.0)]
    assert not is_within(skin, tongue, faces).any()
    for name in ("teeth_upper", "teeth_lower"):
        teeth = part_of(head, name)
        points = placed(
            simulation, with_middles(teeth.vertices.astype(float), teeth.faces), teeth.bone
        )
        front = with_middles(teeth.vertices, teeth.faces)[:, 2] > 83.0
        assert not is_within(points[front], tongue, faces).any(), name


def test_the_measure_detects_points_inside(head):
    """The measure reports the middle of the tongue as inside, and a point above as outside."""
    tongue = part_of(head, "tongue")
    points = np.array([[0.0, -77.0, 65.0], [0.0, -50.0, 65.0], [12.0, -77.0, 60.0]])
    found = is_within(points, tongue.vertices.astype(float), tongue.faces)
    assert found.tolist() == [True, False, True]


def test_the_tongue_follows_in_time(simulation):
    """The tongue needs some frames to come out, even if the lips burst open.

    Half a second after its control is 0, it is back.
    """
    simulation.controls.pose({"jaw_open": 0.4, "tongue_out": 1.0})
    before = tongue_now(simulation)
    steps = []
    for frame in range(60):
        if frame == 30:
            simulation.controls.pose({"jaw_open": 0.4})
        simulation.step(FRAME_TIME)
        now = tongue_now(simulation)
        steps.append(np.linalg.norm(now - before, axis=1).max())
        before = now
    assert max(steps) < 40.0
    assert steps[-1] < 0.1


def test_a_head_without_a_tongue_has_the_controls_all_the_same(head):
    """A head without a tongue has its controls, because tables name them, and draws nothing."""
    bare = sim.create(without(head))
    bare.controls.pose({"tongue_out": 1.0})
    bare.step(FRAME_TIME)
    assert bare.anatomy.tongue() is None


@pytest.mark.parametrize("number", [5, 6])
@pytest.mark.parametrize(("control", "least"), [("tongueOut", 25.0), ("viseme_TH", 8.0)])
def test_the_tongue_of_a_small_mouth_comes_out(number, control, least):
    """The jaw opens far enough for the tongue, which once stayed behind these persons' teeth.

    least: how far the tip comes forward, with the way down over the lip [mm].
    """
    simulation = sim.create(person_of(number))
    before = tongue_now(simulation)
    tip = before[:, 2].argmax()
    settled_displacement(simulation, {control: 1.0})
    assert np.linalg.norm(tongue_now(simulation)[tip] - before[tip]) > least
