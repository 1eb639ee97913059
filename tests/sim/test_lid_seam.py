"""The seam of closed lids, beside the corners of an eye."""

import numpy as np
import pytest
from numpy.linalg import norm
from numpy.testing import assert_allclose, assert_array_equal

from risorius import sim
from risorius.assets.coarse import coarse_head
from risorius.geometry.sides import side_lengths, sides_of
from risorius.sim.face_model import build_face_model
from risorius.sim.landmarks import EYE_LANDMARKS, Side
from risorius.sim.lid_edges import (
    LID_COLUMNS,
    LidAxes,
    front_edges,
    margin_of,
    one_lid,
    side_with_edges,
)
from risorius.sim.lid_fold import SkinTurn, blended_turn, turn_above
from risorius.sim.lid_seam import lowered_corners, raised_at_corners
from risorius.sim.lids import lid_axes
from risorius.sim.rig import Eyes
from risorius.sim.skull import Eyeball
from risorius.sim.surface import build_surface
from tests.heads import person_of
from tests.sim.poses import both_sides, settled_displacement

COLUMN_FRACTIONS = np.linspace(0.0, 1.0, LID_COLUMNS)


def test_no_step_below_a_corner_above_the_lower_lid():
    """The seam rises from a lid at -8 degrees to a corner at 6 degrees without a notch."""
    seam = np.radians(np.where((COLUMN_FRACTIONS == 0.0) | (COLUMN_FRACTIONS == 1.0), 6.0, -8.0))
    upper = np.radians(6.0 + 68.0 * COLUMN_FRACTIONS * (1.0 - COLUMN_FRACTIONS))
    raised = raised_at_corners(seam, upper)
    assert np.abs(np.diff(raised)).max() < np.radians(1.0)
    assert (raised >= seam).all()
    assert (raised <= upper).all()
    assert_array_equal(raised[20], seam[20])


def test_a_level_lid_keeps_its_seam():
    """Nothing is raised if the lower lid runs straight into the corners."""
    seam = np.radians(-21.0 - 3.0 * np.sin(np.pi * COLUMN_FRACTIONS))
    upper = seam + np.radians(45.0) * np.sin(np.pi * COLUMN_FRACTIONS)
    assert_allclose(raised_at_corners(seam, upper), seam, atol=np.radians(0.3))


def test_irises_and_lids_move_no_farther_on_a_large_ball():
    """The way of a gaze along the surface does not grow on eyeballs larger than a human's."""
    human, large = (Eyeball(Side.LEFT, np.zeros(3), radius) for radius in (12.8, 18.8))
    assert human.gaze_factor == 1.0
    assert_allclose(large.gaze_factor * large.radius, human.radius)


def test_a_shut_lid_is_a_smooth_sheet_over_the_ball(simulation, head):
    """The corner of a shut lid does not sink, and no vertex of its fold drops by 4 mm."""
    shut = both_sides(simulation, {"orbicularis_oculi_palpebral_upper": 1.0})
    moved = settled_displacement(simulation, shut)
    inner = np.array([0, 1, 2, 17, 18, 19])  # positions in a row, from the inner corner
    for row in ("eye_1_left", "eye_2_left", "eye_1_right", "eye_2_right"):
        assert moved[head.rings[row][inner], 2].min() > -1.0
    for row in ("eye_3_left", "eye_3_right"):
        upper = head.rings[row][:11]
        assert np.abs(np.diff(moved[upper, 1])).max() < 4.0


def test_the_edge_of_a_half_shut_lid_is_an_arc(simulation, head):
    """At half a blink, the upper lid's edge rises by 0.081 of the eye's width; once by 0.078."""
    half = both_sides(simulation, {"orbicularis_oculi_palpebral_upper": 0.5})
    x = head.vertices + settled_displacement(simulation, half)
    edge = x[head.rings["eye_2_left"][:11]]
    rise = edge[5, 1] - edge[[0, 10], 1].mean()
    assert rise > 0.081 * norm(edge[10] - edge[0])


def test_the_fold_stays_an_arc_above_a_shut_lid(simulation, head):
    """The inner end of the fold hardly comes down, so a shut lid is a dome.

    It once came down by up to 3.5 mm, and a shut lid was a box with a wedge above its inner end.
    """
    shut = both_sides(simulation, {"orbicularis_oculi_palpebral_upper": 1.0})
    moved = settled_displacement(simulation, shut)
    for fold in ("eye_4_left", "eye_4_right"):
        assert (moved[head.rings[fold][[2, 3, 5]], 1] > [-1.3, -2.8, -4.1]).all()


def test_a_shut_lid_of_deep_set_eyes_lies_on_the_ball():
    """With deep-set eyes a shut lid lies on the eyeball.

    An old man's lid once stood 6 mm before the ball under a high brow.
    """
    man = person_of(47)
    simulation = sim.Simulation(build_face_model(man))
    shut = both_sides(simulation, {"orbicularis_oculi_palpebral_upper": 1.0})
    moved = settled_displacement(simulation, shut)
    for eye in man.eyes:
        away = simulation.rest_positions + moved - eye.centre
        is_before_ball = (np.abs(away[:, [0, 1]]) < [7.0, 4.0]).all(axis=1)
        is_lid = is_before_ball & (away[:, 2] > 0.0)
        stands = norm(away[is_lid], axis=1) - eye.radius
        assert is_lid.sum() >= 8
        assert stands.max() < 4.8


def test_skin_beside_the_inner_corner_slides_along(simulation, head):
    """When an eye shuts, no edge at the nose's side of the inner corner shortens by a fifth."""
    shut = both_sides(simulation, {"orbicularis_oculi_palpebral_upper": 1.0})
    aside = settled_displacement(simulation, shut)[:, 0]
    corner = head.vertices[head.landmarks[42]]
    edges = sides_of(head.faces)
    away = head.vertices[edges] - corner
    is_near = (norm(away, axis=2) < 8.0).all(axis=1)
    edges = edges[is_near & (away[..., 0] < 0.0).any(axis=1)]
    assert len(edges) > 5
    nearer = np.abs(np.diff(aside[edges], axis=1)[:, 0])
    assert (nearer / side_lengths(head.vertices, edges)).max() < 0.2


def test_shut_lids_overlap_beside_the_corners(simulation, head):
    """The last vertices of an upper lid come down as far as its middle.

    They were not margin where the sampled edge ran above them, and stopped 0.2 mm too high; on
    coarse heads a gap stayed there.
    """
    shut = both_sides(simulation, {"orbicularis_oculi_palpebral_upper": 1.0})
    x = head.vertices + settled_displacement(simulation, shut)
    for side in ("left", "right"):
        ring = head.rings[f"eye_2_{side}"]
        lower = ring[np.r_[10:20, 0]]
        lower = lower[np.argsort(x[lower, 0])]
        beside = ring[[1, 9]]
        overlap = np.interp(x[beside, 0], *x[lower, :2].T) - x[beside, 1]
        assert (overlap > [0.4, 0.8]).all(), side


def test_vertices_of_an_edge_are_on_its_lid():
    """One that lies nearer to the landmarks of the other lid is on its own; corners stay."""
    side = np.array([-0.5, 1.0, -0.3, -0.5, -1.0, 0.2])
    found = side_with_edges(side, np.array([0, 1, 2, 3]), np.array([0, 4, 5, 3]))
    assert_array_equal(found, [-0.5, 1.0, 1.0, -0.5, -1.0, -1.0])


def test_the_inner_third_of_a_shut_upper_lid_covers_the_lower(head):
    """The upper edge lies at most 0.1 mm behind the lower one, which showed as pale scraps."""
    person = person_of(18)
    shut = sim.create(person)
    x = person.vertices + settled_displacement(shut, {"AU43": 1.0})
    ring = head.rings["eye_2_left"]
    away = norm(x[ring] - np.asarray(person.eyes[1].centre), axis=1)
    assert (away[1:5] - away[19:15:-1]).min() > -0.1


@pytest.mark.parametrize("of_person", [False, True])
def test_a_shut_upper_lid_lies_in_front_of_the_lower(of_person):
    """The upper front edge is nowhere behind the lower one; once by 0.16 mm, a row of scraps.

    The lids slide, so the upper lid meets another part of the lower than the one below it at rest.
    """
    head = person_of(18) if of_person else coarse_head()
    shut = sim.create(head)
    settled_displacement(shut, {"eyeBlinkLeft": 1.0, "eyeBlinkRight": 1.0})
    model = shut._model
    landmarks = model.surface.positions[head.landmarks]
    columns = np.linspace(0.12, 0.88, 60)
    for ball in model.skull.eyeballs:
        axes = lid_axes(landmarks, ball)
        outline = landmarks[list(EYE_LANDMARKS[ball.side])]
        edges = front_edges(model.surface, axes, outline)
        upper, lower = (axes.reach_by_column(shut._state.x[each], columns) for each in edges)
        assert (upper - lower).min() > 0.1


def test_a_corner_above_the_shut_edge_moves_down():
    """A corner moves to the line on which the pressed edge arrives, at most 0.13 rad."""
    level = np.full(LID_COLUMNS, -0.4)
    pressed = np.full(LID_COLUMNS, 0.1)
    lowered = lowered_corners(level, pressed)
    assert_allclose(lowered[[0, 20, -1]], [-0.5, -0.4, -0.46])
    assert_allclose(lowered_corners(level, np.zeros(LID_COLUMNS)), level)


def test_skin_in_front_of_an_edge_moves_along():
    """Skin beside a corner turns like the nearest place of the edge, not by its column."""
    points = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [1, 0, 1], [-0.5, 0, 0.5], [9, 0, 9]])
    edge = np.array([0, 1, 2], np.int32)
    turn = np.array([0.0, 0.1, 0.2, 0.0, 0.0, 0.0])
    weight = np.array([1.0, 1.0, 1.0, 0.8, 0.8, 0.0])
    below = blended_turn(points, (edge, edge), turn, np.full(6, -1.0), weight)
    assert_allclose(below.of_edges[3], 0.1)
    assert_allclose(below.fading[3], 0.08)
    assert 0.0 < below.of_edges[4] < 0.05
    assert below.of_edges[5] == 0.0


def lid_of_rows(beside, angles, reaches):
    """A lid around an eyeball at the origin, and its axes; corners lie at x = -12 and x = 12 mm.

    beside: x of each column [mm]. angles [rad] and reaches [mm]: of each row, from the edge upward.
    """
    turned = np.stack([np.sin(angles), np.cos(angles)], axis=1) * np.asarray(reaches)[:, None]
    points = np.array([[x, y, z] for y, z in turned for x in beside])
    width = len(beside)
    first = np.array(
        [row * width + column for row in range(len(angles) - 1) for column in range(width - 1)]
    )
    lower = np.stack([first, first + 1, first + width], axis=1)
    upper = np.stack([first + 1, first + width + 1, first + width], axis=1)
    corner = np.array([-12.0, 0.0, 0.0])
    axes = LidAxes(np.zeros(3), np.eye(3)[1], np.eye(3)[2], corner, -2.0 * corner)
    return build_surface(points, np.vstack([lower, upper]).astype(np.int32)), axes


def test_the_round_rim_of_a_thick_lid_turns_whole():
    """The foremost row of a thick rim turns with its edge, though the way there is 1.7 mm long.

    On MakeHuman's lids it stopped 5 degrees too high, and the seam of shut eyes had teeth.
    """
    angles = np.radians([16.0, 16.5, 25.0])  # the edge, the foremost row, and the fold
    surface, axes = lid_of_rows(np.linspace(-12.0, 12.0, 9), angles, [15.0, 16.7, 17.5])
    edge_angles = np.full(LID_COLUMNS, angles[0]), np.full(LID_COLUMNS, -0.2)
    turn = np.full(27, -0.2 - angles[0])
    above = turn_above(
        surface, axes, np.arange(9, dtype=np.int32), np.ones(27), edge_angles, SkinTurn(turn, turn)
    )
    middle = above[[4, 13, 22]]
    assert_allclose(middle[1], middle[0], atol=np.radians(0.1))
    assert middle[2] > 0.8 * middle[0]


@pytest.mark.parametrize(("columns", "is_margin"), [(4, True), (13, False)])
def test_skin_under_the_arc_of_a_coarse_edge_is_margin(columns, is_margin):
    """Skin 0.3 mm above a straight piece of 8 mm belongs to the margin, above one of 2 mm not.

    The rear of a rim stayed up in shut eyes of 1300 triangles, and tore a hole through the lid.
    """
    angles = np.radians([16.0, 17.2, 30.0])
    surface, axes = lid_of_rows(np.linspace(-12.0, 12.0, columns), angles, [15.0, 14.9, 17.0])
    edge = np.arange(columns, dtype=np.int32)
    lid = one_lid(Eyes(), surface, axes, edge, np.ones(3 * columns, bool), (1.0, 9.0))
    assert margin_of(lid, 1.0, np.array([0.5]), angles[1:2])[0] == is_margin
