"""Closed lips and lids stay closed, and the measure detects gaps."""

import numpy as np
import pytest

from risorius.bench.gaps import LARGEST_FAULTS, MeasuredPose, inverted_count, measure


@pytest.fixture(scope="module")
def poses() -> dict[str, MeasuredPose]:
    """Every pose with its measured gaps."""
    return {pose.name: pose for pose in measure(0)}


@pytest.mark.slow
def test_closed_lips_stay_closed(poses):
    """The lips part, on one side or both, only for action units that open the mouth."""
    slits = {name: pose.slit for name, pose in poses.items() if pose.slit is not None}
    assert len(slits) > 70
    assert {"AU12", "AU12_left", "AU17", "AU28", "AU29", "kiss"} < set(slits)
    assert {name: slit for name, slit in slits.items() if slit >= LARGEST_FAULTS["slit"]} == {}


@pytest.mark.slow
def test_shut_eyes_are_shut(poses):
    """No eyeball is visible through closed lids, in any pose of the face."""
    gaps = {name: pose.eye for name, pose in poses.items() if pose.eye is not None}
    assert {"AU43", "AU43_left", "AU45_right", "AU46_left", "blink", "wink", "yawn"} <= set(gaps)
    assert {name: gap for name, gap in gaps.items() if gap >= LARGEST_FAULTS["eye"]} == {}


def test_a_folded_triangle_is_counted(head):
    """A folded triangle is counted, but a patch of skin that turned as a whole is not."""
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    over = turn @ np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])
    now = head.vertices @ over.T
    assert inverted_count(head.vertices, now, head.faces) == 0
    tip = head.anatomy["cheilion_left"]
    ring = np.unique(head.faces[(head.faces == tip).any(axis=1)])
    away = head.vertices[ring[ring != tip]]
    farthest = away[np.linalg.norm(away - head.vertices[tip], axis=1).argmax()]
    now[tip] = (2.0 * farthest - head.vertices[tip]) @ over.T
    assert inverted_count(head.vertices, now, head.faces) >= 1
