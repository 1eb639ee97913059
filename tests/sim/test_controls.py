"""Names, limits and groups of the controls, and how activations follow them."""

import numpy as np
import pytest

from risorius import sim
from risorius.sim.controls import Control, Controls


def test_every_control_has_limits_a_value_and_one_group(simulation: sim.Simulation) -> None:
    """Limits, values and groups speak of the same controls, the lowest and those of layers."""
    names = [*simulation.controls, *(n for layer in simulation.layers.values() for n in layer)]
    assert len(simulation.controls) > 40
    assert len(set(names)) == len(names)
    assert set(simulation.limits) == set(simulation.values) == set(names)
    assert set(simulation.actions) == set(names)
    assert sorted(n for group in simulation.groups.values() for n in group) == sorted(names)


def test_both_sides_have_the_limits_of_their_sides(simulation: sim.Simulation) -> None:
    """Both eyes look down as well as up; rows of tables run from 0 to 1."""
    assert simulation.limits["gaze_vertical"] == simulation.limits["gaze_vertical_left"] == (-1, 1)
    assert simulation.limits["zygomaticus_major"] == simulation.limits["AU12"] == (0, 1)
    simulation.pose({"gaze_horizontal": -0.5, "gaze_horizontal_left": 0.2})
    assert simulation.sums["gaze_horizontal_left"] == pytest.approx(-0.3)
    assert simulation.sums["gaze_horizontal_right"] == -0.5


def test_unknown_control_suggests_near_names(simulation: sim.Simulation) -> None:
    """A typing error is answered with the names that were meant."""
    with pytest.raises(ValueError, match=r"'zygomaticus_mayor_left'.*zygomaticus_major_left"):
        simulation.set("zygomaticus_mayor_left", 0.5)


def test_value_must_be_within_limits(simulation: sim.Simulation) -> None:
    """Values out of limits are refused, by name or in one array, and the limits named."""
    with pytest.raises(ValueError, match=r"'jaw_open': was -0.5, allowed is 0 to 1"):
        simulation.set("jaw_open", -0.5)
    with pytest.raises(ValueError, match=r"was 1.5, allowed is 0 to 1; clamp it first"):
        simulation.take(np.full(len(simulation.names), 1.5))
    simulation.take(np.full(len(simulation.names), 0.5))
    assert set(simulation.values.values()) == {0.5}


def test_set_all_is_all_or_nothing(simulation: sim.Simulation) -> None:
    """One bad value leaves all others as they were."""
    with pytest.raises(ValueError, match="no control called 'nonsense'"):
        simulation.set_all({"jaw_open": 1.0, "nonsense": 1.0})
    assert simulation.values["jaw_open"] == 0.0


def test_activation_follows_without_overshoot() -> None:
    """A step input is followed within 0.1 s, monotonously, the same for any step length."""
    coarse, fine = (Controls((Control("one", "Group"),)) for _ in range(2))
    coarse.set_all({"one": 1.0})
    fine.set_all({"one": 1.0})
    path = []
    for _ in range(12):
        coarse._advance(1 / 120)
        fine._advance(1 / 240)
        fine._advance(1 / 240)
        path.append(coarse._now("one"))
        assert coarse._now("one") == pytest.approx(fine._now("one"), abs=1e-12)
    assert np.all(np.diff([0.0, *path]) > 0.0)
    assert 0.9 < path[-1] <= 1.0


def test_positions_are_read_only(simulation: sim.Simulation) -> None:
    """A caller cannot move the face by writing into what it reads."""
    for array in (simulation.positions, simulation.rest_positions):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0.0
