"""Muscles and expressions move the right parts: landmarks, lids, lips, jaw."""

import numpy as np
import pytest
from numpy.linalg import norm

from risorius import refine, sim
from risorius.bench.gaps import eyeballs_of, lid_gaps, meshes_of
from risorius.geometry.transforms import moved_points
from risorius.refine.mesh.creases import dihedral_angles
from risorius.sim.contact import PRESSED_OVERLAP
from risorius.sim.face_model import build_face_model
from tests.heads import person_of
from tests.sim.poses import (
    FRAME_TIME,
    both_sides,
    inverted_triangles,
    lip_gap,
    moved_landmarks,
    settled_displacement,
)

BASIC_EXPRESSIONS = ("joy", "sadness", "surprise", "anger", "disgust", "fear")
OTHER_EXPRESSIONS = ("contempt", "wink", "kiss", "yawn", "mouth_open", "blink")


@pytest.mark.parametrize(
    ("muscle", "landmark", "direction", "least"),
    [
        ("frontalis_medial", 22, (0.0, 1.0, 0.0), 3.0),
        ("frontalis_lateral", 25, (0.0, 1.0, 0.0), 4.0),
        ("corrugator_supercilii", 23, (-0.7, -0.7, 0.0), 2.0),
        ("levator_labii_superioris_alaeque_nasi", 35, (0.0, 1.0, 0.0), 3.0),
        ("levator_labii_superioris", 52, (0.0, 1.0, 0.0), 3.0),
        ("zygomaticus_major", 54, (0.6, 0.6, -0.5), 8.0),
        ("levator_anguli_oris", 54, (0.0, 1.0, 0.0), 4.0),
        ("risorius", 54, (0.9, 0.0, -0.4), 5.0),
        ("buccinator", 54, (0.4, 0.0, -0.9), 2.0),
        ("depressor_anguli_oris", 54, (0.0, -1.0, 0.0), 3.0),
        ("platysma_bands", 54, (0.4, -0.9, -0.2), 2.0),  # once 0: only the neck moved
        ("depressor_labii_inferioris", 56, (0.0, -1.0, 0.0), 3.0),
        ("mentalis", 57, (0.0, 1.0, 0.0), 3.0),
        ("incisivus_labii_superioris", 54, (-1.0, 0.0, 0.2), 1.0),
        ("orbicularis_oris_peripheral_lower", 57, (0.0, -0.5, 0.8), 2.0),
    ],
)
def test_muscle_pulls_its_landmark(simulation, head, muscle, landmark, direction, least):
    """Each muscle at full strength moves its insertion by the listed distance and direction."""
    moved = settled_displacement(simulation, both_sides(simulation, {muscle: 1.0}))
    way = np.array(direction) / norm(direction)
    assert moved_landmarks(head, moved, landmark) @ way > least


UPWARD = np.array([0.0, 1.0, 0.0])
LEFTWARD = np.array([1.0, 0.0, 0.0])
EXPRESSED_MOTIONS = {  # landmarks, their direction, and their least motion [mm]
    "joy": [
        ((54,), UPWARD, 5.0),
        ((48,), UPWARD, 5.0),
        ((54,), LEFTWARD, 3.0),
        ((48,), -LEFTWARD, 3.0),
    ],
    "sadness": [((48, 54), -UPWARD, 2.0)],
    "surprise": [
        ((18, 19, 20, 23, 24, 25), UPWARD, 4.0),
        ((37, 38, 43, 44), UPWARD, 1.0),
        ((8,), -UPWARD, 12.0),
    ],
    "anger": [((21, 22), -UPWARD, 3.0), ((22,), -LEFTWARD, 0.5)],
    "disgust": [((31, 35), UPWARD, 3.0), ((50, 52), UPWARD, 3.0)],
    # In fear the brow rises with the raised fold below it, which else is a dark shelf.
    "fear": [
        ((19, 24), UPWARD, 4.5),
        ((21, 22), UPWARD, 2.0),
        ((43, 44), UPWARD, 1.0),
        ((54,), LEFTWARD, 2.0),
    ],
}


@pytest.mark.parametrize("name", EXPRESSED_MOTIONS)
def test_expressions_move_their_landmarks(simulation, head, name):
    """In each expression brows, lids, mouth corners, lips and jaw move in its direction."""
    moved = settled_displacement(simulation, head.expressions[name])
    for landmarks, way, least in EXPRESSED_MOTIONS[name]:
        assert moved_landmarks(head, moved, *landmarks) @ way > least, landmarks


def test_the_base_of_the_nose_hardly_lifts(simulation, head):
    """The base of the nose hardly rises in a sneer or under a raised lip.

    Cartilage holds it, while wings and lip rise beside it. In a scanned sneer wings rise by 7.5 mm.
    Under a raised lip they rise less than the lip: they rose as far, and nostrils opened upward.
    """
    heights = (("noseSneer", 2.5, 7.0, 8.0), ("mouthUpperUp", 1.6, 2.0, 3.3))
    for shape, most, least_of_wings, most_of_wings in heights:
        values = {f"{shape}Left": 1.0, f"{shape}Right": 1.0}
        moved = settled_displacement(simulation, values)
        assert 0.0 < moved_landmarks(head, moved, 33)[1] < most, shape
        assert 0.0 < moved_landmarks(head, moved, 30)[1] < most, shape
        assert least_of_wings < moved_landmarks(head, moved, 31, 35)[1] < most_of_wings, shape
        assert moved_landmarks(head, moved, 51)[1] > 4.5, shape


def test_an_upper_lip_is_shrugged_up_and_rolled_back(simulation, head):
    """A shrugged upper lip moves up more than forward; a rolled one back, without the chin."""
    moved = settled_displacement(simulation, {"mouthShrugUpper": 1.0})
    _, up, forward = moved_landmarks(head, moved, 51)
    assert max(2.0, forward) < up < 7.0
    moved = settled_displacement(simulation, {"mouthRollUpper": 1.0})
    assert -13.0 < moved_landmarks(head, moved, 51)[2] < -5.0
    assert norm(moved_landmarks(head, moved, 8)) < 0.5


def test_a_frown_and_a_funnel_go_as_far_as_scanned_ones(simulation, head):
    """In a frown, corners move down and little sideways, as far as scanned ones.

    In a funnel, lips come 7 mm forward and open, as in a scan.
    """
    moved = settled_displacement(simulation, {"mouthFrownLeft": 1.0, "mouthFrownRight": 1.0})
    aside, up, _ = moved_landmarks(head, moved, 54)
    assert up < -3.5
    assert 0.0 < aside < -0.7 * up
    moved = settled_displacement(simulation, {"mouthFunnel": 1.0})
    assert 5.0 < moved_landmarks(head, moved, 51)[2] < 9.5
    assert 2.0 < -moved_landmarks(head, moved, 54)[0] < 5.0
    assert moved_landmarks(head, moved, 62)[1] - moved_landmarks(head, moved, 66)[1] > 6.0


def test_a_funnel_opens_round(simulation, head):
    """In a funnel, lips part two thirds as far beside the middle as in the middle.

    A half is the straight side of a diamond, as it was once.
    """
    moved = settled_displacement(simulation, {"mouthFunnel": 1.0})
    heights = (head.vertices + moved)[head.landmarks, 1]
    middle = heights[62] - heights[66]
    for upper, lower in ((61, 67), (63, 65)):
        assert 0.62 < (heights[upper] - heights[lower]) / middle < 0.9


@pytest.mark.parametrize("name", ["mouthLeft", "mouthRight"])
def test_lips_that_move_sideways_leave_no_crack_below_the_nose(simulation, head, name):
    """No triangle within 12 mm of the base of the nose turns over; the lip moves by 8 mm."""
    moved = settled_displacement(simulation, {name: 1.0})
    base = head.vertices[head.landmarks[33]]
    is_near = norm(head.vertices - base, axis=1) < 12.0
    near = head.faces[is_near[head.faces].all(axis=1)]
    assert len(near) > 20
    assert inverted_triangles(near, head.vertices, simulation.positions) == 0
    assert abs(moved_landmarks(head, moved, 51)[0]) > 8.0


def test_lips_that_move_sideways_fold_no_chin():
    """In `mouthLeft` no edge of this person's chin bends by 20 degrees; by 33 was a furrow."""
    person = person_of(19)
    simulation = sim.Simulation(build_face_model(person))
    moved = person.vertices + settled_displacement(simulation, {"mouthLeft": 1.0})
    marks = person.vertices[person.landmarks]
    refiner = refine.create("kahler", person.faces, person.vertices)
    x, y, z = person.vertices[refiner.edges].mean(axis=1).T
    lower_lip = marks[57]
    chin = marks[8]
    is_chin = (y < lower_lip[1] - 4.0) & (y > chin[1] - 4.0)
    is_chin &= (np.abs(x) < 40.0) & (z > chin[2] - 30.0)
    resting, bent = (
        dihedral_angles(refiner.connectivity, each) for each in (person.vertices, moved)
    )
    assert is_chin.sum() > 80
    assert np.degrees((bent - resting)[is_chin].max()) < 20.0


def test_rounded_lips_leave_the_sills_of_nostrils():
    """Skin beside the base of the nose turns by less than a right angle on a short upper lip."""
    woman = person_of(18)
    simulation = sim.Simulation(build_face_model(woman))
    moved = settled_displacement(simulation, {"AU18": 1.0, "AU22": 0.1, "AU26": 0.11})
    away = woman.vertices - woman.vertices[woman.landmarks[33]]
    is_sill = (np.abs(np.abs(away[:, 0]) - 4.5) < 2.0) & (norm(away, axis=1) < 8.5)
    sills = woman.faces[is_sill[woman.faces].all(axis=1)]
    assert len(sills) >= 4
    assert inverted_triangles(sills, woman.vertices, woman.vertices + moved) == 0


def test_lids_follow_the_gaze_up_a_little(simulation, head):
    """When eyes look up, lids rise by more than 1 and less than 2 mm."""
    moved = settled_displacement(simulation, {"eyeLookUpLeft": 1.0, "eyeLookUpRight": 1.0})
    for landmark in (37, 38, 43, 44):
        assert 1.0 < moved_landmarks(head, moved, landmark)[1] < 2.0


def test_raised_inner_brows_leave_the_lids(simulation, head):
    """Raised inner brows move an upper lid by less than a third of a millimetre.

    Scanned lids rise by a sixth of a millimetre.
    """
    moved = settled_displacement(simulation, {"browInnerUp": 1.0})
    for brow in (21, 22):
        assert moved_landmarks(head, moved, brow)[1] > 4.0
    for lid in (37, 38, 43, 44):
        assert abs(moved_landmarks(head, moved, lid)[1]) < 0.33


def test_joy_bares_the_teeth(simulation, head):
    """In joy, the upper lip bares the lower part of the teeth; the lower lip lies at their edge."""
    moved = settled_displacement(simulation, head.expressions["joy"])
    edge = min(part.vertices[:, 1].min() for part in head.parts if part.name == "teeth_upper")
    lips = (head.vertices + moved)[head.landmarks[[62, 66]], 1]
    assert 5.0 < lips[0] - edge < 9.0
    assert abs(lips[1] - edge) < 0.9


def test_the_upper_lip_of_joy_is_thinner_than_at_rest(simulation, head):
    """In joy, the red of the upper lip is stretched over the teeth, most in the middle.

    The lip becomes straighter.
    """
    border = head.rings["mouth_6_left"][:3]
    inner = head.rings["mouth_2_left"][:3]
    smiling = head.vertices + settled_displacement(simulation, head.expressions["joy"])
    red = smiling[border, 1] - smiling[inner, 1]
    assert (red < 0.96 * (head.vertices[border, 1] - head.vertices[inner, 1])).all()


def test_disgust_shows_no_bits_of_teeth(simulation, head):
    """In disgust the lips touch, and part beside the corners by less than 1.5 mm."""
    moved = head.vertices + settled_displacement(simulation, head.expressions["disgust"])
    row = head.rings["mouth_2_left"]
    gaps = moved[row[:7], 1] - moved[row[:7:-1], 1]
    assert gaps[:4].max() < 0.1
    assert gaps.max() < 1.5


def test_sadness_slants_the_brows(simulation, head):
    """In sadness the inner brows rise above the outer ones."""
    moved = settled_displacement(simulation, head.expressions["sadness"])
    assert moved_landmarks(head, moved, 21, 22)[1] > 2.0 + moved_landmarks(head, moved, 17, 26)[1]


@pytest.mark.parametrize("name", BASIC_EXPRESSIONS + OTHER_EXPRESSIONS)
def test_expression_keeps_the_mesh_sound(simulation, head, name):
    """In each expression hardly any triangle is turned over, and skin stays near."""
    moved = settled_displacement(simulation, head.expressions[name])
    turned = inverted_triangles(head.faces, head.vertices, simulation.positions)
    assert turned <= 6
    assert np.abs(moved).max() < 60.0


def test_mirrored_input_gives_mirrored_motion(simulation, head):
    """A left smile and a right smile are mirror images."""
    left = settled_displacement(simulation, {"zygomaticus_major_left": 1.0, "gaze_horizontal": 0.5})
    right = settled_displacement(
        simulation, {"zygomaticus_major_right": 1.0, "gaze_horizontal": -0.5}
    )
    assert np.abs(left[head.mirror] * (-1.0, 1.0, 1.0) - right).max() < 1e-6


def test_left_smile_moves_the_left(simulation, head):
    """A left smile moves the subject's left corner (+x), and hardly the right one."""
    moved = settled_displacement(simulation, {"zygomaticus_major_left": 1.0})
    left = norm(moved_landmarks(head, moved, 54))
    right = norm(moved_landmarks(head, moved, 48))
    assert left > 8.0
    assert right < 0.25 * left


@pytest.mark.parametrize(
    "values",
    [
        {"orbicularis_oris_marginal_upper": 1.0, "orbicularis_oris_marginal_lower": 1.0},
        {"depressor_anguli_oris": 1.0},
        {"incisivus_labii_superioris": 1.0, "incisivus_labii_inferioris": 1.0},
        {"zygomaticus_major": 1.0, "depressor_anguli_oris": 1.0},
    ],
    ids=["press", "frown", "kiss", "smile against frown"],
)
def test_lips_do_not_cross(simulation, model, state, values):
    """Lips pressed by their muscles touch; the lower lip hardly enters the upper one."""
    settled_displacement(simulation, both_sides(simulation, values))
    lips = model.skin.lips
    y = state.x[:, 1]
    beside = lips.weight * y[lips.beside[:, 0]] + (1.0 - lips.weight) * y[lips.beside[:, 1]]
    gap = lips.below * (beside - y[lips.vertex])
    assert (gap - lips.least_gap).min() > -PRESSED_OVERLAP - 0.1


@pytest.mark.slow
@pytest.mark.parametrize(
    "other",
    [
        {},
        {"orbicularis_oculi_palpebral_lower": 1.0},
        {"AU1": 1.0, "AU2": 1.0},
        {"gaze_vertical": -0.5},
        {"gaze_vertical": 0.5, "gaze_horizontal": -0.5},
        {"gaze_vertical": -0.5, "gaze_horizontal": 0.5},
    ],
    ids=str,
)
def test_blink_closes_the_eyes(simulation, head, other):
    """In a blink no line of sight reaches the eye, in any gaze, refined or not."""
    settled_displacement(simulation, {"AU45": 1.0, **other})
    refiner = refine.create("kahler", head.faces, head.vertices)
    landmarks = simulation.positions[head.landmarks]
    eyeballs = eyeballs_of(head, simulation)
    for name, mesh in meshes_of(simulation, refiner).items():
        assert max(lid_gaps(*mesh, landmarks, eyeballs).values()) < 0.1, name


@pytest.mark.slow
def test_a_cornea_that_pierces_a_lid_is_seen(simulation, head):
    """The measure of a blink detects a cornea that pierces a lid, not only holes."""
    settled_displacement(simulation, {"AU45": 1.0})
    landmarks = simulation.positions[head.landmarks]
    pushed = {
        side: x + np.array([0.0, 0.0, 4.0]) for side, x in eyeballs_of(head, simulation).items()
    }
    gaps = lid_gaps(simulation.positions, head.faces, landmarks, pushed)
    assert min(gaps.values()) > 2.0


def test_eyes_are_open_at_rest(simulation, head):
    """The measure of a blink detects an open eye."""
    landmarks = simulation.positions[head.landmarks]
    eyeballs = eyeballs_of(head, simulation)
    gaps = lid_gaps(simulation.positions, head.faces, landmarks, eyeballs)
    assert min(gaps.values()) > 7.0


@pytest.mark.parametrize("gaze", [-1.0, 0.0, 1.0])
def test_skin_never_enters_the_eyeball(simulation, head, gaze):
    """With all muscles around the eye active in a blink, no vertex enters the eyeball."""
    lowest = simulation.controls.lowest
    around = [n for n in lowest if "oculi" in n or "frontalis" in n or "super" in n]
    for level in (1.0, 0.0):
        simulation.controls.set_all({**dict.fromkeys(around, level), "gaze_vertical": gaze})
        for _ in range(20):
            simulation.step(FRAME_TIME)
            for eye in head.eyes:
                distance = norm(simulation.positions - eye.centre, axis=1)
                before = norm(simulation.rest_positions - eye.centre, axis=1)
                assert (distance - np.minimum(before, eye.radius)).min() > -1e-6


def test_jaw_opens_the_mouth(simulation, head):
    """An open jaw parts the lips by at least 25 mm, and moves the chin down and back."""
    moved = settled_displacement(simulation, {"jaw_open": 1.0})
    assert lip_gap(simulation, head) > 25.0
    chin = moved_landmarks(head, moved, 8)
    assert chin[1] < -20.0
    assert chin[2] < -10.0


def test_jaw_slides(simulation, head):
    """The chin follows the jaw forward, slightly back, and sideways, and so do both condyles."""
    for sign in (-1.0, 1.0):
        chin = moved_landmarks(head, settled_displacement(simulation, {"jaw_forward": sign}), 8)
        assert chin[2] > 4.0 if sign > 0.0 else -2.5 < chin[2] < -0.5
        chin = moved_landmarks(head, settled_displacement(simulation, {"jaw_sideways": sign}), 8)
        assert 8.0 < sign * chin[0] < 11.3
        assert abs(chin[2]) < 1.5
        matrix = simulation.bones.transforms()["mandible"]
        condyles = moved_points(matrix, head.jaw_axis) - head.jaw_axis
        assert (np.abs(sign * condyles[:, 0] - 10.0) < 2.0).all()
        assert np.abs(condyles[:, 1:]).max() < 1.5


def test_gaze_turns_the_eyes(simulation, head):
    """At +1 eyes turn to the subject's left and up, about their centres; upper lids follow."""
    moved = settled_displacement(simulation, {"gaze_horizontal": 1.0, "gaze_vertical": 1.0})
    for eye in head.eyes:
        matrix = simulation.bones.transforms()[f"eye_{eye.name}"]
        front = eye.centre + np.array([0.0, 0.0, eye.radius])
        pupil = moved_points(matrix, front) - eye.centre
        assert pupil[0] > 4.0
        assert pupil[1] > 4.0
        assert norm(pupil) == pytest.approx(eye.radius)
    assert moved_landmarks(head, moved, 37, 38, 43, 44)[1] > 1.0


def test_each_eye_turns_alone(simulation, head):
    """Each eye can turn alone, and its lid follows without motion of the other lid."""
    gaze = {"gaze_horizontal_left": -0.5, "gaze_horizontal_right": 0.5, "gaze_vertical_left": -1.0}
    moved = settled_displacement(simulation, gaze)
    bones = simulation.bones.transforms()
    left, right = (bones[f"eye_{side}"][:3, 2] for side in ("left", "right"))
    assert left[0] < -0.2 < 0.2 < right[0]
    assert left[1] < -0.4
    assert abs(right[1]) < 0.01
    assert moved_landmarks(head, moved, 43, 44)[1] < -1.5
    assert abs(moved_landmarks(head, moved, 37, 38)[1]) < 0.1


@pytest.mark.parametrize("name", ["cheekPuff", "mouthPucker", "kiss", "AU28"])
def test_no_muscle_of_these_parts_the_lips(simulation, head, name):
    """Blown cheeks and kisses keep the lips shut. Rolled lips (AU28) slide, but stay shut.

    This holds on heads with parted lips, too.
    """
    settled_displacement(simulation, {name: 1.0})
    assert simulation.grip.gap_stiffness > 50.0
    assert (simulation.grip.stiffness > 50.0) == (name != "AU28")


def test_lips_follow_the_open_jaw(simulation, head):
    """Sides of the lower lip go down 0.7 times as far as the chin, and corners 0.35 times.

    In a scan they go down 0.88 and 0.43 times as far.
    """
    moved = np.linalg.norm(settled_displacement(simulation, {"jawOpen": 1.0}), axis=1)
    chin = moved[head.landmarks[8]]
    assert 35.0 < chin < 45.0
    assert (moved[head.landmarks[[65, 67]]] > 0.68 * chin).all()
    assert (moved[head.landmarks[[48, 54]]] > 0.34 * chin).all()
