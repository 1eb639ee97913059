"""The rigid parts: valid, inside the head, hidden while mouth and eyes are at rest."""

import numpy as np
from numpy.linalg import norm
from pytest import approx

from risorius.geometry.directions import unit_vectors
from tests.assets.checks import check_part, part_of, winding_numbers

BONES = {"cranium", "mandible", "eye_left", "eye_right", "neck"}
IN_MOUTH = ("teeth", "gums", "tongue", "oral_cavity")


def test_parts_are_well_formed(head):
    """Arrays, bones and shine are within their ranges, and names are unique."""
    assert len({found.name for found in head.parts}) == len(head.parts)
    for found in head.parts:
        check_part(found)
        assert found.bone in BONES
        assert 0.0 <= found.shine <= 1.0


def test_parts_of_the_jaw_move_with_it(head):
    """Lower teeth, lower gums, tongue and the floor of the mouth move with the mandible."""
    on_mandible = {found.name for found in head.parts if found.bone == "mandible"}
    assert on_mandible == {"teeth_lower", "gums_lower", "tongue", "oral_cavity_lower"}


def test_parts_look_outward_or_into_the_mouth(head):
    """Teeth and eyes face away from their middle; the cavity is visible from inside."""
    for name in ("eyeball_left", "tongue"):
        found = part_of(head, name)
        away = found.vertices - found.vertices.mean(axis=0)
        assert (found.normals * away).sum(axis=1).mean() > 0.0
    flesh = part_of(head, "eye_corners")
    assert flesh.normals[flesh.vertices[:, 2] > 79.5, 2].min() > 0.5  # its sides face sideways
    cavity = part_of(head, "oral_cavity_upper")
    inward = np.array([0.0, -75.0, 56.0]) - cavity.vertices
    assert ((cavity.normals * inward).sum(axis=1) > 0.0).mean() > 0.95
    assert part_of(head, "oral_cavity_lower").normals[:, 1].mean() > 0.5


def test_everything_in_the_mouth_is_inside_the_head(head):
    """No part of the mouth comes through lips or cheeks at rest."""
    for found in head.parts:
        if found.name.startswith(IN_MOUTH):
            assert winding_numbers(head.vertices, head.faces, found.vertices).min() > 0.65, (
                found.name
            )


def test_teeth_darken_toward_the_corners_of_the_mouth(head):
    """Premolars have about half the lightness of incisors, because cheeks shade them."""
    teeth = part_of(head, "teeth_upper")
    lightness = teeth.colours.mean(axis=1)
    aside = np.abs(teeth.vertices[:, 0])
    incisors = lightness[aside < 12.0].mean()
    premolars = lightness[(aside > 20) & (aside < 25)]
    assert 0.45 < premolars.mean() / incisors < 0.6


def test_teeth_stand_behind_the_lips(head):
    """The vestibule (the space behind the lips) ends in front of the teeth."""
    vestibule = head.vertices[head.rings["mouth_0_left"]]
    for name in ("teeth_upper", "teeth_lower"):
        teeth = part_of(head, name).vertices
        for x, _, z in vestibule[[0, 3, 7, 11, 14]]:
            beside = np.abs(teeth[:, 0] - x) < 3.0
            assert teeth[beside, 2].max() < z, name


def test_teeth_are_pairs_of_fourteen_and_ivory(head):
    """Each jaw has two mirrored quarters of seven teeth; their colour is warm, not white."""
    for name in ("teeth_upper", "teeth_lower"):
        teeth = part_of(head, name)
        assert len(teeth.vertices) % 14 == 0
        assert teeth.vertices[:, 0].min() == approx(-teeth.vertices[:, 0].max())
        red, _, blue = teeth.colours.max(axis=0)
        assert red < 0.96
        assert blue < red - 0.05


def test_upper_incisors_overlap_the_lower(head):
    """Overbite and overjet of the incisors are one to four millimetres."""
    upper = part_of(head, "teeth_upper").vertices
    lower = part_of(head, "teeth_lower").vertices
    front = [teeth[np.abs(teeth[:, 0]) < 4.0] for teeth in (upper, lower)]
    assert 1.0 < front[1][:, 1].max() - front[0][:, 1].min() < 4.0
    assert 1.0 < front[0][:, 2].max() - front[1][:, 2].max() < 4.0


def test_mouth_is_darker_toward_the_throat(head):
    """Teeth and cheeks lose light toward the throat, but the throat is not black."""
    for name in ("teeth_lower", "teeth_upper", "oral_cavity_upper"):
        found = part_of(head, name)
        depth = found.vertices[:, 2]
        brightness = found.colours.mean(axis=1)
        front = brightness[depth > np.percentile(depth, 80)].mean()
        back = brightness[depth < np.percentile(depth, 20)].mean()
        assert 0.01 < back < 0.75 * front, name


def is_beside(points, least, most):
    """Which points (n, 3) have a distance between two limits from the mirror plane."""
    distance = np.abs(points[:, 0])
    return (distance > least) & (distance < most)


def test_gums_hold_the_teeth(head):
    """Every crown has its root in gum, and its visible height is that of real teeth."""
    for row, up in (("upper", 1.0), ("lower", -1.0)):
        teeth = part_of(head, f"teeth_{row}").vertices
        gums = part_of(head, f"gums_{row}").vertices
        margin = up * gums[:, 1]
        for low, high, least, most in ((0.0, 9.0, 6.5, 10.0), (24.0, 30.0, 2.0, 7.0)):
            of_teeth, of_gums = (is_beside(each, low, high) for each in (teeth, gums))
            crown = up * teeth[of_teeth, 1]
            edge = margin[of_gums].min()
            assert crown.max() > edge + 0.5
            assert least < edge + 1.5 - crown.min() < most, (row, low)


def test_the_tongue_lies_against_the_lower_crowns(head):
    """The tongue is at most 2.5 mm from the lower teeth, from the canines to the molars.

    The inner sides of these teeth are therefore hidden.
    """
    tongue, teeth = (part_of(head, name).vertices for name in ("tongue", "teeth_lower"))
    for z in (80.0, 75.0, 68.0, 59.0):
        is_crown = (np.abs(teeth[:, 2] - z) < 1.5) & (teeth[:, 1] > -75.0)
        inner = teeth[is_crown & (teeth[:, 0] > 4.0), 0].min()  # [mm]; of the left crowns
        beside = tongue[np.abs(tongue[:, 2] - z) < 1.5, 0].max()
        assert inner - 2.5 < beside < inner + 1.0, z


def test_parts_cost_no_more_than_they_must(head):
    """Parts have 8000 to 17 300 triangles, so that software draws them as fast as the skin."""
    assert 8000 <= sum(len(found.faces) for found in head.parts) <= 17300


def test_lids_rest_on_the_iris_as_in_a_calm_face(head):
    """The upper lid covers one or two millimetres of the iris; the lower lid touches its edge."""
    for eye, side in zip(head.eyes, ("right", "left"), strict=True):
        margin = head.vertices[head.rings[f"eye_1_{side}"]] - eye.centre
        heights = margin[np.abs(margin[:, 0]) < 3.0, 1]
        above = heights[heights > 0.0].mean()
        below = -heights[heights < 0.0].mean()
        assert 1.0 < eye.iris_radius - above < 2.0
        assert -0.4 < eye.iris_radius - below < 0.8


def test_lashes_are_rooted_in_the_lids_edges(head):
    """Each lash begins on a lid margin, points away from the eye, and is off the eyeball."""
    lashes = part_of(head, "lashes")
    assert lashes.roots is not None
    assert lashes.strand_radius > 0.0
    edges = np.vstack([head.vertices[head.rings[f"eye_2_{side}"]] for side in ("right", "left")])
    roots = np.unique(lashes.roots)
    along = np.vstack([edges, 0.5 * (edges + np.roll(edges, 1, axis=0))])
    away = norm(lashes.vertices[roots][:, None] - along[None], axis=2).min(axis=1)
    assert away.max() < 1.6
    for eye in head.eyes:
        is_near = np.abs(lashes.vertices[:, 0] - eye.centre[0]) < 25.0
        from_eye = norm(lashes.vertices - eye.centre, axis=1)[is_near]
        assert from_eye.min() > eye.radius
        root = norm(lashes.vertices[lashes.roots] - eye.centre, axis=1)[is_near]
        assert (from_eye > root - 0.3).all()


def test_lashes_are_curves(head):
    """A lash bends by at most 30 degrees at a joint; one of two or three segments bent by 44."""
    lashes = part_of(head, "lashes")
    for root in np.unique(lashes.roots):
        lash = lashes.vertices[lashes.roots == root].astype(np.float64)
        rings = lash[:-1].reshape(-1, 3, 3).mean(axis=1)
        ways = np.diff(np.vstack([rings, lash[-1]]), axis=0)
        ways = unit_vectors(ways)
        cosines = (ways[1:] * ways[:-1]).sum(axis=1)
        assert cosines.min() > np.cos(np.radians(30.0))


def test_lower_lashes_are_short_and_lean_outward(head):
    """Lower lashes are short and lean outward; long straight ones would look like a doll's."""
    lashes = part_of(head, "lashes")
    eye = head.eyes[1]
    tips = np.flatnonzero(np.diff(lashes.roots, append=-1))
    tips = tips[lashes.vertices[tips, 0] > 0.0]
    tip = lashes.vertices[tips]
    root = lashes.vertices[lashes.roots[tips]]
    length = norm(tip - root, axis=1)
    is_lower = root[:, 1] < eye.centre[1]
    is_upper = ~is_lower
    assert 0.2 < length[is_lower].mean() / length[is_upper].mean() < 0.5
    is_outer = root[:, 0] > eye.centre[0]
    assert ((tip - root)[is_lower & is_outer, 0] > 0.0).mean() > 0.95
    inner_length = length[is_upper & ~is_outer].mean()
    assert length[is_upper & is_outer].mean() > 1.1 * inner_length


def test_wet_edges_lie_between_lid_and_eyeball(head):
    """Wet edges lie on the lower lids, face up and forward, and hardly rise above the ball."""
    wet = part_of(head, "wet_edges")
    assert wet.roots is not None
    assert (wet.roots == np.arange(len(wet.vertices))).all()
    assert wet.normals.mean(axis=0)[1:].min() > 0.3
    centres = np.array([eye.centre for eye in head.eyes])
    away = norm(wet.vertices[:, None] - centres, axis=2).min(axis=1)
    assert (np.abs(away - head.eyes[0].radius) < 2.5).all()
    assert (wet.vertices[:, 1] < 2.0).all()


def test_eyeballs_fit_their_lids(head):
    """Lid margins do not touch the eyeball, and the ball fills the opening between the lids."""
    for eye, side in zip(head.eyes, ("right", "left"), strict=True):
        ball = part_of(head, f"eyeball_{side}").vertices - eye.centre
        radius = norm(ball, axis=1)
        assert radius.min() == approx(eye.radius, abs=0.01)
        assert eye.radius + 0.8 < radius.max() < eye.radius + 2.0  # the cornea
        margin = head.vertices[head.rings[f"eye_1_{side}"]] - eye.centre
        assert norm(margin, axis=1).min() > eye.radius + 0.1
        assert radius[np.hypot(ball[:, 0], ball[:, 1]) > 5.2].max() < eye.radius + 0.25


def test_pupil_is_at_the_pole_and_the_iris_has_its_radius(head):
    """The pupil is dark, the iris a coloured ring of its radius, and the sclera light."""
    eye = head.eyes[1]
    ball = part_of(head, "eyeball_left")
    local = ball.vertices - eye.centre
    beside = np.hypot(local[:, 0], local[:, 1])
    ahead = local[:, 2] > 0
    brightness = ball.colours.mean(axis=1)
    assert brightness[ahead & (beside < 1.5)].max() < 0.1
    iris = brightness[ahead & (beside > 2.6) & (beside < eye.iris_radius - 0.8)]
    assert 0.2 < iris.mean() < 0.6
    assert iris.std() > 0.02
    sclera = ahead & (beside > 6.8) & (np.abs(local[:, 0]) < 6.0)
    assert brightness[sclera & (local[:, 1] < 0.0)].min() > 0.69


def test_upper_lid_throws_a_shadow_on_the_eye(head):
    """The sclera is painted darker at the top than below, by a quarter to a half."""
    ball = part_of(head, "eyeball_left")
    local = ball.vertices - head.eyes[1].centre
    sclera = (local[:, 2] > 6.0) & (np.hypot(local[:, 0], local[:, 1]) > 6.8)
    brightness = ball.colours.mean(axis=1)
    above = brightness[sclera & (local[:, 1] > 6.0)].mean()
    below = brightness[sclera & (local[:, 1] < -6.0)].mean()
    assert 0.5 * below < above < 0.75 * below


def test_eye_corners_are_filled(head):
    """Flesh fills the eye's corners, from the ball to both ends, behind the lid margin."""
    flesh = part_of(head, "eye_corners").vertices
    for name in ("endocanthion_left", "exocanthion_left"):
        corner = head.vertices[head.anatomy[name]]
        assert norm(flesh - corner, axis=1).min() < 4.0
