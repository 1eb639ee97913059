"""Names, limits and groups of the controls, and how activations follow them."""

import numpy as np
import pytest
from pytest import approx

from risorius.sim.controls import Control, Controls


def test_every_control_has_limits_a_value_and_one_group(controls):
    """Limits, values and groups have the same controls, of muscles and of layers."""
    names = [*controls.lowest, *(n for layer in controls.layers.values() for n in layer)]
    assert len(controls.lowest) > 40
    assert len(set(names)) == len(names)
    assert set(controls.limits) == set(controls.values) == set(controls.actions) == set(names)
    assert sorted(n for group in controls.groups.values() for n in group) == sorted(names)


def test_both_sides_have_the_limits_of_their_sides(controls):
    """Both eyes look down as well as up; rows of tables have values from 0 to 1."""
    assert controls.limits["gaze_vertical"] == controls.limits["gaze_vertical_left"] == (-1, 1)
    assert controls.limits["zygomaticus_major"] == controls.limits["AU12"] == (0, 1)
    controls.pose({"gaze_horizontal": -0.5, "gaze_horizontal_left": 0.2})
    assert controls.sums["gaze_horizontal_left"] == approx(-0.3)
    assert controls.sums["gaze_horizontal_right"] == -0.5


def test_unknown_control_suggests_near_names(controls):
    """An unknown control is refused with similar names, and nothing is set."""
    with pytest.raises(ValueError, match=r"'zygomaticus_mayor_left'.*zygomaticus_major_left"):
        controls.set_all({"jaw_open": 1.0, "zygomaticus_mayor_left": 0.5})
    assert not any(controls.values.values())


def test_value_must_be_within_limits(controls):
    """Values beyond the limits are refused, alone and in an array, with the limits named."""
    with pytest.raises(ValueError, match=r"'jaw_open': was -0.5, allowed is 0 to 1"):
        controls.set("jaw_open", -0.5)
    with pytest.raises(ValueError, match=r"was 1.5, allowed is 0 to 1; clamp it first"):
        controls.set_array(np.full(len(controls.names), 1.5))
    controls.set_array(np.full(len(controls.names), 0.5))
    assert set(controls.values.values()) == {0.5}


def test_activation_follows_without_overshoot():
    """An activation follows a step within 0.1 s, monotonically, for any step length."""
    coarse, fine = (Controls((Control("one", "Group"),)) for _ in range(2))
    coarse.set_all({"one": 1.0})
    fine.set_all({"one": 1.0})
    path = []
    for _ in range(12):
        coarse.advance(1 / 120)
        fine.advance(1 / 240)
        fine.advance(1 / 240)
        path.append(coarse.activation[0])
        assert coarse.activation[0] == approx(fine.activation[0], abs=1e-12)
    assert np.all(np.diff([0.0, *path]) > 0.0)
    assert 0.9 < path[-1] <= 1.0


def test_sums_of_values_are_those_of_a_face_that_takes_them(controls):
    """Sums of given values are those of a face with these values, without setting anything.

    They include weights and floors of layers.
    """
    controls.pose({"AU12": 0.4, "jawOpen": 0.3, "mouthClose": 0.2, "AU46_left": 1.0})
    before = controls.values
    wanted = controls.wanted.copy()
    values = np.array([*before.values()])
    found = controls.sums_of(0.5 * values)
    assert controls.values == before
    assert np.array_equal(controls.wanted, wanted)
    controls.set_array(0.5 * values)
    assert np.array_equal(controls.wanted, found)
    assert (found > 0.0).sum() > 5
