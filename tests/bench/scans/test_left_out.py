"""Leaving a scanned shape out: a rig is fitted from anatomy to the other shapes alone."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from risorius import assets, sim
from risorius.bench.scans.bones_and_lids import framed
from risorius.bench.scans.left_out import measure
from risorius.bench.scans.muscle_numbers import NATURE, Numbers, anatomical, parts_of, with_parts
from risorius.bench.scans.statics import Statics
from risorius.sim.rig import LinearMuscle, RingMuscle
from tests.sim.poses import settled_displacement

SMILE = {"zygomaticus_major_left": 0.8}


def test_anatomy_holds_nothing_that_was_fitted() -> None:
    """Another rig of the same muscles, whatever its numbers, begins with the same anatomy."""
    document = assets.load("head").rig
    other = {
        name: {key: value for key, value in table.items() if key in NATURE}
        | ({"fibre": table["fibre"][:1]} if "fibre" in table else {})
        for name, table in document["muscle"].items()
    }
    known, bare = anatomical(document), anatomical({"muscle": other})
    assert known.parts["jaw"] == bare.parts["jaw"]
    assert known.parts["eyes"] == bare.parts["eyes"]
    for row in known.rows.values():
        for name in row:
            if not name.startswith("jaw_"):
                assert known.parts[name] == bare.parts[name]
                assert name in tomllib.loads(Path("bench/scans/anatomy.toml").read_text())["muscle"]


def test_shared_changes_are_mirrored_from_lip_to_lip() -> None:
    """What the upper part of a ring learns goes to the lower one, up and down exchanged."""
    muscles = anatomical(assets.load("head").rig).parts
    pair = [f"incisivus_labii_{part}oris" for part in ("superi", "inferi")]
    numbers = Numbers(muscles, pair)
    own = len(numbers.all)
    changes = np.zeros(numbers.count)
    for path in (("push", 1), ("radii", 1)):
        first = next(j for j, number in enumerate(numbers.all) if number.path == path)
        changes[own:] += numbers.sharing[first]
    upper, lower = (numbers.parts(changes)[name] for name in pair)
    was = [muscles[name] for name in pair]
    assert all(isinstance(each, RingMuscle) for each in (upper, lower, *was))
    moved = [n.push[1] - w.push[1] for n, w in zip((upper, lower), was, strict=False)]
    assert moved == pytest.approx([4.0, -4.0])
    assert upper.radii[1] == pytest.approx(was[0].radii[1] + 4.0)
    assert lower.radii[2] == pytest.approx(was[1].radii[2] + 4.0)


@pytest.mark.slow
def test_muscles_are_exchanged_as_if_built_with_them() -> None:
    """A trial's face is the one that `sim.create` builds from the same rig."""
    head = assets.load("head")
    trial = sim.Trial(head)
    simulation = trial.simulation(trial.rig)
    pose = {"zygomaticus_major_left": 1.0, "orbicularis_oris_roll_lower": 1.0}
    built = settled_displacement(sim.create(head), pose)
    np.testing.assert_array_equal(settled_displacement(simulation, pose), built)


def test_balance_is_where_the_simulation_comes_to_rest() -> None:
    """Without contact, one solve gives the simulated motion; and its derivative is its slope."""
    head = assets.load("head")
    trial = sim.Trial(head)
    statics = Statics(trial.anatomy)
    muscles = parts_of(trial.rig)
    balance = statics.balance(muscles, SMILE)
    moved = trial.anatomy.space.vectors_to_standard(settled_displacement(sim.create(head), SMILE))
    cosine = (moved * balance.moved).sum() / np.linalg.norm(moved) / np.linalg.norm(balance.moved)
    assert cosine > 0.97

    muscle = muscles["zygomaticus_major"]
    assert isinstance(muscle, LinearMuscle)
    other = replace(muscle, contraction=muscle.contraction + 0.01)
    was, now = (statics.effect(m, *next(iter(SMILE.items()))) for m in (muscle, other))
    change = now.plus(was, -1.0)
    slope = balance.derivatives([change])[:, :, 0]
    further = statics.balance(muscles | {"zygomaticus_major": other}, SMILE).moved - balance.moved
    np.testing.assert_allclose(slope, further, atol=0.02 * np.abs(further).max())


@pytest.mark.parametrize("control", ["jaw_open", "orbicularis_oculi_palpebral_upper_left"])
def test_balance_follows_jaw_and_lids(control: str) -> None:
    """Other numbers of jaw and lids move a balanced face as they do a simulated one."""
    head = SimpleNamespace(**vars(assets.load("head")))
    head.jaw_axis = head.mandible_weight = None  # to be found by the landmarks
    trial = sim.Trial(head)
    parts = anatomical(head.rig).parts
    trial.anatomy = framed(trial.anatomy, with_parts(trial.rig, parts))
    balance = Statics(trial.anatomy).balance(parts, {control: 1.0})
    moved = settled_displacement(trial.simulation(trial.rig), {control: 1.0})
    moved = trial.anatomy.space.vectors_to_standard(moved)
    cosine = (moved * balance.moved).sum() / np.linalg.norm(moved) / np.linalg.norm(balance.moved)
    assert cosine > 0.97


@pytest.mark.slow
def test_other_shapes_teach_a_muscle(tmp_path: Path) -> None:
    """A head that moves as the rig does: a fit comes nearer than anatomy, most with the shape."""
    head = assets.load("head")
    simulation = sim.create(head)
    names = ("mouthSmileLeft", "mouthFrownLeft", "mouthSmileRight", "mouthDimpleLeft", "jawOpen")
    moved = {name: settled_displacement(simulation, {name: 1.0}) for name in names}
    np.savez(
        tmp_path / "face.npz",
        vertices=head.vertices, triangles=head.faces, landmarks68=head.landmarks, **moved,
    )  # fmt: skip
    rows = {row.shape: row for row in measure(tmp_path)}
    assert set(rows) == {"mouthSmileLeft", "mouthFrownLeft", "jawOpen"}
    for row in rows.values():
        assert row.rig > 0.9
        assert row.anatomy < row.fitted
    for shape in ("mouthSmileLeft", "mouthFrownLeft"):
        assert -1.0 <= rows[shape].left_out < rows[shape].rig
        assert rows[shape].left_out - 0.01 < rows[shape].mixed
