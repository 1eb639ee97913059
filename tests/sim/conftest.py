"""The built-in head and one simulation of it, shared because construction takes long."""

import pytest

from risorius import sim
from risorius.assets.model import Head
from risorius.sim.controls import Controls
from risorius.sim.face_model import FaceModel, build_face_model
from risorius.sim.state import State


@pytest.fixture(scope="session")
def model(head: Head) -> FaceModel:
    """The model of the built-in head."""
    return build_face_model(head)


@pytest.fixture(scope="session")
def state(model: FaceModel) -> State:
    """The arrays that kernels of the shared simulation read and write."""
    return State.at_rest(model.surface, len(model.muscles.bundle.muscle))


@pytest.fixture(scope="session")
def shared_simulation(model: FaceModel, state: State) -> sim.Simulation:
    """One simulation for the session; use the `simulation` fixture, which resets it to rest."""
    return sim.Simulation(model, state)


@pytest.fixture
def simulation(shared_simulation: sim.Simulation) -> sim.Simulation:
    """The simulation of the built-in head, at rest."""
    shared_simulation.reset()
    return shared_simulation


@pytest.fixture
def controls(simulation: sim.Simulation) -> Controls:
    """The controls of the simulation, all at zero."""
    return simulation.controls
