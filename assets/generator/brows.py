"""Eyebrows: some hundred hairs, each a curved, tapering stroke on the surface of the face.

At the inner end hairs stand up; along the brow the lower ones lean up and outward, the upper ones
down and outward, so that they meet on its spine; at the tail all follow it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from .fields import Points, Values, project, smooth_step
from .form import distance, from_front

HAIRS = 640  # of one brow; chosen: skin shows through, but no gap catches the eye
SEED = 5
# The spine in front view through the brow landmarks, lowered: they lie near its upper edge [mm].
SPINE = (
    (8.0, 15.2), (12.0, 16.3), (20.5, 18.6), (30.5, 20.3), (40.0, 19.9), (48.0, 16.2), (51.5, 13.8),
)  # fmt: skip
# Along the brow 0..1: half the height of the brow [mm], below and above the spine
ALONG = (0.0, 0.08, 0.3, 0.6, 0.8, 1.0)
BELOW = (2.2, 4.2, 4.6, 3.9, 2.9, 1.2)
ABOVE = (2.0, 4.4, 4.9, 4.2, 3.0, 1.0)
# Direction of the hairs [deg], counter-clockwise from straight outward, at the lower edge and at
# the upper, and their length [mm]
LOW_ANGLE = (84.0, 70.0, 42.0, 20.0, -12.0, -32.0)
HIGH_ANGLE = (66.0, 44.0, 4.0, -14.0, -32.0, -42.0)
LENGTH = (4.2, 5.6, 7.2, 7.4, 6.4, 4.6)
WIDTH = (0.13, 0.30)  # [mm] of a hair at its root; thicker than life, as two lie side by side
STEPS = 6
REACH = 14.0  # [mm] around the spine in which texels are looked at


@dataclass(frozen=True)
class Hair:
    """One stroke: its line [mm], shape (STEPS + 1, 3), width at the root [mm], and lightness."""

    line: Points
    width: float
    lightness: float


def _spine() -> scipy.interpolate.CubicSpline:
    control = np.array(SPINE)
    steps = np.linalg.norm(np.diff(control, axis=0), axis=1)
    return scipy.interpolate.CubicSpline(np.r_[0.0, np.cumsum(steps)] / steps.sum(), control)


def hairs(side: int = 1) -> list[Hair]:
    """The hairs of a brow, on the left; side -1: those that are mirrored to the right."""
    random = np.random.default_rng(SEED + side)
    along = random.beta(1.15, 1.5, HAIRS)  # fewer at both ends: the brow begins and ends softly
    across = np.clip(random.normal(-0.08, 0.62, HAIRS), -1.2, 1.15)  # -1 lower edge, 1 upper
    thickness = np.where(across < 0, np.interp(along, ALONG, BELOW), np.interp(along, ALONG, ABOVE))
    inner_end = smooth_step(0.22, 0.0, along)
    aside = random.normal(0.0, 0.5, HAIRS) * (1.0 + 2.4 * inner_end)
    offset = np.column_stack([aside, across * thickness])
    low, high = np.interp(along, ALONG, LOW_ANGLE), np.interp(along, ALONG, HIGH_ANGLE)
    angle = np.radians(low + (high - low) * 0.5 * (across + 1.0) + random.normal(0.0, 11.0, HAIRS))
    turn = np.radians(random.normal(-32.0, 18.0, HAIRS)) * (1.0 - 0.4 * along)  # bends outward
    length = np.interp(along, ALONG, LENGTH) * random.uniform(0.55, 1.1, HAIRS)
    length *= 1.0 - 0.35 * np.clip(across, 0.0, 1.0)

    lines = _grown(_spine()(along) + offset, angle, turn, length)
    widths = random.uniform(*WIDTH, HAIRS) * (1.0 - 0.3 * np.abs(across)) * (1.0 - 0.15 * inner_end)
    lightness = random.uniform(0.0, 1.0, HAIRS)
    return [Hair(*parts) for parts in zip(lines, widths, lightness, strict=True)]


def _grown(roots: Points, angle: Values, turn: Values, length: Values) -> Points:
    """Lines on the face from roots in front view, shape (n, STEPS + 1, 3)."""
    # The face turns away: in front view a step outward looks shorter than it is.
    rise = from_front(roots[:, 0] + 0.5, roots[:, 1]) - from_front(roots[:, 0] - 0.5, roots[:, 1])
    foreshortening = 1.0 / np.hypot(1.0, rise[:, 2])
    flat = [roots]
    for step in range(STEPS):
        direction = angle + turn * (step + 0.5) / STEPS
        move = np.column_stack([np.cos(direction) * foreshortening, np.sin(direction)])
        flat.append(flat[-1] + move * (length / STEPS)[:, None])
    x, y = np.stack(flat, axis=1).transpose(2, 0, 1)
    return from_front(x.ravel(), y.ravel()).reshape(len(roots), STEPS + 1, 3)


def _coverage(points: Points, hair: Hair, grain: float) -> Values:
    """How much of a texel the hair covers, shape (n,)."""
    best = np.full(len(points), np.inf)
    place = np.zeros(len(points))
    for k in range(STEPS):
        start, edge = hair.line[k], hair.line[k + 1] - hair.line[k]
        part = np.clip((points - start) @ edge / (edge @ edge), 0.0, 1.0)
        away = np.linalg.norm(points - start - part[:, None] * edge, axis=1)
        nearer = away < best
        best[nearer], place[nearer] = away[nearer], (k + part[nearer]) / STEPS
    width = hair.width * (1.0 - 0.85 * place**1.5) * (0.55 + 0.45 * smooth_step(0.0, 0.15, place))
    fade = smooth_step(1.02, 0.7, place)
    filtered = np.maximum(width, grain)  # a hair thinner than a texel covers part of it
    cover = smooth_step(0.5, -0.5, (best - 0.5 * filtered) / grain) * np.minimum(width / grain, 1.0)
    return np.asarray(cover * fade, dtype=np.float64)


def brow_cover(points: Points, grain: float, side: int) -> tuple[Values, Values, Values]:
    """Cover by hairs, their lightness and the soft tint of the skin between them, each (n,).

    points: of texels [mm], shape (n, 3). grain: size of a texel [mm]. side: as of `hairs`.
    """
    strokes = hairs(side)
    cover, lightness, shade = np.zeros((3, len(points)))
    roots = np.array([hair.line[0] for hair in strokes])
    near = np.flatnonzero(
        scipy.spatial.cKDTree(roots).query(points, distance_upper_bound=REACH)[0] < REACH
    )
    surface = project(distance, points[near], rounds=2)
    tree = scipy.spatial.cKDTree(surface)
    for hair in strokes:
        centre, radius = hair.line[STEPS // 2], np.linalg.norm(hair.line[-1] - hair.line[0])
        beside = np.array(tree.query_ball_point(centre, 0.55 * radius + 0.6), dtype=np.int64)
        share = _coverage(surface[beside], hair, grain)
        target = near[beside]
        lightness[target] += share * (hair.lightness - lightness[target])
        cover[target] = 1.0 - (1.0 - cover[target]) * (1.0 - 0.80 * share)
    shade[near] = tint(surface)
    return cover, lightness, shade


def tint(points: Points) -> Values:
    """How far fine hairs that are not drawn one by one darken the skin, 0 to 1, shape (n,)."""
    return np.asarray(smooth_step(1.35, 0.2, across_brow(points)), dtype=np.float64)


def across_brow(points: Points) -> Values:
    """How far from the spine of the brow, 1 at its edge, more at both ends, shape (n,)."""
    dense = np.linspace(0.0, 1.0, 200)
    line = _spine()(dense)
    index = scipy.spatial.cKDTree(line).query(points[:, :2])[1]
    along = dense[index]
    rise = points[:, 1] - line[index, 1]
    height = np.where(rise > 0, np.interp(along, ALONG, ABOVE), np.interp(along, ALONG, BELOW))
    across = np.hypot(points[:, 0] - line[index, 0], rise) / np.maximum(height, 0.8)
    ends = smooth_step(0.12, 0.0, along) + smooth_step(0.85, 1.0, along)
    return np.where(points[:, 2] > 0.0, across + ends, np.inf)
