"""Leaving a scanned shape out: muscles lose what was fitted, and other shapes give it back."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from risorius import assets, sim
from risorius.bench.left_out import KEPT, measure, plain
from risorius.sim.rig import LinearMuscle, Muscle, RingMuscle
from tests.sim.poses import settled_displacement

MUSCLES = sim.read_rig(assets.load("head").rig).muscles


@pytest.mark.parametrize("muscle", MUSCLES, ids=lambda muscle: muscle.name)
def test_a_plain_muscle_has_nothing_fitted(muscle: Muscle) -> None:
    """It keeps its place and its nature, and shares all else with any other of its kind."""
    bare = plain(muscle)
    defaults = {each.name: each.default for each in fields(muscle)}
    for each in fields(muscle):
        value = getattr(bare, each.name)
        if each.name == "fibres":
            assert isinstance(muscle, LinearMuscle)
            for now, was in zip(value, muscle.fibres, strict=True):
                assert (now.origin, now.insertion) == (was.origin, was.insertion)
                assert (now.gain, now.weight, now.convergence, now.lift) == (1.0, 1.0, 0.0, 0.0)
        elif each.name in KEPT:
            assert value == getattr(muscle, each.name)
        else:
            assert value == defaults[each.name]


def test_muscles_are_exchanged_as_if_built_with_them() -> None:
    """A trial's face is the one that `sim.create` builds from the same rig."""
    head = assets.load("head")
    trial = sim.Trial(head)
    simulation = trial.simulation(trial.rig)
    pose = {"zygomaticus_major_left": 1.0, "orbicularis_oris_roll_lower": 1.0}
    built = settled_displacement(sim.create(head), pose)
    np.testing.assert_array_equal(settled_displacement(simulation, pose), built)


@pytest.mark.slow
def test_other_shapes_teach_a_muscle(tmp_path: Path) -> None:
    """A head that moves as the rig does: a shape is known, and worse without having been seen."""
    head = assets.load("head")
    simulation = sim.create(head)
    names = ("mouthSmileLeft", "mouthDimpleLeft", "browDownLeft", "jawOpen")
    moved = {name: settled_displacement(simulation, {name: 1.0}) for name in names}
    np.savez(
        tmp_path / "face.npz",
        vertices=head.vertices, triangles=head.faces, landmarks68=head.landmarks, **moved,
    )  # fmt: skip
    rows = {row.shape: row for row in measure(tmp_path)}
    assert {name: row.others for name, row in rows.items()} == {
        "mouthSmileLeft": 1, "mouthDimpleLeft": 1, "browDownLeft": 0,
    }  # fmt: skip
    for row in rows.values():
        assert row.fitted > 0.9
        assert -1.0 <= row.left_out < row.fitted


def test_sphincters_are_among_them() -> None:
    """The rig has both kinds that are fitted, or the tests above say little."""
    assert {type(muscle) for muscle in MUSCLES} >= {LinearMuscle, RingMuscle}
