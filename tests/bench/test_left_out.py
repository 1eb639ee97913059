"""Leaving a scanned shape out: muscles lose what was fitted, and other shapes give it back."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from risorius import assets, sim
from risorius.bench.left_out import KEPT, measure, typical
from risorius.sim.rig import LinearMuscle, Muscle, RingMuscle
from tests.sim.poses import settled_displacement

MUSCLES = sim.read_rig(assets.load("head").rig).muscles
FITTED = [muscle for muscle in MUSCLES if isinstance(muscle, LinearMuscle | RingMuscle)]


@pytest.mark.parametrize("muscle", FITTED, ids=lambda muscle: muscle.name)
def test_a_typical_muscle_has_nothing_fitted(muscle: Muscle) -> None:
    """It keeps its place and its nature, and has all else of the others of its kind."""
    others = [each for each in FITTED if type(each) is type(muscle) and each is not muscle]
    bare = typical(muscle, others)
    for rule in fields(muscle):
        value = getattr(bare, rule.name)
        if rule.name == "fibres":
            assert isinstance(muscle, LinearMuscle)
            for now, was in zip(value, muscle.fibres, strict=True):
                assert (now.origin, now.insertion) == (was.origin, was.insertion)
                assert (now.gain, now.weight, now.convergence, now.lift) == (1.0, 1.0, 0.0, 0.0)
        elif rule.name in KEPT:
            assert value == getattr(muscle, rule.name)
        else:
            lower, upper = (
                np.quantile([getattr(each, rule.name) for each in others], share, axis=0)
                for share in (0.4, 0.6)
            )
            assert (lower <= value).all()
            assert (value <= upper).all()


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
