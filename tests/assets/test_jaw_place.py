"""The jaw of a user's head turns about an axis in front of its ears."""

import numpy as np
import pytest

from risorius.assets.fitting.jaw_place import jaw_axis_of, with_human_opening


def found_axis(head, size):
    """The axis found on a head whose ears and other parts are scaled by `size`."""
    vertices = head.vertices * size
    return jaw_axis_of(vertices, head.faces, vertices[head.landmarks])


def test_condyles_are_found_in_front_of_the_ears(head):
    """On the built-in head the condyles are found within 3 mm of the anatomy's places."""
    axis = found_axis(head, np.ones(3))
    assert np.abs(axis - head.jaw_axis).max() < 3.0


@pytest.mark.parametrize("depth", [0.9, 1.1])
def test_condyles_follow_the_ears(head, depth):
    """In a flatter or deeper head, the axis moves with the ears."""
    axis = found_axis(head, np.array([1.0, 1.0, depth]))
    wanted = head.jaw_axis * (1.0, 1.0, depth)
    assert np.abs(axis - wanted)[:, 2].max() < 5.0


def test_without_ears_landmarks_give_the_axis(head):
    """If a mask ends before its ears, the axis is within 8 mm of that with ears; once 37 mm."""
    is_front = head.vertices[:, 2] > head.vertices[head.anatomy["tragion_left"], 2] + 15.0
    faces = head.faces[is_front[head.faces].all(axis=1)]
    axis = jaw_axis_of(head.vertices, faces, head.vertices[head.landmarks])
    assert np.abs(axis - head.jaw_axis).max() < 8.0


def test_the_opening_grows_with_the_mandible(head):
    """Heads of any size open by the same fraction of the distance from axis to teeth."""
    points = head.vertices[head.landmarks]
    rig = with_human_opening(head.rig, head.jaw_axis, points)
    angle = np.radians(rig["jaw"]["opening_deg"])
    down, forward = (points[66] - head.jaw_axis.mean(axis=0))[1:] * (-1.0, 1.0)
    sunk = forward * np.sin(angle) - down * (1.0 - np.cos(angle))
    sunk -= rig["jaw"]["opening_glide"][1]
    receded = forward * (1.0 - np.cos(angle)) + down * np.sin(angle)
    receded -= rig["jaw"]["opening_glide"][2]
    assert np.hypot(sunk, receded) == pytest.approx(0.375 * np.hypot(down, forward), abs=0.1)
