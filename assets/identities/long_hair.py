"""Hair that falls beside the face: strands run over the head from a parting, then hang down.

It is drawn as short hair is (hair.py): one surface of strands side by side, in layers from the
inside out, and a second one that is seen from within.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from risorius.geometry.normals import vertex_normals

from ..model import FloatArray, Part
from ..smooth import smooth_step, unit
from ..topology import halved, quads_between
from .hair import HAIR, MEAN, Fall, Scalp

STRANDS, SAMPLES = 44, 34  # of one side, and along each
ABOVE_EARS, BEHIND_EARS = 22.0, 8.0  # [mm] that the middle of the head lies so
WIDEST = np.radians(-6.0)  # how far below it strands leave the head
ROUNDED = np.radians(12.0)  # beside that edge, as far as hair is thinner
EDGE = np.radians(60.0)  # from the face's middle, from where on hair hangs beside it
FRINGE = np.radians(38.0)  # up to where it ends above the brows
SHARP, HIGHEST = 120.0, 12.0  # of the mean over directions that tells how far the skin is
CLEAR = 1.5  # [mm] of the inner side, off the skin
SLIDE = 1.3  # of layers along strands, beside their distance
FINE = 0.22  # of the way along strands, in which they change less than short ones
HEM, RAGGED = 6.0, 1.5  # [mm] over which tips thin out, and by which they are uneven
FULL = 3.0  # density where no layer is thin
SWING = 46.0  # [mm] of a wave
CURVED_IN = 0.10  # of the radius, at the tips
SLEEK = 0.45  # how much it shines
AT_A_POINT = 0.01  # share of the way out in normals: where strands meet there is no triangle
DARK = 0.5  # of the light, within


class _Strands(NamedTuple):
    """Strands of one side, from root to tip: inner and outer side, across and along them [mm]."""

    inner: FloatArray
    outer: FloatArray
    across: FloatArray
    along: FloatArray
    left: FloatArray


def falling_hair(cut: Fall, scalp: Scalp, head: Any, colour: FloatArray, length: float) -> Part:
    """The part that is drawn as hair; colour: sRGB, shape (3,); length: beside that of the cut.

    head: with vertices, anatomy and landmarks.
    """
    vertices, at = head.vertices, head.anatomy
    ear = 0.5 * (vertices[at["tragion_left"]] + vertices[at["tragion_right"]])
    middle = np.array([0.0, ear[1] + ABOVE_EARS, ear[2] - BEHIND_EARS])
    solid = np.vstack([scalp.points, vertices[vertices[:, 1] > ear[1] - 60.0]]) - middle
    far = np.linalg.norm(solid, axis=1)

    def skin(ways: FloatArray) -> FloatArray:
        """How far the skin is from the middle [mm] in directions, (..., 3)."""
        weights = np.exp(SHARP * (ways @ (solid / far[:, None]).T - 1.0))
        mean = (weights * far**HIGHEST).sum(axis=-1) / weights.sum(axis=-1)
        return np.asarray(mean ** (1.0 / HIGHEST))

    ends = ear[1] - cut.below * length, vertices[head.landmarks[24]][1] + 13.0
    sides = []
    for side in (-1.0, 1.0):
        strands = _strands(cut, side, head, middle, skin, ends)
        sides.append(_surface(strands, side, colour, is_inside=False))
        sides.append(_surface(strands, side, DARK * colour, is_inside=True))
    return _joined(sides)


def _slerp(first: FloatArray, second: FloatArray, share: FloatArray) -> FloatArray:
    """Directions from the first to the second ones, (n, 3), at shares (m,); shape (n, m, 3)."""
    angle = np.arccos(np.clip((first * second).sum(axis=1), -1.0, 1.0))[:, None, None]
    share = share[None, :, None]
    turned = (
        np.sin((1.0 - share) * angle) * first[:, None] + np.sin(share * angle) * second[:, None]
    )
    return np.asarray(turned / np.sin(angle))


def _strands(
    cut: Fall,
    side: float,
    head: Any,
    middle: FloatArray,
    skin: Callable[[FloatArray], FloatArray],
    ends: tuple[float, float],
) -> _Strands:
    """Strands of a side, 1 the subject's left; ends: heights of tips, and of those of a fringe."""
    vertices, at = head.vertices, head.anatomy
    share = np.linspace(0.0, 1.0, STRANDS)
    apart = 8.0 if cut.parting is None else cut.parting
    crown = vertices[at["vertex"]] + [0.4 * apart, 0.0, -30.0] - middle
    front = vertices[at["trichion"]] + [apart, 0.0, -4.0] - middle
    edge = 0.0 if cut.parting is None else EDGE
    angle = edge + (np.pi - edge) * share**1.3
    back = np.ones(STRANDS) if cut.parting is None else share**0.8
    roots = unit(front + back[:, None] * (crown - front))
    flat = np.stack([side * np.sin(angle), np.zeros(STRANDS), np.cos(angle)], axis=-1)
    leave = np.cos(WIDEST) * flat + [0.0, np.sin(WIDEST), 0.0]
    ways = _slerp(roots, leave, np.linspace(0.0, 1.0, SAMPLES))
    thick = cut.volume * (0.65 + 0.35 * np.sin(np.linspace(0.0, np.pi / 2.0, SAMPLES)))
    # Beside the face the outer side comes round to the inner one.
    beside = np.clip((angle - edge) / ROUNDED, 0.02, 1.0)[:, None]
    thick = thick * (1.0 if cut.parting is None else np.sqrt(1.0 - (1.0 - beside) ** 2))
    radius = skin(ways)
    inner, outer = (
        middle + (radius + CLEAR * beside + off)[..., None] * ways for off in (0.0, thick)
    )
    drop = np.linspace(0.0, 1.0, SAMPLES)[1:, None]
    below = ends[0] - RAGGED - inner[:, -1, 1]
    hanging = []
    for grid in (inner, outer):
        start = grid[:, -1]
        beside = np.linalg.norm((start - middle)[:, [0, 2]], axis=1)
        narrower = 1.0 - CURVED_IN * drop[None] ** 2
        fall = middle + (beside[:, None, None] * narrower) * flat[:, None]
        fall[..., 1] = start[:, None, 1] + drop[None, :, 0] * below[:, None]
        hanging.append(np.concatenate([grid, fall], axis=1))
    inner, outer = hanging
    lowest = np.full(STRANDS, ends[0])
    if cut.parting is None:
        lowest = ends[1] + (ends[0] - ends[1]) * smooth_step(FRINGE, EDGE, angle)
        lowest -= 9.0 * smooth_step(0.1, FRINGE, angle)
    return _cut_off(cut, inner, outer, lowest, side * 88.0 * angle)


def _cut_off(
    cut: Fall, inner: FloatArray, outer: FloatArray, lowest: FloatArray, across: FloatArray
) -> _Strands:
    """Strands that end at heights, (n,), in equal steps."""
    uneven = RAGGED * (0.6 * np.sin(0.9 * across) + 0.4 * np.sin(0.37 * across + 1.0))
    rows: list[list[FloatArray]] = [[], [], [], []]
    for low, high, end in zip(inner, outer, lowest + uneven, strict=True):
        steps = np.linalg.norm(np.diff(high, axis=0), axis=1)
        along = np.concatenate([[0.0], np.cumsum(steps)])
        below = np.flatnonzero(high[:, 1] < end)
        last = along[below[0]] if len(below) else along[-1]
        at = np.linspace(0.0, last, SAMPLES)
        for row, grid in zip(rows, (low, high), strict=False):
            row.append(np.stack([np.interp(at, along, grid[:, k]) for k in range(3)], axis=-1))
        rows[2].append(at)
        rows[3].append(last - at)
    low, high, along, left = (np.array(row) for row in rows)
    ahead = unit(np.gradient(high, axis=1).reshape(-1, 3)).reshape(high.shape)
    aside = np.cross(ahead, high - low) / np.linalg.norm(high - low, axis=-1, keepdims=True)
    phase = 2.0 * np.pi * along / SWING + 0.02 * across[:, None]
    grown = smooth_step(50.0, 130.0, along) * cut.wave
    swing = (grown * np.sin(phase))[..., None] * aside
    swell = (0.06 * grown * np.cos(phase))[..., None] * (high - low)
    return _Strands(low + swing, high + swing + swell, across, along, left)


def _surface(strands: _Strands, side: float, colour: FloatArray, *, is_inside: bool) -> Part:
    """One of the two surfaces of a side."""
    low, high, across, along, left = strands
    ahead = unit(np.gradient(high, axis=1).reshape(-1, 3)).reshape(high.shape)
    thickness = np.linalg.norm(high - low, axis=-1, keepdims=True)
    way = high - low + SLIDE * thickness * ahead
    places, dense = low + MEAN * (high - low), np.minimum(left / HEM, FULL)
    if is_inside:
        way, places = -0.1 * (high - low) + 0.2 * thickness * ahead, low
    points = places.reshape(-1, 3)
    rows = [row.tolist() for row in np.arange(len(points)).reshape(along.shape)]
    faces = halved(points, quads_between(rows, closed=False))
    if (side > 0.0) != is_inside:
        faces = faces[:, ::-1]
    out = unit((high - low).reshape(-1, 3)) * (-1.0 if is_inside else 1.0)
    striation = np.concatenate(
        [
            np.broadcast_to(across[:, None, None], (*along.shape, 1)),
            FINE * along[..., None],
            way,
            dense[..., None],
        ],
        axis=-1,
    )
    return Part(
        name=HAIR,
        vertices=points.astype(np.float32),
        normals=unit(vertex_normals(points, faces) + AT_A_POINT * out).astype(np.float32),
        faces=faces,
        colours=np.tile(colour, (len(points), 1)).astype(np.float32),
        bone="cranium",
        shine=SLEEK,
        striation=striation.reshape(-1, 6).astype(np.float32),
    )


def _joined(parts: list[Part]) -> Part:
    """One part of several alike."""
    starts = np.cumsum([0] + [len(part.vertices) for part in parts[:-1]])
    faces = [part.faces + start for part, start in zip(parts, starts, strict=True)]
    arrays: dict[str, Any] = {
        name: np.concatenate([getattr(part, name) for part in parts])
        for name in ("vertices", "normals", "colours", "striation")
    }
    return replace(parts[0], faces=np.concatenate(faces).astype(np.int32), **arrays)
