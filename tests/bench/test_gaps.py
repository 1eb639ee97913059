"""Closed lips and lids stay closed, and what measures it sees what is open."""

import pytest

from risorius.bench.gaps import LIDS_MOST, LIPS_MOST, PoseGaps, measure


@pytest.fixture(scope="module")
def poses() -> dict[str, PoseGaps]:
    """Every pose, measured once."""
    return {pose.name: pose for pose in measure()}


@pytest.mark.slow
def test_closed_lips_stay_closed(poses: dict[str, PoseGaps]) -> None:
    """No unit parts the lips but those that are there for it, on either side or on both."""
    slits = {name: pose.lips for name, pose in poses.items() if pose.lips is not None}
    assert len(slits) > 70
    assert {"AU12", "AU12_left", "AU17", "AU28", "AU29", "kiss"} < set(slits)
    assert {name: slit for name, slit in slits.items() if slit >= LIPS_MOST} == {}


@pytest.mark.slow
def test_shut_eyes_are_shut(poses: dict[str, PoseGaps]) -> None:
    """No eyeball is seen through closed lids, whatever else the face does."""
    gaps = {name: pose.lids for name, pose in poses.items() if pose.lids is not None}
    assert {"AU43", "AU43_left", "AU45_right", "AU46_left", "blink", "wink", "yawn"} <= set(gaps)
    assert {name: gap for name, gap in gaps.items() if gap >= LIDS_MOST} == {}
