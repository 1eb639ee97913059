"""A muscle that lies on others is moved along by them, and lifted by their bulge."""

import copy

import numpy as np
import pytest

from risorius import sim
from risorius.sim.fibres import FIBRE_POINTS, SAMPLE_COUNT, move_lines
from tests.sim.poses import settled_displacement, without

UPPER_MUSCLE = "zygomaticus_major"
LOWER_MUSCLE = "buccinator"


def stacked(head, stack, **changes):
    """The head whose only stacked muscles are those of `stack`; `changes` apply to LOWER_MUSCLE."""
    face = without(head)
    face.rig = copy.deepcopy(dict(head.rig))
    for name, muscle in face.rig["muscle"].items():
        muscle["lies_on"] = stack.get(name, [])
    face.rig["muscle"][LOWER_MUSCLE].update(changes)
    return face


def displaced(simulation, muscle):
    """Distances of a relaxed muscle's points from their places at rest, shape (B, n, 3)."""
    now = np.array(simulation.anatomy.fibres()[muscle])
    simulation.reset()
    return now - np.array(simulation.anatomy.fibres()[muscle])


def test_a_muscle_rises_on_the_bulge_beneath(head):
    """Over a thicker buccinator, the relaxed zygomaticus rises farther from the cheekbone."""
    rises = []
    for bulge in (0.0, 5.0, 10.0):
        simulation = sim.create(stacked(head, {UPPER_MUSCLE: [LOWER_MUSCLE]}, bulge=bulge))
        settled_displacement(simulation, {f"{LOWER_MUSCLE}_left": 1.0})
        rises.append(displaced(simulation, f"{UPPER_MUSCLE}_left"))
    outward = np.array([0.7, 0.0, 0.7])
    lifted = [float(((rise - rises[0]) @ outward).max()) for rise in rises]
    assert lifted[1] > 1.5
    assert lifted[2] == pytest.approx(2.0 * lifted[1])
    assert np.abs(rises[0]).max() > 2.0  # it moves along even without a bulge


def test_only_muscles_beneath_move_a_muscle(head):
    """A muscle is not moved by one it does not lie on, nor by one of the other side."""
    apart = sim.create(stacked(head, {}))
    settled_displacement(apart, {f"{LOWER_MUSCLE}_left": 1.0})
    assert not displaced(apart, f"{UPPER_MUSCLE}_left").any()
    stack = sim.create(stacked(head, {UPPER_MUSCLE: [LOWER_MUSCLE]}))
    settled_displacement(stack, {f"{LOWER_MUSCLE}_left": 1.0})
    assert not displaced(stack, f"{UPPER_MUSCLE}_right").any()


def test_carrying_is_the_formula(simulation, model, state):
    """Points of a muscle's line move with weighted motions of the lines below, as in numpy.

    The weights of a point sum to at most 1.
    """
    muscles = model.muscles
    pose = model.skull.mandible_motion(0.5, 0.3, 0.2)
    activation = np.linspace(-0.2, 1.0, len(muscles.names))
    stack = muscles.stack
    bundle = muscles.bundle
    motion = state.lines
    move_lines(bundle, stack, activation, pose, motion)
    active = np.maximum(activation, 0.0)[bundle.muscle]
    carried = np.zeros_like(motion.carried)
    shares = np.zeros(carried.shape[:2])
    owner = np.repeat(np.arange(len(carried)), np.diff(stack.rows))
    for row, b in enumerate(owner):
        p = int(stack.point[row])
        c = int(stack.line[row])
        assert c < b
        steady = active[c] * stack.steady[row]
        steady = steady + bundle.mandible[b, p] * (pose.rotation @ steady - steady)
        beneath = np.zeros(3)
        for k in range(3):
            if active[c] > 0.0:
                along = motion.contracted[c, :, k]
                beneath[k] += np.interp(stack.sample[row], np.arange(SAMPLE_COUNT), along)
            beneath[k] += np.interp(stack.place[row], np.arange(FIBRE_POINTS), carried[c, :, k])
        carried[b, p] += steady + stack.weight[row] * beneath
        shares[b, p] += stack.weight[row]
    assert 0.9 < shares.max() < 1.0 + 1e-9
    assert np.array_equal(motion.is_carried, np.abs(carried).max(axis=(1, 2)) > 0.0)
    assert np.allclose(motion.carried[motion.is_carried], carried[motion.is_carried], atol=1e-9)
