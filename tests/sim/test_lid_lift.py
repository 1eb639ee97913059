"""A closed lid of few triangles is lifted, so that the eyeball does not pierce it."""

import numpy as np
import pytest
from numpy.linalg import norm
from scipy.spatial import cKDTree

from risorius.assets.data_files import read_image
from risorius.assets.fitting import fit_head
from risorius.assets.meshes import Mesh
from risorius.bench.subjects import decimated
from risorius.geometry.directions import unit_vectors
from risorius.sim.face_model import build_face_model
from risorius.sim.landmarks import Side
from risorius.sim.lid_lift import lift_off
from risorius.sim.skull import Eyeball
from tests.assets.checks import part_of
from tests.heads import UserHead

CLEARANCE = 0.3  # [mm]
EYEBALL = Eyeball(Side.LEFT, np.array([30.0, 2.0, 70.0]), 13.0)
LID_OUTLINE = np.array([[-6.0, -5.0], [6.0, -5.0], [0.0, 7.0]])  # a triangle before the pupil
LID_FACES = np.array([[0, 1, 2]], np.int32)
FULL_WEIGHTS = np.ones(3)
EARLIER_PLACE = np.array([0.0, 20.0, 0.0])  # an earlier place of a closing lid


def at(beside, distance):
    """Points in front of the ball at this distance [mm] from its centre, shape (n, 3)."""
    ahead = np.sqrt(distance**2 - (beside**2).sum(axis=1))
    return EYEBALL.centre + np.column_stack([beside, ahead])


def lifted(x, lift):
    """Points moved away from the ball by `lift` [mm]."""
    away = x - EYEBALL.centre
    return x + lift[:, None] * unit_vectors(away)


def nearest(x):
    """Smallest distance of a triangle (3, 3) from the ball's centre [mm]."""
    shares = np.random.default_rng(2).dirichlet([1.0, 1.0, 1.0], 20_000)
    return float(norm(shares @ (x - EYEBALL.centre), axis=1).min())


def test_a_flat_triangle_is_lifted_over_the_cornea():
    """A flat triangle whose middle cuts the cornea is lifted until its middle is outside."""
    closed = at(LID_OUTLINE, 14.0)
    rest = closed + EARLIER_PLACE
    assert nearest(closed) < 13.0
    lift = lift_off(closed, rest, LID_FACES, FULL_WEIGHTS, EYEBALL)
    assert (lift > 0.5).all()
    assert 13.0 + CLEARANCE + 0.8 < nearest(lifted(closed, lift)) < 13.0 + CLEARANCE + 1.3


def test_distant_triangles_are_not_lifted():
    """Small triangles at a lid's thickness from the ball, beside the cornea, are not lifted."""
    closed = at(LID_OUTLINE / 20.0 + [11.0, 0.0], 13.0 + CLEARANCE + 0.05)
    assert not lift_off(closed, closed, LID_FACES, FULL_WEIGHTS, EYEBALL).any()


@pytest.mark.parametrize(
    ("faces", "moves", "sunk"),
    [
        (LID_FACES, np.zeros(3), 0.0),  # a lower lid
        (LID_FACES[:, ::-1], FULL_WEIGHTS, 0.0),  # the inner side of a lid
        (LID_FACES, FULL_WEIGHTS, 3.0),  # started inside the ball, under the lid's edge
    ],
    ids=["lower lid", "inner side", "sunk at rest"],
)
def test_other_triangles_are_not_lifted(faces, moves, sunk):
    """Only the outer side of the upper lid is lifted."""
    closed = at(LID_OUTLINE, 14.0)
    rest = at(LID_OUTLINE, 13.0 - sunk) if sunk else closed + EARLIER_PLACE
    assert not lift_off(closed, rest, faces, moves, EYEBALL).any()


def test_the_drawn_eyeball_fits_the_lifted_lids(head):
    """Almost no point of the drawn eyeball is outside the shape that lid_lift.py assumes.

    The shape is a sphere with a cornea.
    """
    for eye in head.eyes:
        ball = Eyeball(Side(eye.name), eye.centre, eye.radius)
        part = part_of(head, f"eyeball_{eye.name}")
        drawn = part.vertices[part.vertices[:, 2] > eye.centre[2] + 1.0].astype(np.float64)
        inward = drawn - CLEARANCE * (drawn - eye.centre) / eye.radius
        tiny = inward[:, None] + [[0.0, 0.0, 0.0], [1e-4, 0.0, 0.0], [0.0, 1e-4, 0.0]]
        faces = np.arange(3 * len(drawn), dtype=np.int32).reshape(-1, 3)
        points = tiny.reshape(-1, 3)
        lift = lift_off(points, points + 2.0 * EARLIER_PLACE, faces, np.ones(len(points)), ball)
        assert lift.reshape(-1, 3)[:, 0] == pytest.approx(2.0 * CLEARANCE, abs=0.12)


def test_shut_lids_of_a_large_coarse_eye_are_no_tents(head, tmp_path):
    """Where few triangles span a large eyeball both lids turn, and neither stands far before it.

    The upper lid alone would be lifted by 3 mm on this head, and by 7 mm on another. The lids show
    no piece of the dark line of lashes.
    """
    marks = head.vertices[head.landmarks]
    vertices = head.vertices
    for eye in (slice(36, 42), slice(42, 48)):
        away = vertices - marks[eye].mean(axis=0)
        near = np.exp(-((norm(away[:, :2], axis=1)[:, None] / 22.0) ** 2))
        vertices = vertices + near * away * [0.7, 1.1, 0.0]
    points, faces = decimated(vertices, head.faces, 1600)
    numbers = cKDTree(points).query(vertices[head.landmarks])[1]
    mesh, marked = UserHead(Mesh(points, faces), numbers).write(tmp_path)
    fitted = fit_head(mesh, marked)
    roots = read_image(head.file_beside("_lids.png"), mode="L") > 128
    assert fitted.albedo[roots].mean() > head.albedo[roots].mean() + 30.0
    lids = build_face_model(fitted).lids.vertices
    assert lids.sink.min() > -2.6
    assert lids.closing[~lids.upper].max() > 0.2
