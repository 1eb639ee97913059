"""Stability: rest stays at rest, energy decays, and no input breaks the face."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from risorius import sim
from risorius.geometry.sides import side_lengths
from risorius.sim.substep import SEAL_AXES
from tests.sim.poses import FRAME_TIME, advance, both_sides, settled_displacement


def test_rest_stays_at_rest(simulation, model, state):
    """In two seconds without input, nothing moves by a millionth of a millimetre."""
    advance(simulation, 120)
    assert np.abs(simulation.positions - simulation.rest_positions).max() < 1e-6
    assert _energy(model.skin, state, simulation.grip) < 1e-9


@pytest.mark.parametrize("speed", [50.0, 500.0])
def test_energy_only_falls_without_input(simulation, model, state, generator, speed):
    """After a blow, energy falls in every frame, and is 0 after a second and a half."""
    simulation.touch.kick(generator.normal(scale=speed, size=simulation.positions.shape))
    energies = [_energy(model.skin, state, simulation.grip)]
    for _ in range(90):
        simulation.step(FRAME_TIME)
        energies.append(_energy(model.skin, state, simulation.grip))
    assert np.all(np.diff(energies) <= 1e-9 * energies[0])
    assert energies[-1] < 1e-6 * energies[0]


def test_clones_do_not_disturb_each_other(simulation):
    """Two clones in two threads move exactly as each does alone, to the bit."""

    def film(name):
        clone = simulation.clone()
        frames = []
        for frame in range(240):
            clone.controls.set(name, float(frame // 20 % 2))
            clone.step(FRAME_TIME)
            frames.append(clone.positions.copy())
        return frames

    names = "joy", "surprise"
    with ThreadPoolExecutor(2) as threads:
        assert np.array_equal(list(threads.map(film, names)), [film(name) for name in names])


@pytest.mark.slow
@pytest.mark.parametrize("frames_per_second", [240.0, 60.0, 47.3, 20.0])
def test_random_jumps_stay_bounded_and_come_back(simulation, generator, frames_per_second):
    """With random jumps of every control in every frame, the face stays within bounds.

    After the jumps it is at rest within 2 s.
    """
    controls = simulation.controls
    limits = [controls.limits[name] for name in controls.lowest]
    furthest = 0.0
    for _ in range(int(2.0 * frames_per_second)):
        for name, (low, high) in zip(controls.lowest, limits, strict=True):
            controls.set(name, generator.choice([low, high, generator.uniform(low, high)]))
        simulation.step(1.0 / frames_per_second)
        furthest = max(furthest, float(np.abs(_moved(simulation)).max()))
    assert 5.0 < furthest < 100.0
    simulation.controls.set_all(dict.fromkeys(simulation.controls.lowest, 0.0))
    for _ in range(int(2.0 * frames_per_second)):
        simulation.step(1.0 / frames_per_second)
    assert np.abs(_moved(simulation)).max() < 0.01


def test_everything_at_once_on_and_off(simulation):
    """All muscles switch on and off every tenth of a second without breaking the face."""
    for beat in range(20):
        level = float(beat % 2)
        simulation.controls.set_all({name: level for name in simulation.controls.lowest})
        advance(simulation, 6)
        assert np.abs(_moved(simulation)).max() < 90.0


def test_two_runs_are_bit_identical(simulation, head):
    """The same inputs give the same bits, also in a new simulation."""
    other = sim.create(head)
    values = dict.fromkeys(simulation.controls.lowest, 0.5)
    for run in (simulation, other):
        run.controls.set_all(values)
        for dt in (1 / 60, 1 / 24, 1 / 240, 1 / 47.3, 1 / 20):
            run.step(dt)
    assert simulation.positions.tobytes() == other.positions.tobytes()


def test_reset_forgets_everything(simulation):
    """After a reset the same inputs give the same bits."""
    values = both_sides(simulation, {"zygomaticus_major": 0.7, "jaw_open": 0.5})
    first = settled_displacement(simulation, values, frames=7)
    second = settled_displacement(simulation, values, frames=7)
    assert first.tobytes() == second.tobytes()


def test_frame_length_hardly_matters(simulation):
    """A smile after 0.25 s is the same at 20, 60 and 240 frames per second."""
    values = both_sides(simulation, {"zygomaticus_major": 1.0})
    poses = []
    for rate in (20, 60, 240):
        simulation.reset()
        simulation.controls.set_all(values)
        for _ in range(rate // 4):
            simulation.step(1.0 / rate)
        poses.append(simulation.positions.copy())
    apart = [np.abs(pose - poses[2]).max(axis=1) for pose in poses[:2]]
    assert np.percentile(apart, 99) < 0.1 and np.max(apart) < 0.5  # where a lip slides over teeth


def test_broken_state_is_reported(simulation, state):
    """A state that is not finite raises an error, and a reset repairs it."""
    state.x[10] = np.nan
    with pytest.raises(sim.SimulationUnstable, match=r"vertices are not finite.*reset"):
        simulation.step(FRAME_TIME)
    simulation.reset()
    simulation.step(FRAME_TIME)
    assert np.isfinite(simulation.positions).all()


def _moved(simulation):
    """Distance of the skin from rest, relative to the cranium [mm]."""
    head = simulation.bones.transforms()["cranium"]
    return (simulation.positions - head[:3, 3]) @ head[:3, :3] - simulation.rest_positions


def _energy(skin, state, grip):
    """Kinetic and spring energy, with muscles at rest, in skin mass units times (mm/s)^2."""
    away = state.x - state.carried
    tissue = skin.tissue
    edges = skin.edges
    lips = skin.lips
    across = (away * state.normals).sum(axis=1)
    beside = (away**2).sum(axis=1)
    stored = (tissue.tangential + state.hold) * beside
    stored += (tissue.normal - tissue.tangential) * across**2
    i, j = edges.edges.T
    longer = side_lengths(state.x, edges.edges) - edges.rest_length
    beyond = np.maximum(longer - edges.strain_limit * edges.rest_length, 0.0)
    stretched = edges.stiffness * (longer**2 + (edges.stiffening - 1.0) * beyond**2)
    stretched += edges.shear * ((away[j] - away[i]) ** 2).sum(axis=1)
    apart = lips.separations(state.x - skin.rest)
    apart[:, 1] -= lips.below * grip.overlap
    sealed = grip.stiffness * lips.seal * (apart**2 @ np.array(SEAL_AXES))
    kinetic = skin.mass[:, None] * state.v**2
    kinds = (kinetic, stored, stretched, sealed)
    return sum(float(each.sum()) for each in kinds) / 2.0
