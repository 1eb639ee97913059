"""What an hour of the wildest input does to the face: nothing, one hopes.

Every control jumps to a random value in every frame, and frames are of random length, from 1/240 to
1/20 s. Then the face is let go. Asked is

    finite, bounded      no position ever leaves a box around the rest shape
    back to rest         within 2 s of zero input
    energy               never grows from one frame to the next without input
    bit-reproducible     the first minute, run again, gives the same bytes
    mirrored             input with left and right exchanged gives the mirrored motion
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from itertools import islice
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from risorius import assets, sim
from risorius.app.controls.mirror import mirrored as on_the_other_side

from .report import Target, at_most

Array = npt.NDArray[np.float64]

SEED = 2003
SHORTEST, LONGEST = 1.0 / 240.0, 1.0 / 20.0  # s, frames
SETTLE = 2.0  # s
FRAME = 1.0 / 60.0
REPEATED = 60.0  # s of simulated time that are run twice
MIRRORED_FRAMES = 240
BLOW = 100.0  # mm/s
FURTHEST, AT_REST, MIRRORED = 150.0, 1e-3, 1e-6  # [mm] at most
ROUNDING = 1e-9  # of the energy: growth below it is arithmetic


class Soak(NamedTuple):
    """What was seen."""

    seconds: float  # simulated
    frames: int
    finite: bool
    furthest: float  # mm from rest, seen from the cranium
    rest_error: float  # mm from rest, 2 s after release
    growth: float  # greatest growth of the energy in a frame without input, as a share of it
    same_bytes: bool
    mirror_error: float  # mm


def measure(minutes: float) -> Soak:
    """Soak the built-in head for `minutes` of simulated time, more than none."""
    head = assets.load("head")
    simulation = sim.create(head)
    seconds, frames, furthest, finite = 0.0, 0, 0.0, True
    try:
        for dt in _wild_frames(simulation):
            seconds, frames = seconds + dt, frames + 1
            furthest = max(furthest, float(np.abs(displacements(simulation)).max()))
            if seconds >= 60.0 * minutes:
                break
    except sim.SimulationUnstable:
        finite = False
        simulation.reset()
    rest_error = _rest_error(simulation)
    again = min(REPEATED, 60.0 * minutes)
    is_same = _digest(simulation, again) == _digest(sim.create(head), again)
    growth, mirror_error = _energy_growth(simulation), _mirror_error(simulation, head.mirror)
    return Soak(seconds, frames, finite, furthest, rest_error, growth, is_same, mirror_error)


def displacements(simulation: sim.Simulation) -> Array:
    """Displacements [mm] as seen from the cranium, shape (V, 3)."""
    head = simulation.bone_transforms()["cranium"]
    seen: Array = (simulation.positions - head[:3, 3]) @ head[:3, :3] - simulation.rest_positions
    return seen


def _wild_frames(simulation: sim.Simulation, *, mirrored: bool = False) -> Iterator[float]:
    """From rest, frames of random length with every control at random; the length of each [s]."""
    generator = np.random.default_rng(SEED)
    simulation.reset()
    limits = {name: simulation.limits[name] for name in simulation.controls}
    low, high = np.array(list(limits.values())).T
    while True:
        share = generator.uniform(size=len(limits))
        # A third of the values are at a limit, the rest anywhere between.
        share = np.where(generator.uniform(size=len(limits)) < 1.0 / 3.0, np.round(share), share)
        values = dict(zip(limits, (low + share * (high - low)).tolist(), strict=True))
        simulation.set_all(on_the_other_side(values) if mirrored else values)
        dt = float(generator.uniform(SHORTEST, LONGEST))
        simulation.step(dt)
        yield dt


def _rest_error(simulation: sim.Simulation) -> float:
    """How far the face is from rest [mm] two seconds after all controls went to zero."""
    simulation.set_all(dict.fromkeys(simulation.controls, 0.0))
    for _ in range(round(SETTLE / FRAME)):
        simulation.step(FRAME)
    return float(np.abs(displacements(simulation)).max())


def _energy_growth(simulation: sim.Simulation) -> float:
    """Greatest growth of the energy in a frame after a blow, as a share of what the blow gave."""
    simulation.reset()
    generator = np.random.default_rng(SEED)
    simulation.kick(generator.normal(scale=BLOW, size=simulation.positions.shape))
    energies = [simulation.energy()]
    for _ in range(round(SETTLE / FRAME)):
        simulation.step(FRAME)
        energies.append(simulation.energy())
    growth = float(np.diff(energies).max()) / energies[0]
    return growth if growth > ROUNDING else 0.0


def _digest(simulation: sim.Simulation, seconds: float) -> str:
    """Digest of all positions over some seconds of random input from rest."""
    digest, passed = hashlib.sha256(), 0.0
    for dt in _wild_frames(simulation):
        digest.update(simulation.positions.tobytes())
        passed += dt
        if passed >= seconds:
            break
    return digest.hexdigest()


def _mirror_error(simulation: sim.Simulation, mirror: npt.NDArray[np.int32]) -> float:
    """Greatest difference [mm] between mirrored motion and the motion of mirrored input."""
    plain, mirrored = (
        np.array(
            [
                simulation.positions.copy()
                for _ in islice(_wild_frames(simulation, mirrored=side), MIRRORED_FRAMES)
            ]
        )
        for side in (False, True)
    )
    return float(np.abs(mirrored[:, mirror] * (-1.0, 1.0, 1.0) - plain).max())


def report(soak: Soak) -> str:
    """The text to print, but for what is held to something."""
    return (
        f"{soak.seconds / 60.0:.1f} simulated minutes, {soak.frames} frames of 1/240 to 1/20 s, "
        "every control at\nrandom in every frame."
    )


def targets(soak: Soak) -> list[Target]:
    """What an hour of random input must not do."""
    return [
        Target("finite", soak.finite),
        at_most("furthest from rest", soak.furthest, FURTHEST, " mm"),
        at_most("2 s after release", soak.rest_error, AT_REST, " mm"),
        at_most("energy growth", soak.growth, 0.0),
        Target("same bytes in two runs", soak.same_bytes),
        at_most("mirrored input", soak.mirror_error, MIRRORED, " mm"),
    ]
