"""Cameras, poses and gazes as numbers: compared with OpenGL's matrices and the face's pose."""

import json
import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from pytest import approx

from risorius import render
from risorius.app.passes.camera import CameraLabels
from risorius.app.passes.labels import gaze, labels_of
from risorius.app.scenes import PlaneScene

PICTURE_SIZES = st.tuples(st.integers(16, 4000), st.integers(16, 4000))
CAMERA_ANGLES = {"yaw": st.floats(-180.0, 180.0), "pitch": st.floats(-89.0, 89.0)}


def camera_at(yaw, pitch):
    """A camera at the head's height, beside its middle."""
    camera = render.OrbitCamera.framing(np.array([[-80.0, -160.0, -90.0], [80.0, 130.0, 120.0]]))
    camera.orbit(yaw, pitch)
    camera.pan(0.1, -0.05)
    return camera


@settings(max_examples=60, deadline=None)
@given(size=PICTURE_SIZES, **CAMERA_ANGLES)
def test_points_are_projected_where_opengl_draws_them(size, yaw, pitch):
    """K, R and t agree with the shaders' matrices; pixels count from the upper left corner."""
    camera = camera_at(yaw, pitch)
    width, height = size
    points = np.random.default_rng(1).uniform(-80.0, 80.0, (20, 3))
    labels = CameraLabels.from_camera(camera, size)
    matrix = np.asarray(camera.view_matrix()) @ np.asarray(camera.projection_matrix(width / height))
    clip = np.column_stack([points, np.ones(20)]) @ matrix
    x, y = (clip[:, :2] / clip[:, 3:]).T
    expected = np.column_stack([0.5 * (1.0 + x) * width, 0.5 * (1.0 - y) * height])
    assert np.allclose(labels.project(points), expected, atol=1e-6 * max(size))
    assert np.allclose(labels.to_camera(points)[:, 2], clip[:, 3])
    assert np.allclose(labels.rotation @ labels.rotation.T, np.eye(3))
    assert math.isclose(np.linalg.det(labels.rotation), 1.0)


@settings(max_examples=25, deadline=None)
@given(yaw=st.floats(-80.0, 80.0), pitch=st.floats(-60.0, 60.0))
def test_a_head_at_rest_is_turned_as_the_camera_is_not(scene, yaw, pitch):
    """From the subject's left, a head's yaw is to its right; from above, its pitch is downward."""
    scene.reset()
    camera = camera_at(yaw, pitch)
    size = (640, 480)
    pose = labels_of(scene, camera, size)["head"]
    points = scene.rest_positions
    rotation = np.array(pose["R"])
    seen = CameraLabels.from_camera(camera, size).to_camera(points)
    assert np.allclose(points @ rotation.T + pose["t"], seen, atol=1e-5)
    towards_camera = camera_at(yaw, pitch).axes()[2]  # in the head's axes
    assert math.copysign(1.0, pose["yaw"]) == -math.copysign(1.0, yaw) or abs(yaw) < 1e-6
    sine = math.sin(math.radians(pose["pitch"]))
    bowed = -math.sin(math.radians(pitch)) * math.cos(math.radians(yaw))
    assert sine == approx(bowed, abs=1e-9)
    facing = -rotation[2, 2]
    assert facing == approx(towards_camera[2])


def test_angles_are_those_that_the_head_was_turned_by(face):
    """For a camera in front, the angles are those to which the head was turned.

    They are to the left, up, and to the left shoulder, alone and together. The head's axes are
    found by landmarks, and are 2 degrees off those of the scene.
    """
    names = ("yaw", "pitch", "roll")

    def turned(*values):
        """The angles of a head with these values of its controls."""
        face.reset()
        face.pose({f"head_{name}": value for name, value in zip(names, values, strict=True)})
        face.step(1.0)
        pose = labels_of(face, camera_at(0.0, 0.0), (640, 480))["head"]
        return [pose[name] for name in names]

    alone = np.array([turned(*row) for row in np.eye(3)])
    most = alone.diagonal()
    assert (most > 10.0).all()
    assert np.abs(alone - np.diag(most)).max() < 3.7
    for values in ((0.7, -0.5, 0.4), (-1.0, 0.8, -0.6)):
        assert np.abs(turned(*values) - most * values).max() < 4.0


def test_eyes_look_where_they_were_set(face):
    """Gaze of each eye in the scene: straight ahead at rest; x to the subject's left, y up."""
    face.reset()
    assert np.allclose(gaze(face.face, "right"), [0.0, 0.0, 1.0])
    face.pose({"gaze_horizontal_left": 1.0, "gaze_vertical_right": 1.0})
    face.step(2.0)
    assert gaze(face.face, "left")[0] > 0.3
    assert abs(gaze(face.face, "left")[1]) < 0.015
    assert gaze(face.face, "right")[1] > 0.3
    assert abs(gaze(face.face, "right")[0]) < 0.01


def test_labels_have_controls_and_activations(face):
    """Labels have the controls that were set, and activations other than 0.

    All are plain numbers that JSON can store.
    """
    face.reset()
    face.pose({"AU12_left": 0.5})
    face.step(0.5)
    labels = labels_of(face, camera_at(0.0, 0.0), (64, 48))
    assert labels["controls"] == {"AU12_left": 0.5}
    assert labels["activations"]
    assert all("left" in name for name in labels["activations"])
    assert json.loads(json.dumps(labels, allow_nan=False)) == labels
    assert "landmarks" not in labels
    assert (labels["camera"]["width"], labels["camera"]["height"]) == (64, 48)
    plane = labels_of(PlaneScene(), camera_at(0.0, 0.0), (64, 48))
    assert set(plane) == {"camera", "controls"}
