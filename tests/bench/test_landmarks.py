"""The benchmark of landmarks: errors of a detector, and the message without the detector."""

import json

import numpy as np
import PIL.Image
from pytest import approx

from risorius.bench import landmarks
from risorius.sim.landmarks import MIRRORED_LANDMARKS
from tests.app.command_line import succeeded

FACE = np.random.default_rng(3).uniform(40.0, 60.0, (68, 2))
FACE[36] = 30.0, 50.0
FACE[45] = 70.0, 50.0
FACE[37:42] = 36.0, 50.0
FACE[42:45] = 64.0, 50.0
FACE[46:48] = 64.0, 50.0


def labels_of_face(yaw=0.0, mask="none"):
    """Labels of a flat face 500 mm before a camera with one pixel per millimetre."""
    points = np.column_stack([FACE, np.full(68, 500.0)])
    return {
        "camera": {
            "K": [[500.0, 0, 0], [0, 500.0, 0], [0, 0, 1]],
            "R": np.eye(3).tolist(),
            "t": [0.0, 0.0, 0.0],
        },
        "head": {"yaw": yaw},
        "landmarks": {"pixels": FACE.tolist(), "points": points.tolist()},
        "person": {"mask": mask},
    }


def test_an_error_is_relative_to_the_distance_of_the_eyes():
    """An error of two pixels for eyes 40 pixels apart is 5 %, sideways as well as downward."""
    errors = landmarks.errors_of(FACE + np.array([2.0, -1.0]), labels_of_face())
    assert np.allclose(errors, [5.0, -2.5])


def measured(folder, labels, points):
    """Errors on pictures with these labels, for a detector that returns the same points."""
    for number, each in enumerate(labels):
        (folder / f"{number:06d}.json").write_text(json.dumps(each))
        PIL.Image.new("RGB", (8, 8)).save(folder / f"{number:06d}.png")
    return landmarks.measure(folder, "dlib", lambda image: points)


def test_a_constant_part_is_one_on_both_sides(tmp_path):
    """A constant offset of both mouth corners, 3 % outward, is found.

    Other points have no offset.
    """
    outward = np.zeros((68, 2))
    outward[48, 0] = -1.2
    outward[54, 0] = 1.2
    labels = [labels_of_face(20.0 * number) for number in range(3)]
    found = measured(tmp_path, labels, FACE + outward)
    assert found.is_frontal.tolist() == [True, False, False]
    assert found.constant[54] == approx([3.0, 0.0])
    assert np.count_nonzero(np.abs(found.constant) > 1e-9) == 2
    text = landmarks.report(found)
    assert "48, 54       3.0    0.0" in text
    met = [target.is_met for target in landmarks.targets(found)]
    assert met == [True, False]


def test_a_missed_face_is_counted_and_does_not_change_the_median(tmp_path):
    """A picture in which a detector misses the face is counted, and the median ignores it."""
    found = [FACE + np.array([each, 0.0]) for each in (20.0, 0.8, 0.4)]
    for number in range(3):
        (tmp_path / f"{number:06d}.json").write_text(json.dumps(labels_of_face()))
        PIL.Image.new("RGB", (8, 8)).save(tmp_path / f"{number:06d}.png")
    finding = landmarks.measure(tmp_path, "dlib", lambda image: found.pop())
    text = landmarks.report(finding)
    assert "frontal pictures: median 2.00 %; the detector misses the face in 1 (above 10 %)" in text


def test_masked_persons_are_left_out(tmp_path):
    """Persons with masks are left out, because a detector can only guess the covered points."""
    found = measured(tmp_path, [labels_of_face(mask=mask) for mask in ("none", "white")], FACE)
    assert (found.picture_count, len(found.yaw)) == (1, 1)


def test_a_tracker_s_mesh_gives_all_68_points():
    """The mesh of a tracker gives all 68 points, and each left point mirrors one on the right."""
    mesh = np.random.default_rng(1).uniform(0.0, 100.0, (478, 2))
    points = landmarks.points_of_mesh(mesh)
    assert points.shape == (68, 2)
    assert np.isfinite(points).all()
    left = {number for number in range(68) if number not in landmarks.RIGHT_LANDMARKS}
    assert {
        int(MIRRORED_LANDMARKS[number]) for number in left if MIRRORED_LANDMARKS[number] != number
    } == (landmarks.RIGHT_LANDMARKS)


def test_without_the_detector_one_line_says_so(tmp_path, monkeypatch):
    """The detector is an optional extra: its absence is reported in one line."""
    monkeypatch.setattr(landmarks, "is_installed", lambda name: False)
    output = succeeded("bench", "landmarks", tmp_path, "--detector", "dlib")
    assert output == "skipped: dlib is not installed; pip install '.[dlib]' brings it\n"
