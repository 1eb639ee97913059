"""What skin rests on: how near it may come to an eyeball, and that it comes no nearer."""

from types import SimpleNamespace

import numpy as np
from pytest import approx

from risorius.sim.contact import watch_eyeballs


def test_skin_may_come_as_near_as_a_lid_is_thick():
    """0.3 mm to the ball; skin that starts nearer may stay there, distant skin is not watched."""
    ball = SimpleNamespace(centre=np.array([30.0, 0.0, 0.0]), radius=12.0)
    away = np.array([10.0, 12.1, 13.0, 20.0, 30.0])
    skin = SimpleNamespace(positions=ball.centre + away[:, None] * [0.0, 0.6, 0.8])
    eyes = watch_eyeballs(skin, (ball,))
    assert eyes.vertex.tolist() == [0, 1, 2, 3]
    assert eyes.least_distance == approx([10.0, 12.1, 12.3, 12.3])
    sunk = ball.centre + np.array([10.0, 12.1, 11.8, 12.3, 1.0])[:, None] * [0.0, 0.6, 0.8]
    assert eyes.deepest(sunk) == approx(0.5)
