"""Controls other than muscles: head pose, lips over an open jaw, sides, teeth, weight."""

from types import SimpleNamespace

import numpy as np
import pytest

from risorius import sim
from risorius.geometry.transforms import moved_points
from risorius.sim.skin_graph import graph_of
from tests.heads import person_of
from tests.sim.poses import lip_gap, moved_landmarks, settled_displacement, without

NOSE_TIP = 30
CHIN_LANDMARK = 8
INNER_LIPS = (62, 66)


@pytest.mark.parametrize(
    ("control", "axis", "sign"),
    [("head_pitch", 1, 1.0), ("head_yaw", 0, 1.0), ("head_roll", 0, 1.0)],
)
def test_head_turns_as_one(simulation, head, control, axis, sign):
    """Skin above the neck rotates with the cranium: upward, to the left, and tilted to the left."""
    settled_displacement(simulation, {control: 0.5})
    cranium = simulation.bones.transforms()["cranium"]
    carried = moved_points(cranium, head.vertices)
    face = head.landmarks
    assert np.abs(simulation.positions[face] - carried[face]).max() < 1e-6
    watched = face[NOSE_TIP] if control != "head_roll" else face[27]
    assert sign * (simulation.positions - head.vertices)[watched, axis] > 5.0


@pytest.mark.parametrize("number", [21, 777000145])
def test_the_end_of_a_neck_stays_in_its_collar(number):
    """Skin at the end of the neck follows the head by less than a twentieth, also at the nape.

    It rose out of the collar of persons whose chins lie low, and showed the throat from behind.
    """
    person = person_of(number)
    weights = sim.create(person).bones.head_weight
    border = graph_of(person.faces, len(person.vertices)).border
    lowest_of_face = person.vertices[person.landmarks[CHIN_LANDMARK], 1]
    end = border[person.vertices[border, 1] < lowest_of_face - 10.0]
    assert len(end) == 24
    assert weights[end].max() < 0.05
    hair_height = -90.0  # [mm]; hair at the nape ends above, and is fixed to the cranium
    is_haired = (person.vertices[:, 1] > hair_height) & (person.vertices[:, 2] < -40.0)
    assert weights[is_haired].min() > 0.85


def test_lips_stay_closed_over_an_open_jaw(simulation, head):
    """With lips_closed the lips do not part over an open jaw; without it they do."""
    for opening in (0.3, 1.0):
        moved = settled_displacement(simulation, {"jaw_open": opening, "lips_closed": 1.0})
        assert moved_landmarks(head, moved, CHIN_LANDMARK)[1] < -20.0 * opening
        assert lip_gap(simulation, head) < 0.5
    settled_displacement(simulation, {"jaw_open": 1.0})
    assert lip_gap(simulation, head) > 20.0


@pytest.mark.parametrize("opening", [0.3, pytest.param(1.0, marks=pytest.mark.slow)])
def test_mouths_that_are_open_at_rest_play(simulation, head, opening):
    """A mesh with parted lips has all controls, and its lips keep their distance."""
    opened = head.vertices + settled_displacement(simulation, {"jaw_open": opening})
    parts = without(head)
    parts.vertices = opened
    parts.layers = head.layers
    other = sim.create(parts)
    assert set(other.controls.names) == set(simulation.controls.names)
    apart = lip_gap(other, head)
    assert apart > 2.0
    moved = settled_displacement(other, {"jawOpen": 1.0, "mouthClose": 1.0})
    assert moved_landmarks(head, moved, CHIN_LANDMARK)[1] < -10.0
    assert abs(lip_gap(other, head) - apart) < 0.25 * apart + 1.0
    settled_displacement(other, {"joy": 1.0})
    assert np.isfinite(other.positions).all()


@pytest.mark.parametrize("muscle", ["procerus", "orbicularis_oris_peripheral_upper"])
def test_both_halves_are_the_whole(simulation, muscle):
    """A control for both sides does the same as both sides together.

    They add up and are clipped.
    """
    whole = settled_displacement(simulation, {muscle: 1.0})
    both = settled_displacement(simulation, {f"{muscle}_left": 1.0, f"{muscle}_right": 1.0})
    mixed = settled_displacement(
        simulation, {muscle: 0.6, f"{muscle}_left": 0.7, f"{muscle}_right": 0.4}
    )
    assert np.abs(whole).max() > 2.0
    assert np.abs(both - whole).max() < 1e-6
    assert np.abs(mixed - whole).max() < 1e-6


def test_half_an_activation_is_half_the_motion(simulation):
    """Motion is about linear in the activation, so values can be mixed."""
    for muscle in ("zygomaticus_major", "corrugator_supercilii", "risorius", "frontalis_medial"):
        full = settled_displacement(simulation, {f"{muscle}_left": 1.0})
        half = settled_displacement(simulation, {f"{muscle}_left": 0.5})
        share = (half * full).sum() / (full * full).sum()
        assert 0.43 < share < 0.57, muscle


def test_teeth_hold_the_lips_off(simulation, head):
    """Rolled lips and sucked cheeks rest on the teeth; without teeth they go deeper."""
    values = {"orbicularis_oris_roll_upper": 1.0, "orbicularis_oris_roll_lower": 1.0}
    settled_displacement(simulation, values)
    assert simulation.anatomy.penetrations()["teeth"] < 1e-6
    teeth = [part for part in head.parts if part.name.startswith("teeth_")]
    swollen = [
        SimpleNamespace(name=p.name, bone=p.bone, vertices=p.vertices * (1.0, 1.0, 1.08))
        for p in teeth
    ]
    names = ("vertices", "faces", "landmarks", "mandible_weight", "jaw_axis", "eyes", "rig")
    plain = {name: getattr(head, name) for name in names}
    faces = [SimpleNamespace(**plain, parts=parts) for parts in (swollen, [])]
    lips = [
        settled_displacement(sim.create(face), values)[head.landmarks[list(INNER_LIPS)], 2]
        for face in faces
    ]
    assert np.all(lips[0] >= lips[1] - 1e-6)
