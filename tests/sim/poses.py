"""Posing and measuring a face in tests."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt

import sim

FRAME = 1.0 / 60.0
SLIT_WINDOW = 12.0  # mm above and below the mouth's middle in which an opening is the mouth
Array = npt.NDArray[np.float64]


def both_sides(simulation: sim.Simulation, values: Mapping[str, float]) -> dict[str, float]:
    """Values for muscle names without a side, applied to both sides where there are two."""
    known = set(simulation.controls)
    return {
        control: value
        for name, value in values.items()
        for control in (name, f"{name}_left", f"{name}_right")
        if control in known
    }


def settle(simulation: sim.Simulation, values: Mapping[str, float], *, frames: int = 60) -> Array:
    """Pose the face from rest and return how far it moved [mm], shape (V, 3)."""
    simulation.reset()
    simulation.set_all(values)
    for _ in range(frames):
        simulation.step(FRAME)
    moved: Array = simulation.positions - simulation.rest_positions
    return moved


def moved_landmarks(head: Any, moved: Array, *numbers: int) -> Array:
    """Mean displacement [mm] of some landmarks, shape (3,)."""
    mean: Array = moved[head.landmarks[list(numbers)]].mean(axis=0)
    return mean


def inverted_triangles(faces: npt.NDArray[np.int32], rest: Array, now: Array) -> int:
    """How many triangles turned their normal by more than a right angle."""

    def normals(x: Array) -> Array:
        return np.cross(x[faces[:, 1]] - x[faces[:, 0]], x[faces[:, 2]] - x[faces[:, 0]])

    return int(((normals(rest) * normals(now)).sum(axis=1) < 0.0).sum())


def without(head: Any, *names: str) -> SimpleNamespace:
    """A copy of a head that lacks some attributes."""
    every = ("vertices", "faces", "landmarks", "mandible_weight", "jaw_axis", "eyes", "rig")
    kept = {name: getattr(head, name) for name in every if name not in names}
    return SimpleNamespace(**kept)


def lip_gap(simulation: sim.Simulation, head: Any) -> float:
    """Greatest vertical distance [mm] between the inner lip landmarks."""
    y = simulation.positions[head.landmarks, 1]
    return float(max(y[u] - y[low] for u, low in ((61, 67), (62, 66), (63, 65))))


def lip_slit(
    positions: Array, triangles: npt.NDArray[Any], corners: Array, *, yaw: float, pitch: float
) -> float:
    """Greatest height [mm] of the slit between the lips that one looks through.

    `corners`: of the mouth (2, 3); `yaw`, `pitch`: from where one looks [degrees], 0 is the front.
    Lines of sight lie in 40 vertical planes; what no triangle near the mouth covers is open.
    """
    turn = _turned_by(yaw, pitch)
    x, ends = positions @ turn.T, corners @ turn.T
    middle = ends.mean(axis=0)
    near = x[triangles]
    near = near[np.linalg.norm(near.mean(axis=1) - middle, axis=1) < 45.0]
    left, right = sorted(ends[:, 0])
    widest = 0.0
    for column in np.linspace(left + 1.0, right - 1.0, 40):
        crossed = near[(near[:, :, 0].min(axis=1) < column) & (near[:, :, 0].max(axis=1) > column)]
        start, end = crossed, np.roll(crossed, -1, axis=1)
        run = end[:, :, 0] - start[:, :, 0]
        share = (column - start[:, :, 0]) / np.where(run == 0.0, np.inf, run)
        height = start[:, :, 1] + share * (end[:, :, 1] - start[:, :, 1])
        meets = (share >= 0.0) & (share <= 1.0) & (run != 0.0)
        low = np.where(meets, height, np.inf).min(axis=1)
        high = np.where(meets, height, -np.inf).max(axis=1)
        order = np.argsort(low)
        reached = np.maximum.accumulate(high[order])[:-1]
        open_above = low[order][1:] - reached
        beside_mouth = np.abs(reached - middle[1]) < SLIT_WINDOW
        widest = max(widest, float(open_above[beside_mouth].max(initial=0.0)))
    return widest


def _turned_by(yaw: float, pitch: float) -> Array:
    """Rotation that brings the look from `yaw`, `pitch` [degrees] to the front."""
    a, b = np.radians([yaw, pitch])
    about_y = [[np.cos(a), 0.0, np.sin(a)], [0.0, 1.0, 0.0], [-np.sin(a), 0.0, np.cos(a)]]
    about_x = [[1.0, 0.0, 0.0], [0.0, np.cos(b), -np.sin(b)], [0.0, np.sin(b), np.cos(b)]]
    return np.array(about_x) @ np.array(about_y)


def lid_gaps(simulation: sim.Simulation, head: Any, *, corners: Array | None = None) -> list[float]:
    """Greatest vertical opening [mm] through which each eyeball is seen from the front.

    `corners`: of the triangles that are looked at (M, 3, 3); without, those of the simulation.

    Rays along -z start in front of the eye on a grid; an opening is a run of rays in one column
    that meet no skin.
    """
    if corners is None:
        corners = simulation.positions[head.faces]
    gaps = []
    for numbers in ((36, 39), (42, 45)):
        ends = np.sort(simulation.positions[head.landmarks[list(numbers)], 0])
        middle = simulation.positions[head.landmarks[list(numbers)], 1].mean()
        columns = np.linspace(ends[0] + 3.0, ends[1] - 3.0, 23)
        heights = middle + np.arange(-9.0, 9.0, 0.1)
        near = corners[np.abs(corners[:, :, 0].mean(axis=1) - ends.mean()) < 25.0]
        near = near[(np.abs(near[:, :, 1].mean(axis=1) - middle) < 25.0)]
        near = near[near[:, :, 2].max(axis=1) > 60.0]
        widest = 0.0
        for x in columns:
            covered = _covered(near, x, heights)
            run = 0
            for hit in covered:
                run = 0 if hit else run + 1
                widest = max(widest, 0.1 * run)
        gaps.append(widest)
    return gaps


def _covered(triangles: np.ndarray, x: float, heights: np.ndarray) -> np.ndarray:
    """Which rays along z at (x, height) meet a triangle."""
    a, b, c = (triangles[:, k, :2] for k in range(3))
    points = np.stack([np.full_like(heights, x), heights], axis=1)[:, None]

    def side(p: np.ndarray, q: np.ndarray) -> np.ndarray:
        along, to = q - p, points - p
        return along[:, 0] * to[:, :, 1] - along[:, 1] * to[:, :, 0]

    sides = np.stack([side(a, b), side(b, c), side(c, a)])
    inside = (sides >= 0.0).all(axis=0) | (sides <= 0.0).all(axis=0)
    return inside.any(axis=1)
