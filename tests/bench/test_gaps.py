"""Closed lips and lids stay closed, and what measures it sees what is open."""

import pytest

from risorius import assets, sim
from risorius.bench.gaps import (
    LIDS_MOST,
    LIPS_MOST,
    PoseGaps,
    eyeballs_of,
    lid_gaps,
    measure,
)
from risorius.bench.subjects import settled_positions


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


@pytest.mark.slow
def test_closed_lids_hide_the_eye_from_every_side() -> None:
    """Nothing shows from the whole front while lids are closed; ajar, they show it from below."""
    head = assets.load("head")
    simulation = sim.create(head)
    gaps = {}
    for name, closed in (("shut", 1.0), ("ajar", 0.8)):
        settled_positions(simulation, {"AU43": closed}, 45)
        landmarks = simulation.positions[head.landmarks]
        balls = eyeballs_of(head, simulation)
        gaps[name] = lid_gaps(simulation.positions, simulation.faces, landmarks, balls)
    assert max(gaps["shut"].values()) < LIDS_MOST
    assert min(gaps["ajar"].values()) > 1.0
