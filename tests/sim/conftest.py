"""The built-in head and one simulation of it, shared: building takes longer than most tests."""

import pytest

from risorius import sim
from risorius.assets.model import Head
from risorius.sim.controls import Controls


@pytest.fixture(scope="session")
def shared_simulation(head: Head) -> sim.Simulation:
    """One simulation for the session; use the `simulation` fixture, which puts it back to rest."""
    return sim.create(head)


@pytest.fixture
def simulation(shared_simulation: sim.Simulation) -> sim.Simulation:
    """The simulation of the built-in head, at rest."""
    shared_simulation.reset()
    return shared_simulation


@pytest.fixture
def controls(simulation: sim.Simulation) -> Controls:
    """Those of the simulation, all at zero."""
    return simulation.controls
