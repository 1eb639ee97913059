"""Hair that falls beside the face: strands run over the head from a parting, then hang down.

It is drawn as short hair is (hair.py): one surface of strands side by side, in layers from the
inside out, and a second one that is seen from within.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import scipy

from risorius.geometry.normals import vertex_normals

from ..model import FloatArray, Part
from ..smooth import unit
from ..topology import grid_faces
from .hair import HAIR, MEAN, Fall, Scalp

STRANDS, SAMPLES = 26, 20  # of one side, and along each
ABOVE_EARS, BEHIND_EARS = 22.0, 8.0  # [mm] that the middle of the head lies so
WIDEST = np.radians(-6.0)  # how far below it strands leave the head
ROUNDED = np.radians(12.0)  # beside that edge, as far as hair is thinner
EDGE = np.radians(60.0)  # from the face's middle, from where on hair hangs beside it
SHARP, HIGHEST = 120.0, 24.0  # of the mean over directions that tells how far the skin is
CLEAR = 3.5  # [mm] of the inner side, off the skin
SLIDE = 1.3  # of layers along strands, beside their distance
OUTER = 0.4  # of the volume, that layers fill
FINE = 0.22  # of the way along strands, in which they change less than short ones
HEM, RAGGED = 20.0, 4.0  # [mm] over which tips thin out, and by which they are uneven
PARTED, FRONT = 2.0, 6.0  # [mm] over which hair gets dense from the parting, from the face
FULL = 2.0  # density where no layer is thin
VOLUME = 14.0  # [mm] that it stands off the head
LOW, RISES = 0.4, 0.3  # of the volume at the roots, and of the way over the head until it is whole
LIMP = 2.0  # steps along strands, over which they bend from the head
THIN_ENDS, CURVED_IN = 0.8, 0.14  # of the volume and of the radius, that tips have less
SLEEK = 0.45  # how much it shines
AT_A_POINT = 0.01  # share of the way out in normals: where strands meet there is no triangle


class _Strands(NamedTuple):
    """Strands of one side, from root to tip: inner and outer side, across and along them [mm]."""

    inner: FloatArray
    outer: FloatArray
    across: FloatArray
    along: FloatArray
    left: FloatArray


def falling_hair(
    cut: Fall, scalp: Scalp, head: Any, colour: FloatArray, length: float
) -> tuple[Part, ...]:
    """The parts that are drawn as hair, the inner side first.

    head: with vertices and anatomy. colour: sRGB, shape (3,); length: beside that of the cut.
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

    end = ear[1] - cut.below * length
    sides = [(side, _strands(cut, side, head, middle, skin, end)) for side in (-1.0, 1.0)]
    return tuple(
        _surface(strands, side, colour, is_inside=is_inside)
        for is_inside in (True, False)
        for side, strands in sides
    )


def _strands(
    cut: Fall,
    side: float,
    head: Any,
    middle: FloatArray,
    skin: Callable[[FloatArray], FloatArray],
    end: float,
) -> _Strands:
    """Strands of a side, 1 the subject's left, that end at a height."""
    share = np.linspace(0.0, 1.0, STRANDS)
    crown = head.vertices[head.anatomy["vertex"]] + [0.4 * cut.parting, 0.0, -30.0] - middle
    front = head.vertices[head.anatomy["trichion"]] + [cut.parting, 0.0, -4.0] - middle
    angle = EDGE + (np.pi - EDGE) * share**1.3
    roots = unit(front + (share**0.8)[:, None] * (crown - front))
    flat = np.stack([side * np.sin(angle), np.zeros(STRANDS), np.cos(angle)], axis=-1)
    leave = np.cos(WIDEST) * flat + [0.0, np.sin(WIDEST), 0.0]
    over, drop = np.linspace(0.0, 1.0, SAMPLES), np.linspace(0.0, 1.0, SAMPLES)[1:]
    pairs = zip(roots, leave, strict=True)
    ways = np.array([scipy.spatial.geometric_slerp(*pair, over) for pair in pairs])
    # Beside the face the outer side comes round to the inner one.
    beside = np.clip((angle - EDGE) / ROUNDED, 0.0005, 1.0)[:, None]
    risen = LOW + (1.0 - LOW) * np.sin(0.5 * np.pi * np.clip(over / RISES, 0.0, 1.0))
    thick = VOLUME * risen * np.sqrt(1.0 - (1.0 - beside) ** 2)
    grids = []
    for off in (np.zeros_like(thick), thick):
        grid = middle + (skin(ways) + CLEAR + off)[..., None] * ways
        start = grid[:, -1]
        wide = np.linalg.norm((start - middle)[:, [0, 2]], axis=1)
        wide = wide[:, None] * (1.0 - CURVED_IN * drop**2) - THIN_ENDS * drop**2 * off[:, -1:]
        fall = middle + wide[..., None] * flat[:, None]
        fall[..., 1] = start[:, 1:2] + drop * (end - RAGGED - start[:, 1:2])
        bent = np.concatenate([grid, fall], axis=1)
        # Roots stay where they are.
        beyond = np.pad(bent, ((0, 0), (SAMPLES, 0), (0, 0)), "reflect", reflect_type="odd")
        smooth = scipy.ndimage.gaussian_filter1d(beyond, LIMP, axis=1, mode="nearest")
        grids.append(smooth[:, SAMPLES:])
    return _cut_off(grids[0], grids[1], end, side * 88.0 * angle)


def _cut_off(inner: FloatArray, outer: FloatArray, end: float, across: FloatArray) -> _Strands:
    """Strands that end about a height, in equal steps."""
    uneven = RAGGED * (0.6 * np.sin(0.9 * across) + 0.4 * np.sin(0.37 * across + 1.0))
    rows: list[list[FloatArray]] = [[], [], [], []]
    for low, high, lowest in zip(inner, outer, end + uneven, strict=True):
        along = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(high, axis=0), axis=1)))
        below = np.flatnonzero(high[:, 1] < lowest)
        last = along[below[0]] if len(below) else along[-1]
        at = np.linspace(0.0, last, SAMPLES)
        for row, grid in zip(rows, (low, high), strict=False):
            row.append(np.stack([np.interp(at, along, grid[:, k]) for k in range(3)], axis=-1))
        rows[2].append(at)
        rows[3].append(last - at)
    low, high, along, left = (np.array(row) for row in rows)
    return _Strands(low, high, across, along, left)


def _surface(strands: _Strands, side: float, colour: FloatArray, *, is_inside: bool) -> Part:
    """One of the two surfaces of a side."""
    low, high, across, along, left = strands
    ahead = unit(np.gradient(high, axis=1).reshape(-1, 3)).reshape(high.shape)
    thickness = np.linalg.norm(high - low, axis=-1, keepdims=True)
    way = OUTER * (high - low + SLIDE * thickness * ahead)
    places = high - OUTER * (1.0 - MEAN) * (high - low)
    beside = np.abs(across - across[0])[:, None]
    dense = np.minimum(left / HEM, FULL)
    if is_inside:  # nothing shines through at its front
        way, places = -0.1 * (high - low) + 0.2 * thickness * ahead, 0.5 * (low + high)
    else:
        dense = np.minimum(dense, np.minimum(0.3 + along / PARTED, 0.8 + beside / FRONT))
    points = places.reshape(-1, 3)
    faces = grid_faces(np.arange(len(points)).reshape(along.shape))
    if (side > 0.0) != is_inside:
        faces = faces[:, ::-1]
    normals = unit(vertex_normals(points, faces) + AT_A_POINT * unit((high - low).reshape(-1, 3)))
    if is_inside:
        normals = unit(normals - [0.0, 2.0, 0.0])  # turned from lamps, which do not get there
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
        name=HAIR + "_inside" * is_inside + ("_left" if side > 0.0 else "_right"),
        vertices=points.astype(np.float32),
        normals=normals.astype(np.float32),
        faces=faces,
        colours=np.tile(colour, (len(points), 1)).astype(np.float32),
        bone="cranium",
        shine=SLEEK,
        striation=striation.reshape(-1, 6).astype(np.float32),
    )
