"""The first guess of 68 landmarks: near the true ones, on the skin, refused for wrong input."""

import numpy as np
import pytest
from numpy.linalg import norm
from pytest import approx

from risorius import assets
from risorius.assets import AssetError
from risorius.assets.fitting.guess import FIRST_LANDMARKS, centred, guess
from risorius.assets.fitting.warp import nearest_on
from risorius.assets.meshes import Mesh
from risorius.sim.landmarks import MIRRORED_LANDMARKS
from tests.heads import METRES_PER_MILLIMETRE, person_of, user_head

JAW_COUNT = 17  # number of jaw landmarks, which come first and have no exact place along the jaw


def errors(mesh, true):
    """Errors of the landmarks guessed from the first six points."""
    found = guess(mesh, {number: true[number] for number in FIRST_LANDMARKS})
    off = norm(found - true, axis=1)
    assert not off[list(FIRST_LANDMARKS)].max() > 1e-9 * np.abs(true).max()
    return off


def test_the_built_in_head_is_found_again(head):
    """On the built-in head with finer triangles, all landmarks are found at their places."""
    fine = head.finer(1)
    assert errors(Mesh(fine.vertices, fine.faces), head.vertices[head.landmarks]).max() < 1.0


@pytest.mark.parametrize("seed", range(1, 6))
def test_other_persons_are_found(seed):
    """On other persons half of the landmarks are within 1.5 mm, and none is 6 mm off.

    The jaw line is left out.
    """
    person = person_of(seed)
    off = errors(Mesh(person.vertices, person.faces), person.vertices[person.landmarks])
    assert np.median(off[JAW_COUNT:]) < 1.5
    assert off[JAW_COUNT:].max() < 6.0
    assert off[:JAW_COUNT].max() < 25.0


@pytest.mark.slow
def test_unit_axes_and_other_pieces_do_not_matter():
    """For a head in metres, z up, inside out, with eyeballs, landmarks lie on the skin."""
    other = user_head()
    true = other.mesh.vertices[other.landmarks]
    balls = [true[list(eye)].mean(axis=0) for eye in (range(36, 42), range(42, 48))]
    corners = np.vstack([np.eye(3), -np.eye(3)]) * 14.0 * METRES_PER_MILLIMETRE
    ball = np.array([[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5]])
    vertices = other.mesh.vertices
    faces = other.mesh.faces[:, ::-1]
    for middle in balls:
        faces = np.vstack([faces, ball + len(vertices)])
        vertices = np.vstack([vertices, corners + middle])
    mesh = Mesh(vertices, faces.astype(np.int32))
    off = errors(mesh, true) / METRES_PER_MILLIMETRE
    assert np.median(off) < 2.0
    assert off[JAW_COUNT:].max() < 6.0
    found = guess(mesh, {number: true[number] for number in FIRST_LANDMARKS})
    skin = nearest_on(found, np.zeros((68, 3)), other.mesh.vertices, other.mesh.faces)
    gap = norm(skin.interpolate(other.mesh.vertices) - found, axis=1)
    assert gap.max() < 1e-3 * METRES_PER_MILLIMETRE


def test_one_point_of_a_brow_moves_both(head):
    """If brows lie 12 mm lower than usual, a point of one moves both, and no other landmark."""
    mesh = Mesh(head.vertices, head.faces)
    true = head.vertices[head.landmarks]
    lowered = true[17:27] - [0.0, 12.0, 0.0]
    forward = np.tile([0.0, 0.0, 1.0], (10, 1))
    brows = nearest_on(lowered, forward, mesh.vertices, mesh.faces).interpolate(mesh.vertices)
    usual = guess(mesh, {number: true[number] for number in FIRST_LANDMARKS})
    moved = guess(mesh, {**{number: true[number] for number in FIRST_LANDMARKS}, 19: brows[2]})
    assert norm(moved[17:27] - brows, axis=1).max() < 2.0
    usual[17:27] = moved[17:27]
    assert moved == approx(usual)


@pytest.mark.slow
def test_more_points_make_it_better_and_stay():
    """Given points stay where they are, and further ones improve the guess of their neighbours."""
    person = person_of(1)
    mesh = Mesh(person.vertices, person.faces)
    true = person.vertices[person.landmarks]
    few = errors(mesh, true)
    known = {number: true[number] for number in (*FIRST_LANDMARKS, 4, 8, 12)}
    many = norm(guess(mesh, known) - true, axis=1)
    assert many[[*known]].max() < 1e-9
    assert many[:JAW_COUNT].mean() < 0.75 * few[:JAW_COUNT].mean()


@pytest.mark.parametrize(
    ("order", "words"),
    [
        (MIRRORED_LANDMARKS, "left and right are swapped"),
        (np.roll(np.arange(68), 18), "no face"),
        (np.r_[:36, 45, 37:45, 36, 46:68], "the eyes are swapped, landmarks 36 and 45"),
        (np.zeros(68, int), "one point"),
    ],
)
def test_points_of_no_face_are_refused(head, order, words):
    """Points in a wrong order are refused in one line."""
    points = head.vertices[head.landmarks][order]
    with pytest.raises(AssetError, match=words) as raised:
        guess(
            Mesh(head.vertices, head.faces), {number: points[number] for number in FIRST_LANDMARKS}
        )
    assert "\n" not in str(raised.value)


def test_a_mesh_is_brought_into_the_middle():
    """A mesh in any unit is centred and scaled to the requested size."""
    vertices = assets.load("head").vertices
    seen = centred(0.001 * vertices + 7.0, 140.0).points(0.001 * vertices + 7.0)
    assert norm(seen, axis=1).max() == approx(140.0)
    assert seen.max(axis=0) == approx(-seen.min(axis=0))
