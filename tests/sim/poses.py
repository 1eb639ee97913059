"""Poses and measurements of a face for tests."""

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np

from risorius import sim
from risorius.geometry.arrays import Floats64, Integers32

FRAME_TIME = 1.0 / 60.0


def both_sides(simulation: sim.Simulation, values: Mapping[str, float]) -> dict[str, float]:
    """Values for muscle names without a side, applied to both sides if there are two."""
    known = set(simulation.controls.lowest)
    return {
        control: value
        for name, value in values.items()
        for control in (name, f"{name}_left", f"{name}_right")
        if control in known
    }


def advance(moving: Any, frames: int, step: float = FRAME_TIME) -> None:
    """Let a scene or a simulation move for some frames; step: time of a frame [s]."""
    for _ in range(frames):
        moving.step(step)


def settled_displacement(
    simulation: sim.Simulation, values: Mapping[str, float], *, frames: int = 60
) -> Floats64:
    """Pose the face from rest, wait, and return its displacements [mm], shape (V, 3)."""
    simulation.reset()
    simulation.controls.set_all(values)
    advance(simulation, frames)
    moved: Floats64 = simulation.positions - simulation.rest_positions
    return moved


def moved_landmarks(head: Any, moved: Floats64, *numbers: int) -> Floats64:
    """Mean displacement [mm] of some landmarks, shape (3,)."""
    mean: Floats64 = moved[head.landmarks[list(numbers)]].mean(axis=0)
    return mean


def inverted_triangles(faces: Integers32, rest: Floats64, now: Floats64) -> int:
    """The number of triangles whose normals turned by more than a right angle."""

    def normals(x: Floats64) -> Floats64:
        first, second, third = x[faces.T]
        return np.cross(second - first, third - first)

    return int(((normals(rest) * normals(now)).sum(axis=1) < 0.0).sum())


def without(head: Any, *names: str) -> SimpleNamespace:
    """A copy of a head without some attributes."""
    every = ("vertices", "faces", "landmarks", "mandible_weight", "jaw_axis", "eyes", "rig")
    kept = {name: getattr(head, name) for name in every if name not in names}
    return SimpleNamespace(**kept)


def lip_gap(simulation: sim.Simulation, head: Any) -> float:
    """Greatest vertical distance [mm] between inner lip landmarks."""
    height = simulation.positions[head.landmarks, 1]
    upper = height[[61, 62, 63]]
    lower = height[[67, 66, 65]]
    return float((upper - lower).max())
