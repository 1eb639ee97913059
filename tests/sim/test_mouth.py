"""The visible mouth: shut unless a control opens it, and then with rounded corners.

It is checked from the front, both sides, above and below, on the mesh and on the refined mesh
(smoothing thins a folded lip a little, so closed lips are pressed together).
"""

from collections.abc import Callable

import numpy as np
import pytest

from risorius import refine, sim
from risorius.assets.model import Head
from risorius.bench.gaps import meshes_of, widest_slit
from tests.sim.poses import both_sides, settled_displacement

SHUT_GAP = 0.3  # [mm], about a pixel of a full-screen close-up
UNMOVED_DISTANCE = 0.01  # [mm]; lips that no muscle moves need no check
SHUT_EXPRESSIONS = ("kiss", "sadness", "anger", "contempt", "wink", "blink")
OPENERS = (
    "levator_labii_superioris_alaeque_nasi", "levator_labii_superioris",
    "depressor_labii_inferioris", "orbicularis_oris_peripheral_upper",
    "orbicularis_oris_peripheral_lower", "jaw_open",
)  # fmt: skip

Slits = Callable[[], dict[str, float]]


@pytest.fixture(scope="module")
def refiner(head: Head) -> refine.Refiner:
    """The default refinement."""
    return refine.create("kahler", head.faces, head.vertices)


@pytest.fixture
def slits(simulation: sim.Simulation, head: Head, refiner: refine.Refiner) -> Slits:
    """A function that measures the widest slit between the lips, from any side.

    It returns the slit of the mesh and of the refined mesh.
    """

    def measure():
        landmarks = simulation.positions[head.landmarks]
        return {
            name: widest_slit(*mesh, landmarks)
            for name, mesh in meshes_of(simulation, refiner).items()
        }

    return measure


@pytest.mark.parametrize("name", SHUT_EXPRESSIONS)
def test_closed_mouth_shows_no_teeth(simulation, head, slits, name):
    """In expressions with a closed mouth the lips are shut, refined or not."""
    settled_displacement(simulation, head.expressions[name])
    for mesh, slit in slits().items():
        assert slit < SHUT_GAP, mesh


def test_a_wrinkled_nose_keeps_the_lips_shut(simulation, slits):
    """Action unit 9 lifts both lips with the nose, and shows no teeth beside their middle."""
    settled_displacement(simulation, {"AU9": 1.0})
    for mesh, slit in slits().items():
        assert slit < SHUT_GAP, mesh


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sides", "strength"),
    [
        ("both", 1.0),
        pytest.param("left", 1.0, marks=pytest.mark.slow),
        pytest.param("both", 0.4, marks=pytest.mark.slow),
    ],
)
def test_no_other_muscle_opens_the_mouth(simulation, model, slits, sides, strength):
    """No muscle opens the mouth, except those made for it."""
    muscles = {
        name.removesuffix("_left").removesuffix("_right")
        for name in simulation.controls.lowest
        if not name.startswith("gaze")
    } - set(OPENERS)
    assert len(muscles) > 20
    for muscle in sorted(muscles):
        values = both_sides(simulation, {muscle: strength})
        if sides == "left":
            values = {name: value for name, value in values.items() if "_right" not in name}
        moved = settled_displacement(simulation, values, frames=40)
        if np.abs(moved[model.skin.lips.members]).max() < UNMOVED_DISTANCE:
            continue
        for mesh, slit in slits().items():
            assert slit < SHUT_GAP, (muscle, mesh)


def test_slit_measure_sees_an_open_mouth(simulation, head, slits):
    """The measure of slits agrees with the lip landmarks of an open mouth."""
    settled_displacement(simulation, {"jaw_open": 0.5})
    inner = simulation.positions[head.landmarks[[62, 66]], 1]
    assert slits()["static"] == pytest.approx(inner[0] - inner[1], abs=2.0)


def test_an_o_is_round(simulation, head):
    """In `viseme_oh` the opening of the mouth is 0.6 times as high as it is wide; 0.57 once."""
    x = head.vertices + settled_displacement(simulation, {"viseme_oh": 1.0})
    wide, high, _ = np.ptp(x[head.landmarks[60:68]], axis=0)
    assert high > 0.6 * wide
