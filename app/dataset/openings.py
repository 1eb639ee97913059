"""Measure the visible openings of mouth and eyes: the heights of the gaps between lips or lids.

Distances between landmarks do not measure them: pressed lips roll inward, and shut lids lie on each
other, but landmarks on their edges stay millimetres apart.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from risorius.geometry.arrays import Flags, Floats64

LOWER_EDGES = {  # landmarks of a lower lip's inner edge and of lower lids, from corner to corner
    "mouth": (60, 67, 66, 65, 64),
    "eye_right": (36, 41, 40, 39),
    "eye_left": (42, 47, 46, 45),
}


def apertures(
    positions: Floats64, triangles: npt.NDArray[Any], landmarks: Floats64
) -> dict[str, float]:
    """Return the openings of mouth and eyes, seen along z: name -> height [mm].

    positions: vertices [mm], (V, 3). triangles: (F, 3). landmarks: current positions [mm], (68, 3).
    """
    found = {}
    for name, numbers in LOWER_EDGES.items():
        edge = landmarks[list(numbers)]
        # Only skin within this distance [mm] can cover an opening.
        near = around(positions[triangles], (edge[0] + edge[-1]) / 2.0, 60.0)
        found[name] = round(opening(near, edge), 3)
    return found


def opening(near: Floats64, edge: Floats64) -> float:
    """Return the greatest height [mm] of the gap above a lower lip or lid, seen along z.

    near: triangles of the skin nearby, (m, 3, 3). edge: points of the lower edge, (n, 3).
    """
    near = near[to_viewer(near)]  # back faces cover nothing
    left, right = sorted(edge[[0, -1], 0])
    end_width = 1.0  # [mm] beside a corner that are left out, because lips or lids are joined there
    # Vertical planes across the opening, which contain lines of sight.
    columns = np.linspace(left + end_width, right - end_width, 40)
    from_left = edge[np.argsort(edge[:, 0])]
    heights = np.interp(columns, from_left[:, 0], from_left[:, 1])
    x = near[:, :, 0]
    is_begun = x.min(axis=1) < columns[:, None]
    is_crossed = is_begun & (x.max(axis=1) > columns[:, None])
    column, triangle = np.nonzero(is_crossed)
    cut, meets = cut_by(near[triangle], columns[column, None])
    low = np.where(meets, cut[:, :, 1], np.inf).min(axis=1)
    high = np.where(meets, cut[:, :, 1], -np.inf).max(axis=1)
    first = np.searchsorted(column, np.arange(len(columns) + 1)).tolist()
    return max(
        _widest_gap(low[start:end], high[start:end], height)
        for start, end, height in zip(first, first[1:], heights, strict=False)
    )


def around(triangles: Floats64, centre: Floats64, reach: float) -> Floats64:
    """Return the triangles (n, 3, 3) whose centres lie within `reach` [mm] of a point (3,)."""
    near: Floats64 = triangles[np.linalg.norm(triangles.mean(axis=1) - centre, axis=1) < reach]
    return near


def _widest_gap(low: Floats64, high: Floats64, height: float) -> float:
    """Return the greatest height [mm] of a gap between the triangles that a plane cuts.

    The gap must begin near `height`. low, high: heights between which the plane cuts each triangle
    [mm], (n,).
    """
    order = np.argsort(low)
    reached = np.maximum.accumulate(high[order])[:-1]
    open_above = low[order][1:] - reached
    window = 5.0  # [mm] from the lower edge within which the opening must begin
    return float(open_above[np.abs(reached - height) < window].max(initial=0.0))


def to_viewer(triangles: Floats64) -> Flags:
    """Return whether each triangle (n, 3, 3) faces the viewer; flags (n,)."""
    one = triangles[:, 1] - triangles[:, 0]
    other = triangles[:, 2] - triangles[:, 0]
    facing: Flags = one[:, 0] * other[:, 1] > one[:, 1] * other[:, 0]
    return facing


def cut_by(triangles: Floats64, x: float | Floats64) -> tuple[Floats64, Flags]:
    """Cut the sides of triangles (n, 3, 3) with planes of constant x.

    x: one plane for all triangles, or one for each, (n, 1). Returns the points where planes meet
    the lines of the sides, (n, 3, 3), and whether they lie within the sides, (n, 3).
    """
    end = np.roll(triangles, -1, axis=1)
    start_x = triangles[:, :, 0]
    run = end[:, :, 0] - start_x
    is_flat = run == 0.0
    fraction = (x - start_x) / np.where(is_flat, np.inf, run)
    points = triangles + fraction[:, :, None] * (end - triangles)
    meets = (fraction >= 0.0) & (fraction <= 1.0) & ~is_flat
    return points, meets
