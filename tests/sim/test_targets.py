"""Targets of springs are computed again after changes only."""

from numpy.linalg import norm

from risorius.sim import Simulation
from tests.sim.poses import advance

FRAME_TIME = 1.0 / 60.0


def test_a_face_that_rests_places_no_targets(simulation, monkeypatch):
    """When activations are reached, a step moves skin only; a changed control is noticed."""
    placed = []
    place = Simulation.place_targets
    monkeypatch.setattr(
        Simulation, "place_targets", lambda face: (placed.append(face), place(face))
    )
    simulation.step(FRAME_TIME)
    assert not placed
    simulation.controls.set("jaw_open", 0.5)
    simulation.step(FRAME_TIME)
    assert len(placed) == 1
    advance(simulation, 90)
    count = len(placed)
    simulation.step(FRAME_TIME)
    assert len(placed) == count < 80


def test_a_resting_face_follows_the_pointer(simulation):
    """Skin of a resting face moves in the first step of a pull, and springs back after it."""
    simulation.step(FRAME_TIME)
    rest = simulation.positions.copy()
    vertex = int(rest[:, 2].argmax())
    target = rest[vertex] + [0.0, 0.0, 5.0]
    simulation.touch.drag([vertex], [target], [1.0])
    simulation.step(FRAME_TIME)
    drawn = norm(simulation.positions - rest, axis=1).max()
    simulation.touch.end_drag()
    advance(simulation, 60)
    assert drawn > 0.2
    assert norm(simulation.positions - rest, axis=1).max() < 0.1 * drawn
