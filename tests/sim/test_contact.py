"""What skin rests on: how near it may come to an eyeball, and that it comes no nearer."""

from types import SimpleNamespace

import numpy as np
import pytest

from risorius import sim
from risorius.assets.model import Head
from risorius.sim.contact import watch_eyeballs
from tests.sim.poses import settled_displacement


def test_skin_may_come_as_near_as_a_lid_is_thick() -> None:
    """0.3 mm to the ball; what starts nearer may stay there, what is far away is not watched."""
    ball = SimpleNamespace(centre=np.array([30.0, 0.0, 0.0]), radius=12.0)
    away = np.array([10.0, 12.1, 13.0, 20.0, 30.0])
    skin = SimpleNamespace(positions=ball.centre + away[:, None] * [0.0, 0.6, 0.8])
    eyes = watch_eyeballs(skin, (ball,))  # type: ignore[arg-type]
    assert eyes.vertex.tolist() == [0, 1, 2, 3]
    assert eyes.least_distance == pytest.approx([10.0, 12.1, 12.3, 12.3])
    sunk = ball.centre + np.array([10.0, 12.1, 11.8, 12.3, 1.0])[:, None] * [0.0, 0.6, 0.8]
    assert eyes.deepest(sunk) == pytest.approx(0.5)


@pytest.mark.parametrize("name", ["AU43", "AU46_left", "AU6", "yawn"])
def test_lids_rest_on_the_eyeball(simulation: sim.Simulation, head: Head, name: str) -> None:
    """Measured by the head's own eyes: whatever shuts them, skin stays outside."""
    moved = settled_displacement(simulation, {name: 1.0})
    for eye in head.eyes:
        rest = np.linalg.norm(head.vertices - eye.centre, axis=1)
        now = np.linalg.norm(head.vertices + moved - eye.centre, axis=1)
        thickness = np.minimum(rest - eye.radius, 0.3)
        assert (now - eye.radius - thickness)[rest < eye.radius + 12.0].min() > -1e-3
