"""Contacts of skin: the distance from an eyeball, and the touching parts of the lips."""

from types import SimpleNamespace

import numpy as np
import pytest
from pytest import approx

from risorius.sim.contact import pair_lips
from risorius.sim.eye_contact import keep_out_of_eyeballs, lift_triangles, watch_eyeballs
from risorius.sim.landmarks import Side
from risorius.sim.skull import Eyeball, ball_surface
from risorius.sim.state import State
from risorius.sim.surface import build_surface

FORWARD = (0.0, 0.0, 1.0)


def test_skin_may_come_as_near_as_a_lid_is_thick():
    """Skin may approach the ball to 0.3 mm, the thickness of a lid.

    Skin that starts nearer may stay there, and distant skin is not checked.
    """
    ball = Eyeball(Side.LEFT, np.array([30.0, 0.0, 0.0]), 12.0)
    away = np.array([10.0, 12.1, 13.0, 20.0, 30.0])
    skin = SimpleNamespace(
        positions=ball.centre + away[:, None] * [0.0, 0.6, 0.8], faces=np.zeros((0, 3), np.int32)
    )
    eyes = watch_eyeballs(skin, (ball,))
    assert eyes.near.vertex.tolist() == [0, 1, 2, 3]
    assert eyes.near.least == approx([10.0, 12.1, 12.3, 12.3])
    sunk = ball.centre + np.array([10.0, 12.1, 11.8, 12.3, 1.0])[:, None] * [0.0, 0.6, 0.8]
    assert eyes.deepest(sunk, np.array([FORWARD])) == approx(0.5)


def flat_lid(size):
    """A triangle below the pupil of an eye at rest, in front of the ball, and its eye contact."""
    corners = np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]]) * size
    ball = Eyeball(Side.LEFT, np.array([30.0, 0.0, 0.0]), 12.0)
    surface = build_surface(
        ball.centre + corners + [0.0, -8.0, 12.0], np.array([[0, 1, 2]], np.int32)
    )
    return ball, surface, watch_eyeballs(surface, (ball,))


@pytest.mark.parametrize("look", [FORWARD, (0.0, -0.6, 0.8)], ids=["ahead", "down"])
@pytest.mark.parametrize("size", [1.0, 5.0], ids=["fine", "coarse"])
def test_a_cornea_does_not_pierce_a_lid(look, size):
    """No point of a lid's triangle is nearer to ball and cornea than a lid is thick.

    The cornea turns with the gaze, and a long triangle is flat between vertices that are outside.
    """
    ball, surface, eyes = flat_lid(size)
    assert len(eyes.long.faces) == (size > 2.0)
    state = State.at_rest(surface)
    looks = np.array([look])
    flat = surface.positions - surface.positions.mean(axis=0)
    state.x[:] = ball.centre + 12.4 * looks[0] + flat
    state.v[:] = -100.0 * looks[0]
    for _ in range(20):
        keep_out_of_eyeballs(state, eyes, looks)
        lift_triangles(state, eyes, looks)
    points = np.random.default_rng(2).dirichlet([1.0, 1.0, 1.0], 5000) @ state.x - ball.centre
    distance = np.linalg.norm(points, axis=1)
    cornea = ball_surface(points @ looks[0] / distance, ball.radius, ball.iris)
    assert 0.1 < (distance - cornea).min() < 0.5
    assert distance.min() > 12.6
    assert ((state.x - ball.centre) * state.v).sum(axis=1).min() > -1e-9


def paired_lips(above, below, gap):
    """The side of each vertex of two straight lips, `gap` mm apart, and their pairs.

    above, below: number of vertices of the upper and of the lower lip.
    """
    counts = (above, below)
    across = np.concatenate([np.linspace(-20.0, 20.0, count) for count in counts])
    is_upper = np.repeat([True, False], counts)
    height = np.where(is_upper, 0.5, -0.5) * gap
    forward = np.where(is_upper, 1.5, 0.0)  # the upper lip is in front
    landmarks = np.zeros((68, 3))
    landmarks[60:68, 0] = [-24.0, -12.0, 0.0, 12.0, 24.0, 12.0, 0.0, -12.0]
    surface = SimpleNamespace(
        positions=np.stack([across, height, forward], axis=1),
        areas=np.repeat([40.0 / above, 40.0 / below], counts),
        vertex_count=above + below,
        edges=np.zeros((0, 2), np.int32),
        lengths=np.zeros(0),
        spacing=np.full(above + below, 5.0),
        nearest=lambda points: np.zeros(len(points), np.int32),
    )
    lip_side = np.where(is_upper, 1.0, -1.0)
    lips = pair_lips(surface, landmarks, lip_side, 2.0)
    assert lips.separations(surface.positions)[:, 0] == approx(0.0)
    return lip_side, lips


@pytest.mark.parametrize(
    ("above", "below", "gap"), [(17, 9, 1.0), (9, 17, 1.0), (9, 9, 1.0), (9, 9, 4.0)]
)
def test_every_vertex_of_either_lip_is_in_a_pair(above, below, gap):
    """Every vertex of both lips is in a pair, and both lips are held equally.

    One lip may have twice as many vertices. Lips may be as far apart as their vertices.
    """
    lip_side, lips = paired_lips(above, below, gap)
    assert lips.members.tolist() == list(range(above + below))
    assert (lip_side[lips.vertex] == -lips.below).all()
    assert (lip_side[lips.beside] == lips.below[:, None]).all()
    assert np.sort(lips.vertex).tolist() == list(range(above + below))
    assert lips.seal.sum() == approx(2.0 * 80.0)


def test_no_vertex_of_a_dense_lip_is_held_more_firmly_than_its_neighbours():
    """The seal holds all vertices of a lip equally, for their areas.

    Vertices of a sparse lip lie opposite every second vertex of a dense one. When a muscle weakened
    the seal, those vertices stood out of the line of the others.
    """
    lips = paired_lips(17, 9, 1.0)[1]
    upper = np.zeros(17)
    is_own = lips.below < 0.0
    np.add.at(upper, lips.vertex[is_own], lips.seal[is_own])
    np.add.at(upper, lips.beside[~is_own, 0], (lips.weight * lips.seal)[~is_own])
    np.add.at(upper, lips.beside[~is_own, 1], ((1.0 - lips.weight) * lips.seal)[~is_own])
    inner = upper[1:-1]
    assert inner.max() < 1.6 * inner.min()


def test_the_last_vertices_of_coarse_lips_are_in_pairs():
    """A vertex beside a corner is in a pair, although the other lip has none nearer to the corner.

    Otherwise teeth show there in a closed mouth. It also is if the lips' middle lies aside.
    """
    upper = [-15.0, 2.0, 20.0]
    lower = [-8.0, 2.0, 12.0, 19.0]
    across = np.array([-22.0, 24.0, *upper, *lower])  # first the corners
    side = np.repeat([0.0, 1.0, -1.0], [2, len(upper), len(lower)])
    landmarks = np.zeros((68, 3))
    landmarks[60:68, 0] = [-22.0, -12.0, -3.0, 12.0, 24.0, 12.0, -3.0, -12.0]
    faces = [[0, 5, 2], [5, 6, 2], [2, 6, 3], [3, 6, 7], [3, 7, 4], [7, 8, 4], [4, 8, 1]]
    positions = np.stack([across, 0.5 * side, np.zeros(9)], axis=1)
    lips = pair_lips(build_surface(positions, np.array(faces, np.int32)), landmarks, side, 1.0)
    assert np.unique(lips.vertex).tolist() == [2, 3, 4, 5, 6, 7, 8]
