"""Make locks: thin ribbons of a few hairs each, which grow on the layers of hair.

Seen from the side, layers (render/shaders/shells.glsl) have a smooth outline. Ends of locks break
this outline, and single hairs grow in front of the hairline.

Source: Ward, Bertails, Kim, Marschner, Cani, Lin 2007, "A survey on hair modeling", section 2.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ...geometry.arrays import Floats32, Floats64, Integers32, Integers64
from ...geometry.directions import unit_vectors
from ...geometry.steps import smoothstep
from ..model import Part

MEAN_PLACE = 0.6  # fraction of a strand's length at which vertices of layers lie
STATION_COUNT = 3  # points along a lock: root, middle and tip
VERTEX_COUNT = 2 * STATION_COUNT  # vertices of a lock
# Taper of tips. Both vertices of a tip have nearly one place, but two sides of the drawn pixel.
# With one vertex a tip would be a row of dots.
LEAST_TAPER = 0.01
FINEST_RADIUS = 0.05  # [mm]; radius with which a single hair is drawn


@dataclass(frozen=True)
class Growth:
    """How locks grow on the layers of hair; chosen by eye.

    count: number of locks, which are evenly spaced in dense hair.
    root: where locks begin, as a fraction of the longest strands of the layers.
    tip: where locks end on average, as a fraction of the longest strands.
    least: length of strands that locks assume at least [mm]. longest: greatest length of locks
    [mm]. spread: sideways deviation of tips, as a fraction of the length.
    half: half the width of the widest lock at its root [mm].
    lying: how flat locks lie on the layers, 0 to 1.
    radius: radius of the head around which locks bend [mm]; 0: that of the layers at their roots.
    fringe: how much denser locks are at hems: 0 as elsewhere, 1 twice as dense.
    """

    count: int
    root: float
    tip: float
    least: float
    longest: float
    spread: float
    half: float
    lying: float = 0.0
    radius: float = 95.0
    fringe: float = 3.0


SHORT_HAIR = Growth(
    6600, root=0.15, tip=1.02, least=2.2, longest=18.0, spread=0.32, half=0.05, lying=0.03
)
TIED_HAIR = Growth(
    count=4400,
    root=0.5,
    tip=1.7,
    least=5.0,
    longest=18.0,
    spread=0.07,
    half=0.22,
    lying=1.0,
    radius=0.0,
)
FALLING_HAIR = Growth(
    count=500,
    root=0.4,
    tip=3.0,
    least=10.0,
    longest=24.0,
    spread=0.12,
    half=0.08,
    lying=1.0,
    radius=75.0,
    fringe=-1.0,
)
TIP_GROWTH = Growth(
    count=800,
    root=0.6,
    tip=3.0,
    least=3.6,
    longest=9.0,
    spread=0.1,
    half=0.15,
    lying=1.0,
    radius=400.0,
    fringe=1.0,
)  # of cut hair, on the last millimetres
INNER_TIPS = replace(TIP_GROWTH, root=-0.1, tip=1.6)  # seen from within, before the innermost layer
# Hair on a knot, which is rounder.
WOUND_HAIR = replace(FALLING_HAIR, count=350, longest=22.0, radius=30.0)


def locks_on(hair: Part, growth: Growth) -> Part:
    """Make the locks on layers of hair; they are wide in dense hair, and single hairs at hems."""
    assert hair.striation is not None
    chances = _random_shares(growth.count)
    faces, barycentric = _growth_places(hair, growth.fringe, chances[:, :3])
    corners = hair.faces[faces]
    columns = np.hstack([hair.vertices, hair.normals, hair.striation[:, 1:6], hair.colours])
    at = sum(barycentric[:, k, None] * columns[corners[:, k]] for k in range(3))
    root, normal, away, way, dense, colour = np.split(at, [3, 6, 7, 10, 11], axis=1)
    normal = unit_vectors(normal)
    long = np.sqrt(_dot(way, way))
    ahead = way / np.maximum(long, 1e-6)
    across = unit_vectors(np.cross(normal, ahead) + 1e-6)
    # Neighbouring locks lean alike; each also has a small random lean.
    alone = chances[:, 3:6] - np.float32(0.5)
    lean = growth.spread * (waves(root, 0.45) + 1.2 * alone[:, :1])
    ahead -= growth.lying * _dot(ahead, normal) * normal
    # On lying hair only few locks stand off.
    risen = alone[:, 1:2] * (1.0 - growth.lying * (1.0 - 6.0 * alone[:, 1:2] ** 4))
    rise = growth.spread * (0.4 * (1.0 - growth.lying) * waves(root, 1.7, 2.0) + risen)
    # Around a whorl, where layers stand up, locks lie in all directions.
    upright = _rise_around_whorl(_dot(ahead, normal), away)
    stray = 5.0 * upright * (chances[:, 8:11] - np.float32(0.5))
    ahead = unit_vectors(ahead + lean * across + rise * normal + stray)
    reach = (growth.tip - growth.root) * (1.0 + 0.8 * alone[:, 2:3])
    length = np.minimum(reach * np.maximum(long, growth.least), growth.longest)
    t = np.linspace(0.0, 1.0, STATION_COUNT, dtype=np.float32)[:, None]
    # Locks bend around the head, so their tips hang.
    curved = 1.0 / growth.radius if growth.radius else _curvatures(hair, corners, ahead)
    bend = 0.5 * curved * length**2 * normal
    start = root + (growth.root - MEAN_PLACE) * way
    midpoints = start[:, None] + t * (length * ahead)[:, None] - t * t * bend[:, None]
    along = unit_vectors((length * ahead)[:, None] - 2.0 * t * bend[:, None])
    tapering = np.maximum(1.0 - t**2, LEAST_TAPER)
    half = _half_widths(growth, dense, upright, chances[:, 6:7])[:, None] * tapering
    tone = 1.0 + (0.3 + 1.2 * upright) * (chances[:, 7:8] - 0.5)
    light = tone[:, None] * (0.84 + 0.26 * t)
    opacity = np.clip(t / 0.3, 0.15, 1.0) * np.ones_like(half)
    ribbons = Ribbons(midpoints, along, normal, half, light * colour[:, None], opacity)
    return ribbon_part(hair, ribbons, growth.half)


class Ribbons(NamedTuple):
    """n locks with m stations each, from root to tip.

    midpoints: places of stations [mm], (n, m, 3). along: unit directions there, (n, m, 3).
    normals: of the hair below each lock, (n, 3). halves: half the widths at stations [mm],
    (n, m, 1). colours: sRGB, (n, m, 3). opacity: 0 to 1, (n, m, 1).
    """

    midpoints: Floats64
    along: Floats64
    normals: Floats64
    halves: Floats64
    colours: Floats64
    opacity: Floats64


def ribbon_part(hair: Part, ribbons: Ribbons, radius: float) -> Part:
    """Make the part of locks on layers of hair; radius: half the width of the widest lock [mm]."""
    midpoints, along, normals, halves, colours, opacity = ribbons
    count, station_count = midpoints.shape[:2]
    sides = np.cross(normals[:, None], along) * halves

    def rows(first: Floats32 | Floats64, second: Floats32 | Floats64 | None = None) -> Floats32:
        """Return values of both sides of stations as rows of vertices."""
        both = np.stack([first, first if second is None else second], axis=2)
        return np.ascontiguousarray(both.reshape(2 * count * station_count, -1), np.float32)

    every = np.broadcast_to(normals[:, None], midpoints.shape)
    return replace(
        hair,
        name=hair.name + "_locks",
        vertices=rows(midpoints + sides, midpoints - sides),
        normals=rows(every),
        faces=_ribbon_faces(count, station_count),
        colours=rows(np.clip(colours, 0.0, 1.0)),
        strand_radius=radius,
        striation=np.hstack([rows(along), rows(halves, -halves), rows(opacity)]),
    )


def _curvatures(hair: Part, corners: Integers32, ahead: Floats64) -> Floats64:
    """Return curvatures of the layers along n locks [1/mm], (n, 1).

    corners: vertices of the faces on which locks grow, (n, 3). ahead: unit directions, (n, 3).
    """
    places, normals = (each[corners].astype(np.float64) for each in (hair.vertices, hair.normals))
    first = places[:, 1] - places[:, 0]
    second = places[:, 2] - places[:, 0]
    # The solution of ahead = a * first + b * second within the face.
    square = _dot(first, first)
    mixed = _dot(first, second)
    other = _dot(second, second)
    along_first = _dot(first, ahead)
    along_second = _dot(second, ahead)
    area = np.maximum(square * other - mixed**2, 1e-6)
    a = (other * along_first - mixed * along_second) / area
    b = (square * along_second - mixed * along_first) / area
    turn_first = normals[:, 1] - normals[:, 0]
    turn_second = normals[:, 2] - normals[:, 0]
    turned = a * turn_first + b * turn_second
    least_radius = 25.0  # [mm]
    greatest_radius = 400.0  # [mm]
    return np.clip(_dot(turned, ahead), 1.0 / greatest_radius, 1.0 / least_radius)


def _half_widths(growth: Growth, dense: Floats64, upright: Floats64, chance: Floats32) -> Floats64:
    """Return half the widths of locks at their roots [mm]; all arrays are (n, 1).

    dense: density of the layers. upright: as of `_rise_around_whorl`. chance: 0 to 1.
    """
    at_whorl = 0.4  # [mm]; locks are wide where layers show no strands
    wider = growth.half - FINEST_RADIUS + at_whorl * upright
    thick = np.clip((dense - 0.3) / 0.9, 0.0, 1.0) * (0.35 + 0.65 * chance)
    return np.asarray(FINEST_RADIUS + wider * thick)


def _rise_around_whorl(rise: Floats64, away: Floats64) -> Floats64:
    """Return how far layers stand up around a whorl, 0 to 0.4.

    Layers also stand up in the hollow of the nape, where upright locks would look like thorns.
    rise: sine of the angle between strands and skin. away: distance from the whorl [mm].
    """
    return np.asarray(np.clip(rise - 0.6, 0.0, 0.4) * smoothstep(away, 45.0, 30.0))


def _dot(first: Floats64, second: Floats64) -> Floats64:
    """Return dot products of vectors, (..., 3) -> (..., 1)."""
    return np.asarray(np.einsum("...i,...i->...", first, second)[..., None])


@lru_cache(maxsize=4)
def _random_shares(count: int) -> Floats32:
    """Draw random numbers of locks, 0 to 1, (count, 11); those in the first column rise."""
    found = np.random.default_rng(0).random((count, 11), np.float32)
    found[:, 0] = (np.arange(count) + found[:, 0]) / count
    return found


def _growth_places(hair: Part, fringe: float, chances: Floats32) -> tuple[Integers64, Floats32]:
    """Choose the faces of hair on which n locks grow, (n,), and barycentric weights, (n, 3)."""
    assert hair.striation is not None
    a, b, c = np.moveaxis(hair.vertices[hair.faces], 1, 0)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    dense = hair.striation[:, 5][hair.faces].mean(axis=1)
    way = hair.striation[:, 2:5]
    lengths = np.maximum(np.linalg.norm(way, axis=1), 1e-6)
    rise = (way * hair.normals).sum(axis=1) / lengths
    upright = _rise_around_whorl(rise, hair.striation[:, 1].astype(np.float64))[hair.faces[:, 0]]
    # Locks are denser at the hem, and sparse in front of it. They are densest at a whorl, where
    # layers show no strands.
    weights = area * np.clip(0.2 + 5.0 * dense, 0.0, 1.0) * (1.0 + fringe * (dense < 0.7))
    weights *= 1.0 + 8.0 * upright
    ends = np.cumsum(weights)
    faces = np.searchsorted(ends, chances[:, 0] * ends[-1], side="right")
    root = np.sqrt(chances[:, 1])
    side = chances[:, 2]
    barycentric = np.stack([1.0 - root, root * (1.0 - side), root * side], axis=1)
    return np.minimum(faces, len(weights) - 1), barycentric


def waves(places: Floats64, pace: float, turn: float = 0.0) -> Floats32:
    """Evaluate a smooth field at points, about -1 to 1, (n, 1); pace: wave number [rad/mm]."""
    x, y, z = np.moveaxis(pace * places + np.float32(turn), 1, 0)
    bent_wave = np.sin(x + 1.3 * np.sin(0.7 * z))
    field = bent_wave + np.sin(1.1 * y + z) + np.sin(0.9 * z - 0.8 * x)
    return np.asarray(0.5 * field[:, None], np.float32)


@lru_cache(maxsize=4)
def _ribbon_faces(count: int, station_count: int) -> Integers32:
    """Return the faces of locks, counter-clockwise from outside, (n, 3)."""
    one = []
    for k in range(0, 2 * station_count - 2, 2):
        one += [(k, k + 1, k + 2), (k + 2, k + 1, k + 3)]
    firsts = 2 * station_count * np.arange(count, dtype=np.int32)
    found = (firsts[:, None, None] + np.array(one, np.int32)).reshape(-1, 3)
    found.flags.writeable = False
    return found
