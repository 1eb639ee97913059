"""Scores of motion: made-up references of known motion, under every spelling of their names."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from risorius import assets, sim
from risorius.bench.motion import Row, measure
from tests.heads import METRES, SHIFT, TURN, shape
from tests.sim.poses import both_sides, settled_displacement

PUFF = {
    "cheek_puff": 0.8,
    "orbicularis_oris_sphincter": 0.8,
    "incisivus_labii_superioris": 0.3,
    "incisivus_labii_inferioris": 0.4,
    "orbicularis_oris_marginal_upper": 0.5,
    "orbicularis_oris_marginal_lower": 0.6,
}
# What a field is called -> the controls that make it on the built-in head.
WHOLE = {
    "jawOpen": {"jaw_open": 1.0},
    "JawForward": {"jaw_forward": 1.0},
    "jawLeft": {"jaw_sideways": 1.0},
    "jawRight": {"jaw_sideways": -1.0},
    "mouthLeft": {"lips_sideways_left": 1.0},
    "MouthRight": {"lips_sideways_right": 1.0},
    "mouthRollUpper": {"orbicularis_oris_roll_upper": 1.0},
    "mouthRollLower": {
        "orbicularis_oris_roll_lower": 1.0,
        "orbicularis_oris_marginal_lower_left": 0.25,
        "orbicularis_oris_marginal_lower_right": 0.25,
        "mentalis": 0.2,
        "upper_lip_shrug": 0.15,
    },
    "mouthShrugUpper": {"upper_lip_shrug": 1.0, "depressor_anguli_oris": 0.25, "mentalis": 0.15},
    "cheekPuff": {f"{name}_{side}": PUFF[name] for name in PUFF for side in ("left", "right")},
    "browInnerUp": {"frontalis_medial": 0.91, "frontalis_lateral": 0.11},
    "eyeBlink": {"orbicularis_oculi_palpebral_upper": 1.0},
}
HALVES = {
    "cheekPuff_L": {f"{name}_left": share for name, share in PUFF.items()},
    "cheekPuffRight": {f"{name}_right": share for name, share in PUFF.items()},
    "EyeWideLeft": {"levator_palpebrae_left": 1.0},
    "eyeWide_R": {"levator_palpebrae_right": 1.0},
    "mouthDimpleLeft": {"buccinator_left": 1.0, "depressor_anguli_oris_left": 0.6},
    "mouthLowerDown_right": {"depressor_labii_inferioris_right": 1.0},
}


@pytest.fixture(scope="module")
def scored(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Row], list[str]]:
    """Scores of a head of another shape, unit and orientation that moves as the built-in one."""
    head = assets.load("head")
    simulation = sim.create(head)
    fields = {}

    def field(moved: np.ndarray) -> np.ndarray:
        changed: np.ndarray = (shape(head.vertices + moved) - shape(head.vertices)) @ TURN.T
        return changed * METRES

    for name, values in {**WHOLE, **HALVES}.items():
        fields[name] = field(settled_displacement(simulation, both_sides(simulation, values)))
    closed = settled_displacement(simulation, {"jaw_open": 1.0, "lips_closed": 1.0})
    fields["mouthClose"] = field(closed - settled_displacement(simulation, {"jaw_open": 1.0}))
    raised = settled_displacement(simulation, {"gaze_vertical": 1.0})
    fields["eyeLookUpLeft"] = field(np.where(head.vertices[:, :1] > 0.0, raised, 0.0))
    folder = tmp_path_factory.mktemp("reference")
    np.savez(
        folder / "face.npz",
        vertices=shape(head.vertices) @ TURN.T * METRES + SHIFT,
        triangles=head.faces,
        landmarks68=head.landmarks,
        tongueOut=fields["jawOpen"],
        eyeBlink_L=np.zeros_like(head.vertices),
        **fields,
    )
    rows, left_out = measure(folder)
    return {row.shape: row for row in rows}, left_out


@pytest.mark.slow
def test_own_motion_is_known_again(scored: tuple[dict[str, Row], list[str]]) -> None:
    """Carried over by landmarks to another head, each shape is nearly what it was made from."""
    rows, _ = scored
    assert set(rows) == {*WHOLE, *HALVES, "mouthClose", "eyeLookUpLeft"}
    cosines = {name: row.cosine for name, row in rows.items()}
    assert {name: c for name, c in cosines.items() if c < 0.9} == {}
    assert np.mean(list(cosines.values())) > 0.96
    for name, row in rows.items():
        assert 0.8 < row.magnitude < 1.25, name
        assert row.residual < 0.25, name  # jawOpen: its mandible is guessed from landmarks


@pytest.mark.slow
def test_what_has_no_score_is_named(scored: tuple[dict[str, Row], list[str]]) -> None:
    """An unknown name and a field that moves nothing are left out, and said to be."""
    assert scored[1] == ["tongueOut", "eyeBlink_L"]


def test_reference_without_a_known_shape(tmp_path: Path) -> None:
    """A reference of which nothing can be scored is refused."""
    head = assets.load("head")
    np.savez(
        tmp_path / "face.npz",
        vertices=head.vertices,
        triangles=head.faces,
        landmarks68=head.landmarks,
        earWiggle=np.ones_like(head.vertices),
    )
    with pytest.raises(ValueError, match="holds none of the shapes"):
        measure(tmp_path)
