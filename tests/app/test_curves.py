"""Curves: from activations of muscles back to the controls of a layer."""

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt
import pytest

from risorius.app.errors import UserError
from risorius.app.motion.curves import ACTION_UNITS, ARKIT_SHAPES, sided, solved
from risorius.app.scenes import FaceScene, PlaneScene

Floats = npt.NDArray[np.float64]
LAYERS = pytest.mark.parametrize("layer", [ACTION_UNITS, ARKIT_SHAPES])


def activations_of(scene: FaceScene, poses: Sequence[Mapping[str, float]]) -> dict[str, Floats]:
    """What the muscles are asked in each pose, by the simulation's own sums."""
    rows = []
    for pose in poses:
        scene.pose(pose)
        rows.append(scene.simulation.sums)
    return {name: np.array([row[name] for row in rows]) for name in scene.simulation.controls}


def poses_of(values: Mapping[str, Floats]) -> list[dict[str, float]]:
    """The frames of curves one by one."""
    count = len(next(iter(values.values())))
    return [{name: float(each[n]) for name, each in values.items()} for n in range(count)]


def furthest(one: Mapping[str, Floats], other: Mapping[str, Floats]) -> float:
    """The largest difference of two sets of curves."""
    return max(float(np.abs(one[name] - other[name]).max()) for name in one)


def mixtures(names: Sequence[str], count: int, seed: int) -> list[dict[str, float]]:
    """Poses of five controls each, none of them cut off at a limit."""
    rng = np.random.default_rng(seed)
    return [
        {str(name): float(rng.uniform(0.0, 0.4)) for name in rng.choice(names, 5, replace=False)}
        for _ in range(count)
    ]


@LAYERS
def test_what_a_layer_can_do_is_found(scene: FaceScene, layer: str) -> None:
    """Mixtures of controls: the simulation sums what was found to the same activations."""
    asked = activations_of(scene, mixtures(sided(scene, layer), 40, seed=1))
    assert furthest(asked, activations_of(scene, poses_of(solved(scene, layer, asked)))) < 1e-4


@LAYERS
def test_what_was_set_stays_as_it_was_set(scene: FaceScene, layer: str) -> None:
    """Told which controls were set, they come back bit for bit, floors and all."""
    names = [name for name in sided(scene, layer) if name != "mouthClose"]
    poses = mixtures(names, 40, seed=2)
    controls = {name: np.array([pose.get(name, 0.0) for pose in poses]) for name in names}
    found = solved(scene, layer, activations_of(scene, poses), controls)
    assert all(np.array_equal(found[name], controls[name]) for name in names)


def test_both_sides_are_told_by_each(scene: FaceScene) -> None:
    """AU12 is AU12_left and AU12_right, set or solved for, and joins what a side has."""
    poses = [{"AU12": 0.4, "AU12_left": 0.3, "jaw_open": 0.2}]
    asked = activations_of(scene, poses)
    controls = {name: np.array([value]) for name, value in poses[0].items()}
    for found in (solved(scene, ACTION_UNITS, asked), solved(scene, ACTION_UNITS, asked, controls)):
        assert "AU12" not in found
        assert found["AU12_left"] == pytest.approx([0.7], abs=1e-3)
        assert found["AU12_right"] == pytest.approx([0.4], abs=1e-3)
        assert found["AU26"] == pytest.approx([0.2 / 0.45], abs=1e-3)


def test_a_share_is_told_as_it_is_set(scene: FaceScene) -> None:
    """mouthClose makes good a part of jawOpen, and is written as that part."""
    asked = activations_of(scene, [{"jawOpen": 0.5, "mouthClose": 0.2}, {"jawOpen": 0.5}])
    found = solved(scene, ARKIT_SHAPES, asked)
    assert found["jawOpen"] == pytest.approx([0.5, 0.5], abs=1e-3)
    assert found["mouthClose"] == pytest.approx([0.2, 0.0], abs=1e-3)


def test_a_face_that_a_layer_cannot_make_is_met_halfway(scene: FaceScene) -> None:
    """Every value keeps its limits, and lies nearer to the face than a face at rest does."""
    rng = np.random.default_rng(3)
    lowest = scene.simulation.controls
    asked = activations_of(
        scene, [{name: float(rng.uniform(0, scene.limits[name][1])) for name in lowest}] * 2
    )
    found = solved(scene, ACTION_UNITS, asked)
    made = activations_of(scene, poses_of(found))
    for name, values in found.items():
        assert (values >= 0.0).all() and (values <= scene.limits[name][1]).all()
    off = sum(np.sum((asked[name] - made[name]) ** 2) for name in lowest)
    assert off < 0.5 * sum(np.sum(asked[name] ** 2) for name in lowest)


def test_what_has_no_muscles_is_refused() -> None:
    """A sheet has no action units."""
    with pytest.raises(UserError, match="'plane' has no muscles; take the scene face"):
        solved(PlaneScene(), ACTION_UNITS, {})
