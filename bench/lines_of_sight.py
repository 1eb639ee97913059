"""What one sees through: the slit between closed lips, the opening between closed lids.

Measured by lines of sight, not by distances between vertices: a gap that nobody can look through
is none, and one between two vertices that lie on each other may be one. Looked at is the mesh and
what refinement makes of it, because smoothing thins a folded lip a little.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius import refine, sim
from risorius.app.dataset.openings import LOWER_EDGES, around, cut_by, opening, to_viewer

Array = npt.NDArray[np.float64]
Triangles = npt.NDArray[Any]

YAWS = (0.0, -30.0, 30.0, -60.0, 60.0)  # degrees
PITCHES = (0.0, -10.0, 10.0, -25.0, 25.0, -40.0, 40.0)
VIEWS = tuple(  # the whole front, as far as cameras go round it
    (yaw, pitch)
    for yaw, pitch in itertools.product(YAWS, PITCHES)
    if (yaw / 60.0) ** 2 + (pitch / 40.0) ** 2 < 1.3
)
MOUTH = 60.0  # mm around the mouth's middle in which skin may cover it
EYE_CORNERS = {"right": (36, 39), "left": (42, 45)}  # landmarks
LID_COLUMNS, LID_END = 23, 1.5  # planes across an eye; mm beside its corners not looked at
LID_STEP = 0.05  # mm between lines of sight in a plane
LID_WINDOW = 12.0  # mm above and below the eye's middle
EYE = 70.0  # mm around the eye's middle in which skin may cover it


def meshes_of(
    simulation: sim.Simulation, refiner: refine.Refiner
) -> dict[str, tuple[Array, Triangles]]:
    """Positions [mm] and triangles of the face as it is simulated ("static") and "refined"."""
    drawn = refiner.refine(simulation.positions)
    return {
        "static": (simulation.positions, simulation.faces),
        "refined": (drawn.positions.astype(np.float64), drawn.triangles),
    }


def widest_slit(positions: Array, triangles: Triangles, landmarks: Array) -> float:
    """Greatest height [mm] of the slit between the lips that one looks through from any of VIEWS.

    `landmarks`: where the 68 are now (68, 3).
    """
    lip = landmarks[list(LOWER_EDGES["mouth"])]
    near = around(positions[triangles], (lip[0] + lip[-1]) / 2.0, MOUTH)
    turns = [_turned_by(*view) for view in VIEWS]
    return max(opening(near @ turn.T, lip @ turn.T) for turn in turns)


def _turned_by(yaw: float, pitch: float) -> Array:
    """Rotation that brings the look from `yaw`, `pitch` [degrees] to the front."""
    a, b = np.radians([yaw, pitch])
    about_y = [[np.cos(a), 0.0, np.sin(a)], [0.0, 1.0, 0.0], [-np.sin(a), 0.0, np.cos(a)]]
    about_x = [[1.0, 0.0, 0.0], [0.0, np.cos(b), -np.sin(b)], [0.0, np.sin(b), np.cos(b)]]
    return np.array(about_x) @ np.array(about_y)


def eyeballs_of(head: Any, simulation: sim.Simulation) -> dict[str, Array]:
    """Triangles (n, 3, 3) of the eyeballs that the head brings, turned as they are now, by side."""
    bones, found = simulation.bone_transforms(), {}
    for part in head.parts:
        if part.name.startswith("eyeball_"):
            turn = np.asarray(bones[part.bone], dtype=np.float64)
            x = part.vertices @ turn[:3, :3].T + turn[:3, 3]
            found[part.bone.removeprefix("eye_")] = x[part.faces]
    return found


def lid_gaps(
    positions: Array, triangles: Triangles, landmarks: Array, eyeballs: Mapping[str, Array]
) -> dict[str, float]:
    """Greatest height [mm] at which one sees each eyeball, or past it, from any of VIEWS.

    Seen is what has no skin in front of it, be it between the lids or through them: the cornea
    stands out of the ball and may pierce a lid. `landmarks`: where the 68 are now (68, 3);
    `eyeballs`: see `eyeballs_of`. The result is by the eye's side.
    """
    turns = [_turned_by(*view) for view in VIEWS]
    gaps = {}
    for side, numbers in EYE_CORNERS.items():
        ends, ball = landmarks[list(numbers)], eyeballs[side]
        near = around(positions[triangles], ends.mean(axis=0), EYE)
        gaps[side] = max(_lid_gap(near @ turn.T, ends @ turn.T, ball @ turn.T) for turn in turns)
    return gaps


def _lid_gap(near: Array, ends: Array, ball: Array) -> float:
    """Greatest height [mm] without skin between the corners of an eye (2, 3), along z.

    What has skin above and below it counts.
    """
    near = near[to_viewer(near)]
    left, right = np.sort(ends[:, 0])
    middle, deepest = ends[:, 1].mean(), ball[:, :, 2].min()
    heights = np.arange(middle - LID_WINDOW, middle + LID_WINDOW, LID_STEP)
    widest = 0
    for x in np.linspace(left + LID_END, right - LID_END, LID_COLUMNS):
        covered = _front(near, x, heights) >= np.maximum(_front(ball, x, heights), deepest)
        skin = np.flatnonzero(covered)  # beyond the outermost the head may have ended
        if len(skin):
            widest = max(widest, int((~covered[skin[0] : skin[-1]]).sum()))
    return LID_STEP * widest


def _front(triangles: Array, x: float, heights: Array) -> Array:
    """How far to the front triangles (n, 3, 3) reach in the plane at x, shape (len(heights),).

    -inf where there is none at that height.
    """
    is_crossed = (triangles[:, :, 0].min(axis=1) < x) & (triangles[:, :, 0].max(axis=1) > x)
    cut, meets = cut_by(triangles[is_crossed], x)
    y = np.where(meets, cut[:, :, 1], np.inf)
    ends = np.take_along_axis(cut, np.argsort(y, axis=1)[:, :2, None], axis=1)  # lower, upper
    low, high = ends[:, 0, 1:, None], ends[:, 1, 1:, None]
    share = (heights - low[:, 0]) / np.maximum(high[:, 0] - low[:, 0], 1e-9)
    depth = low[:, 1] + share * (high[:, 1] - low[:, 1])
    inside = (share >= 0.0) & (share <= 1.0)
    reach: Array = np.where(inside, depth, -np.inf).max(axis=0, initial=-np.inf)
    return reach


def sunk_in_eyeballs(positions: Array, rest: Array, triangles: Triangles, eyes: Any) -> float:
    """How deep skin sits in an eyeball at most, deeper than at rest [mm].

    Asked at the corners, at the middles of the edges and in the middle of each triangle: a coarse
    lid whose vertices rest on the ball may still cut into it between them. `eyes`: with a centre
    and a radius each.
    """
    now, before = _points_of(positions[triangles]), _points_of(rest[triangles])
    deepest = 0.0
    for eye in eyes:
        depth = eye.radius - np.linalg.norm(now - np.asarray(eye.centre), axis=2)
        earlier = eye.radius - np.linalg.norm(before - np.asarray(eye.centre), axis=2)
        deepest = max(deepest, float((depth - np.maximum(earlier, 0.0)).max(initial=0.0)))
    return deepest


def _points_of(corners: Array) -> Array:
    """Corners, middles of the edges and middle of triangles (M, 3, 3), shape (M, 7, 3)."""
    middles = (corners + np.roll(corners, -1, axis=1)) / 2.0
    return np.concatenate([corners, middles, corners.mean(axis=1, keepdims=True)], axis=1)
