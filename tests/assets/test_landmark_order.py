"""Landmarks in a wrong order are refused by name; correct ones are accepted, however rough."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.linalg import norm

from risorius import assets
from risorius.assets import AssetError
from risorius.assets.fitting import fit, fit_head
from risorius.assets.fitting.landmark_file import (
    LANDMARK_GROUPS,
    groups_in_disorder,
    landmarks_text,
    read_landmarks,
)
from risorius.assets.meshes import Mesh
from tests.heads import UserHead, shape, user_head

HEAD = assets.load("head")
TEMPLATE = HEAD.vertices[HEAD.landmarks]
ROUGHNESS = 2.0  # [mm]


@pytest.fixture(scope="module")
def other() -> UserHead:
    """A head of another shape, with a closed mouth."""
    return user_head()


@settings(deadline=None, max_examples=60)
@given(seed=st.integers(0, 2**32 - 1), stretch=st.tuples(*[st.floats(0.85, 1.15)] * 3))
def test_right_landmarks_are_accepted(seed, stretch):
    """Landmarks of another, stretched head are accepted, although each is up to 2 mm off."""
    random = np.random.default_rng(seed)
    away = random.normal(size=(68, 3))
    away *= ROUGHNESS * random.random((68, 1)) / norm(away, axis=1, keepdims=True)
    assert not groups_in_disorder(shape(TEMPLATE) * stretch + away, TEMPLATE)


@pytest.mark.parametrize("group", LANDMARK_GROUPS, ids=lambda group: group.name)
@settings(deadline=None, max_examples=10)
@given(data=st.data())
def test_a_group_in_another_order_is_named(group, data):
    """A group of landmarks that is reversed or rotated (or both) is reported, at any place."""
    own = np.arange(group.first, group.first + group.count)
    orders = [np.roll(own[::way], by) for way in (1, -1) for by in range(group.count)]
    orders = [each for each in orders if _moves(own, each) > 5.0]
    order = data.draw(st.sampled_from(orders))
    points = shape(TEMPLATE)
    points[own] = points[order] + data.draw(st.tuples(*[st.floats(-8.0, 8.0)] * 3))
    assert group in groups_in_disorder(points, TEMPLATE)


def _moves(own, order):
    """Mean motion [mm] of the points of a group when they are put in an order."""
    return float(norm(TEMPLATE[own] - TEMPLATE[order], axis=1).mean())


@pytest.mark.parametrize("group", LANDMARK_GROUPS, ids=lambda group: group.name)
def test_a_group_in_disorder_is_refused_in_one_line(group, other):
    """A reversed group, or one with sides swapped, is refused in one line.

    The line has the group's numbers and the right order.
    """
    numbers = other.landmarks.copy()
    own = slice(group.first, group.first + group.count)
    is_pair = group.name.startswith("two")
    numbers[own] = np.roll(numbers[own], group.count // 2) if is_pair else numbers[own][::-1]
    with pytest.raises(AssetError, match=f"^landmarks {group.first} to .*{group.right_order}"):
        fit(other.mesh, numbers)


def test_numbers_counted_from_1_are_refused(other, tmp_path):
    """Vertex indices that are one too high, as if counted from 1, are refused."""
    mesh, numbers = other.write(tmp_path, landmarks=other.landmarks + 1)
    with pytest.raises(AssetError, match=r"\.obj: vertex indices of the landmarks count from 1"):
        fit_head(mesh, numbers)


def test_a_point_on_a_lash_means_the_skin_beneath(other, tmp_path):
    """A point on a lash or eyeball, hit by a click, is moved to the skin behind it."""
    points = other.mesh.vertices[other.landmarks]
    count = len(other.mesh.vertices)
    lash = points[36] + 0.001 * np.eye(3)
    faces = np.vstack([other.mesh.faces, [[count, count + 1, count + 2]]]).astype(np.int32)
    mesh = Mesh(np.vstack([other.mesh.vertices, lash]), faces)
    points[36] = lash.mean(axis=0)
    marks = tmp_path / "marks.json"
    marks.write_text(landmarks_text(dict(enumerate(points.tolist()))))
    assert read_landmarks(marks, mesh)[0].tolist() == other.landmarks.tolist()


@pytest.mark.parametrize("by", [1, -1, 5])
def test_a_list_that_begins_elsewhere_is_refused(by, other):
    """A list that begins at another landmark is refused, since all places are wrong."""
    with pytest.raises(AssetError, match="landmark"):
        fit(other.mesh, np.roll(other.landmarks, by))
