"""Pulled skin: it follows a pointer, stays stable, and swings back."""

import numpy as np
from numpy.linalg import norm

from tests.sim.poses import advance


def cheek(simulation):
    """Vertices within 12 mm of a vertex on the left cheek."""
    rest = simulation.rest_positions
    on_cheek = rest.mean(axis=0) + np.array([40.0, -20.0, 60.0])
    distances = np.abs(rest - on_cheek).sum(axis=1)
    middle = rest[distances.argmin()]
    return np.flatnonzero(norm(rest - middle, axis=1) < 12.0)


def test_skin_follows_the_pointer_and_swings_back(simulation):
    """Pulled by 20 mm, skin and its surroundings follow most of the way.

    Released, they return to rest.
    """
    grabbed = cheek(simulation)
    target = simulation.rest_positions[grabbed] + (20.0, 0.0, 0.0)
    simulation.touch.drag(grabbed, target, np.ones(len(grabbed)))
    advance(simulation, 60)
    moved = simulation.positions - simulation.rest_positions
    assert moved[grabbed, 0].min() > 12.0
    others = np.setdiff1d(np.arange(len(moved)), grabbed)
    assert 2.0 < np.abs(moved[others]).max() < 20.0
    simulation.touch.end_drag()
    advance(simulation, 120)
    assert np.abs(simulation.positions - simulation.rest_positions).max() < 0.01


def test_skin_of_a_turned_head_follows_the_pointer(simulation):
    """On a turned head, skin still follows the pointer."""
    simulation.controls.set("head_yaw", 1.0)
    advance(simulation, 90)
    before = simulation.positions.copy()
    grabbed = cheek(simulation)
    offset = np.array([10.0, 12.0, 0.0])
    simulation.touch.drag(grabbed, before[grabbed] + offset, np.ones(len(grabbed)))
    advance(simulation, 60)
    moved = (simulation.positions - before)[grabbed].mean(axis=0)
    assert moved @ offset > 0.9 * norm(moved) * norm(offset)
    assert norm(moved) > 0.6 * norm(offset)


def test_a_jumping_pointer_breaks_nothing(simulation, generator):
    """A pointer that jumps 100 mm in every frame leaves skin within bounds, at the longest step."""
    grabbed = cheek(simulation)
    for _ in range(40):
        offset = generator.uniform(-100.0, 100.0, 3)
        target = simulation.rest_positions[grabbed] + offset
        simulation.touch.drag(grabbed, target, np.ones(len(grabbed)))
        simulation.step(1.0 / 20.0)
        assert np.abs(simulation.positions - simulation.rest_positions).max() < 200.0
