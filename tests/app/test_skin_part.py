"""Lashes and tears follow every motion of the skin."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.linalg import norm
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from risorius import assets
from risorius.app.scenes.bent_part import FaceNow
from risorius.app.scenes.skin_part import SkinPart
from risorius.geometry.transforms import moved_points
from tests.sim.poses import advance

POSES = (
    {"AU43": 1.0},
    {"wink": 1.0},
    {"gaze_vertical": 1.0},
    {"gaze_vertical": -1.0},
    {"fear": 1.0},
    {"head_turn": 0.6},
)


def attached(scene):
    """Parts attached to the skin."""
    return [part for part in scene.parts if isinstance(part, SkinPart)]


@settings(max_examples=20, deadline=None)
@given(
    st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=3),
    st.lists(st.floats(-50.0, 50.0), min_size=3, max_size=3),
)
def test_a_skin_that_only_moves_takes_them_along(scene, turn, shift):
    """A rotation and shift of the whole skin moves the parts; their bone's motion does not."""
    turned = Rotation.from_rotvec(turn)
    skin = turned.apply(np.array(scene.rest_positions)) + shift
    bone = np.eye(4)
    bone[:3, :3] = turned.as_matrix()
    bone[:3, 3] = shift
    made = {part.name: part for part in assets.load("head").parts}
    for part in attached(scene):
        part.follow(FaceNow(skin, {part.bone: np.eye(4)}))
        expected = turned.apply(np.array(made[part.name].vertices, np.float64)) + shift
        assert np.allclose(part.vertices, expected, atol=1e-3)
        part.follow(FaceNow(skin, {part.bone: bone}))
        assert np.allclose(part.vertices, made[part.name].vertices, atol=1e-3)


def test_slivers_carry_nothing(scene):
    """Slivers of 1 mm and 1e-11 mm at the roots, possible in files, change no lash."""
    skin = np.array(scene.rest_positions)
    for part in assets.load("head").parts:
        if part.roots is not None:
            roots = part.vertices[np.unique(part.roots)].astype(np.float64)
            ways = np.array([(-0.5, 0.0, 0.0), (0.5, 0.0, 0.0), (0.0, 1e-11, 0.0)])
            corners = [roots + way for way in ways]
            littered = np.vstack([skin, *corners])
            needles = np.arange(len(skin), len(littered)).reshape(3, -1).T
            faces = np.vstack([needles, scene.faces]).astype(scene.faces.dtype)
            plain = SkinPart(part, skin, scene.faces)
            other = SkinPart(part, littered, faces)
            bones = {part.bone: np.eye(4)}
            plain.follow(FaceNow(1.1 * skin, bones))
            other.follow(FaceNow(1.1 * littered, bones))
            assert np.array_equal(other.vertices, plain.vertices)


@pytest.mark.parametrize("pose", POSES, ids=lambda pose: next(iter(pose)))
def test_they_stay_on_lids_that_move(scene, pose):
    """Roots stay within a millimetre of the skin; lashes keep their length, outside the eye."""
    scene.reset()
    scene.pose({name: value for name, value in pose.items() if name in scene.limits})
    advance(scene, 40)
    made = {part.name: part for part in assets.load("head").parts}
    bones = scene.bone_transforms()
    corners = scene.positions[scene.faces]
    tree = cKDTree(np.vstack([corners.mean(axis=1), scene.positions]))
    for part in attached(scene):
        matrix = bones[part.bone]
        there = moved_points(matrix, part.vertices)
        roots = made[part.name].roots
        assert roots is not None
        assert tree.query(there[roots])[0].max() < 2.5
        lengths = [
            norm(points - points[roots], axis=1)
            for points in (part.vertices, made[part.name].vertices)
        ]
        if part.strand_radius:
            assert np.allclose(*lengths, atol=1e-3)
            for eye in scene.head.eyes:
                centre = moved_points(matrix, eye.centre)
                assert norm(there - centre, axis=1).min() > eye.radius - 0.5
    scene.reset()
