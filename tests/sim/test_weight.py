"""Loads of weight and inertia: their size and direction, beside mechanics done by hand."""

from __future__ import annotations

import numpy as np
import pytest

from risorius.sim.integrator import substeps_in, ticks_in
from risorius.sim.skull import REST, RigidMotion
from risorius.sim.tissue import AREAL_MASS
from risorius.sim.weight import Weight

TICK = 1.0 / 60.0
AREA, HEAVINESS = 2.0, 0.25
MASS = AREA * AREAL_MASS * HEAVINESS  # that is free to hang
SIDE = np.array([[100.0, 0.0, 0.0]])  # mm from the joint


def _turned(axis: int, angle: float) -> RigidMotion:
    """The head turned about the x (0) or y (1) axis through the origin."""
    c, s = np.cos(angle), np.sin(angle)
    rows = {0: [[1, 0, 0], [0, c, -s], [0, s, c]], 1: [[c, 0, s], [0, 1, 0], [-s, 0, c]]}
    return RigidMotion(np.array(rows[axis], dtype=np.float64), np.zeros(3))


def _load(weight: Weight, *poses: RigidMotion) -> np.ndarray:
    """The load on skin at SIDE in the last of some poses, one tick apart."""
    force = np.zeros((1, 3))
    for pose in poses:
        force[:] = 0.0
        weight.add(pose, TICK, SIDE, force)
    return force[0]


def test_a_head_that_lies_on_its_back_sags_backward() -> None:
    """Face up, weight no longer pulls down the face but toward its back; upright it is at rest."""
    weight = Weight(np.array([AREA]), HEAVINESS, gravity=True, inertia=False)
    assert _load(weight, REST).tolist() == [0.0, 0.0, 0.0]
    face_up = _turned(0, -np.pi / 2.0)
    assert (face_up.rotation @ [0.0, 0.0, 1.0]).round(9).tolist() == [0.0, 1.0, 0.0]
    assert _load(weight, face_up) == pytest.approx(MASS * np.array([0.0, 9810.0, -9810.0]))


def test_a_head_that_turns_steadily_throws_skin_outward() -> None:
    """Centrifugal load, mass x speed² x radius, once the turn no longer changes."""
    weight = Weight(np.array([AREA]), HEAVINESS, gravity=False, inertia=True)
    speed = 3.0  # rad/s
    load = _load(weight, *[_turned(1, speed * TICK * tick) for tick in range(1, 6)])
    # A second difference sees the turn of half the last two ticks, hence the tolerance.
    assert load == pytest.approx(MASS * speed**2 * np.array([100.0, 0.0, 0.0]), abs=0.06 * 450.0)


def test_skin_stays_behind_a_head_that_sets_off() -> None:
    """A head that is pushed forward leaves its skin behind by mass x acceleration, once."""
    weight = Weight(np.array([AREA]), HEAVINESS, gravity=False, inertia=True)
    turned = _turned(1, 1e-6)  # heads move by turning alone; so little does nothing itself
    pushed = RigidMotion(turned.rotation, np.array([0.0, 0.0, 0.5]))
    load = _load(weight, pushed)
    assert load == pytest.approx([0.0, 0.0, -MASS * 0.5 / TICK**2], abs=0.5)
    weight.forget()
    assert _load(weight, REST).tolist() == [0.0, 0.0, 0.0]


def test_frames_are_cut_evenly() -> None:
    """Ticks of 1/60 s and substeps of 1/300 s at most, but for a rounding of 2 %."""
    assert [ticks_in(dt) for dt in (1 / 240, 1 / 60, 0.0167, 0.0171, 1 / 30, 1 / 20)] == [
        1, 1, 1, 2, 2, 3,
    ]  # fmt: skip
    assert [substeps_in(tick) for tick in (1 / 300, 1 / 240, 1 / 120, 1 / 60)] == [1, 2, 3, 5]
