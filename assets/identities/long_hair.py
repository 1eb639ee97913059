"""Hair that is longer than the way to its end: it hangs beside the face, or is tied behind it.

It is drawn as short hair is (hair.py), in layers from the inside out over one surface of strands
side by side. Those that hang run over the head from a parting; those that are tied are a rope,
which is wound to a knot or hangs as a tail from where strands over the scalp come together.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy

from risorius.geometry.normals import vertex_normals

from ..model import FloatArray, Part
from ..smooth import smooth_step, unit
from ..topology import grid_faces
from . import hair as short
from .hair import HAIR, Cut, Fall, Scalp, from_within

STRANDS, SAMPLES = 51, 14  # of all, and over the head along each, and as many below
ABOVE_EARS, BEHIND_EARS = 29.0, 8.0  # [mm] that the middle of the head lies so
WIDEST = np.array([0.0, -0.1, 0.0])  # a little below it strands leave the head
EDGE, ROUNDED = np.radians([62.0, 50.0])  # from the face to where hair begins; to where it is whole
SHARP, HIGHEST = 120.0, 24.0  # of the mean over directions that tells how far the skin is
CLEAR = 5.0  # [mm] of the inner side, off the skin
OUTER, SLIDE = 0.4, 1.3  # of the volume, that layers fill; along strands, beside their distance
HEM, RAGGED, LAYERED = 28.0, 6.0, 16.0  # [mm] over which tips thin out, are uneven, rise in front
PARTED, FRONT = 2.0, 11.0  # [mm] over which hair gets dense from the parting, from the face
FULL, VOLUME = 2.0, 9.0  # density where no layer is thin; [mm] that hair stands off the head
LOW, RISES = 0.1, 0.35  # of all that at the roots, and of the way over the head until it is whole
LIMP = 1.3  # steps along strands, over which they bend from the head
THIN_ENDS, CURVED_IN = 0.7, 0.27  # of the volume and of the radius, that tips have less
AT_A_POINT = 0.01  # share of the way out in normals: where strands meet there is no triangle
AROUND, ALONG = 42, 40  # strands of what is tied, and places along them
WITHIN, TIED, FREE = 12.0, 28.0, 75.0  # [mm] within the scalp a tail begins; to its tie; till whole
TIGHT, SPREAD = 0.45, 1.0  # how thick it is there, and on the scalp, beside that
DOWN, RIGHT = np.array([(0.0, -1.0, -0.12), (1.0, 0.0, 0.0)])  # it hangs, clear of the back
STEEP, DIMPLE = 0.8, 0.12  # of a knot's width: its height, and how deep its middle lies
# Locks of a tail and of a knot, how wide they are [mm], how deep it is between, turns they make.
TAIL, KNOT = (6, 24.0, 0.04, 0.1), (3, 13.0, 0.1, 1.8)
BETWEEN = 0.5  # of the light is lost there, below a knot and where a tail is tied
Even = FloatArray | float  # a number may stand for all


def falling_hair(
    cut: Fall, scalp: Scalp, head: Any, colour: FloatArray, length: float
) -> tuple[Part, ...]:
    """The parts that are drawn as hair, the inner side first.

    head: with vertices and anatomy. colour: sRGB, shape (3,); length: beside that of the cut.
    """
    vertices, at = head.vertices, head.anatomy
    ear = 0.5 * (vertices[at["tragion_left"]] + vertices[at["tragion_right"]])
    middle = np.array([0.0, ear[1] + ABOVE_EARS, ear[2] - BEHIND_EARS])
    around = np.linspace(-1.0, 1.0, STRANDS)  # from the right of the face round the back
    share, side = 1.0 - np.abs(around), np.sign(around)
    crown = vertices[at["vertex"]] + [0.4 * cut.parting, 0.0, -30.0] - middle
    front = vertices[at["trichion"]] + [cut.parting, 0.0, -4.0] - middle
    angle = EDGE + (np.pi - EDGE) * share**1.3
    level = np.stack([side * np.sin(angle), 0.0 * angle, np.cos(angle)], axis=-1)
    over, drop = np.linspace(0.0, 1.0, SAMPLES), np.linspace(0.0, 1.0, SAMPLES)[1:]
    roots = unit(front + (share**0.8)[:, None] * (crown - front))
    pairs = zip(roots, unit(level + WIDEST), strict=True)
    ways = np.array([scipy.spatial.geometric_slerp(*pair, over) for pair in pairs])
    across = 88.0 * side * (np.pi - angle)
    uneven = 0.6 * np.sin(0.9 * across) + 0.4 * np.sin(0.37 * across + 1.0)
    # Beside the face the outer side comes round to the inner one.
    beside = np.clip((angle - EDGE) / ROUNDED, 0.0005, 1.0)
    ends = ear[1] - cut.below * length + LAYERED * (1.0 - beside) ** 3 + RAGGED * uneven
    risen = LOW + (1.0 - LOW) * np.sin(0.5 * np.pi * np.clip(over / RISES, 0.0, 1.0))
    thick = VOLUME * risen * np.sin(0.5 * np.pi * beside)[:, None]
    solid = np.vstack([scalp.points, vertices[vertices[:, 1] > ear[1] - 53.0]]) - middle
    far = np.linalg.norm(solid, axis=1)
    weights = np.exp(SHARP * (ways @ (solid / far[:, None]).T - 1.0))
    reach = ((weights * far**HIGHEST).sum(axis=-1) / weights.sum(axis=-1)) ** (1.0 / HIGHEST)
    places = middle + (reach + CLEAR + thick)[..., None] * ways
    start = places[:, -1:]
    wide = np.linalg.norm((start - middle)[..., [0, 2]], axis=-1)
    wide = wide * (1.0 - CURVED_IN * drop**1.6) - THIN_ENDS * drop**2 * thick[:, -1:]
    fall = middle + wide[..., None] * level[:, None]
    fall[..., 1] = start[..., 1] + drop * (ends[:, None] - start[..., 1])
    thick = np.hstack([thick, thick[:, -1:] * (1.0 - THIN_ENDS * drop**2)])
    sharp = np.concatenate([places, fall], axis=1)
    bent = scipy.ndimage.gaussian_filter1d(sharp, LIMP, axis=1, mode="nearest")
    bent[:, 0] = sharp[:, 0]  # roots stay where they are
    along, off = _along(bent), 88.0 * (angle - EDGE)[:, None]
    dense = np.minimum(0.6 + along / PARTED, 0.45 + off / FRONT)
    dense = np.minimum(dense, (along[:, -1:] - along) / HEM)
    hair = _layers(HAIR, bent, across[:, None], thick, dense, colour)
    return from_within(hair, hair.faces), short.loose_hairs(hair), hair


def tied_hair(cut: Cut, scalp: Scalp, colour: FloatArray, length: float) -> tuple[Part, ...]:
    """The parts that are drawn as hair of a cut with a knot, or a tail; see `falling_hair`."""
    points, out = scalp.points, -unit(np.array([cut.whorl]))[0]
    ways = unit(points - 0.5 * (points.min(axis=0) + points.max(axis=0)))
    root, t = points[np.argmax(ways @ out)], np.linspace(0.0, 1.0, ALONG)[:, None]
    if cut.tail:
        far = length * cut.tail * t
        bent, free = smooth_step(WITHIN, FREE, far), smooth_step(TIED, FREE, far)
        ways = unit((1.0 - bent) * out + bent * DOWN)
        line = root - WITHIN * out + np.cumsum(ways * far[1], axis=0)
        thick = TIGHT + (1.0 - TIGHT) * free
        thick += (SPREAD - TIGHT) * (1.0 - smooth_step(0.0, TIED, far))
        thick *= np.sqrt(1.0 - 0.97 * t**4)
        shade = np.exp(-(((far - TIED) / 5.0) ** 2))
        dense = np.minimum(far / WITHIN, (far[-1] - far) / HEM)
        locks, wide, deep, turns = TAIL
    else:  # as a ball from its rim to its middle
        rise = -1.0 + (0.498 * np.pi + 1.0) * t
        thick, ways, free = np.cos(rise), out[None], np.ones_like(t)
        height = STEEP * (np.sin(rise) + 0.5) - DIMPLE * np.exp(-((3.0 * thick) ** 2))
        line = root + cut.knot * height * out
        shade, dense = smooth_step(-0.3, -1.0, rise), FULL + 0.0 * t
        locks, wide, deep, turns = KNOT
    place = np.linspace(0.0, 2.0 * np.pi, AROUND)[:, None, None]
    groove = free * (0.5 + 0.5 * np.cos(locks * place)) ** 3
    turn = np.pi + place + 2.0 * np.pi * turns * t  # begins on the side of the head
    ring = np.cos(turn) * unit(np.cross(RIGHT, ways)) + np.sin(turn) * RIGHT
    places = line + cut.knot * thick * (1.0 - deep * groove) * ring
    light = 1.0 - np.maximum(5.0 * deep * groove, BETWEEN * shade)
    across = locks * wide * place[..., 0] / (2.0 * np.pi)
    tied = _layers(HAIR + "_tied", places, across, VOLUME, dense[:, 0], light * colour)
    return (*short.hair_of(cut, scalp, colour, length), from_within(tied, tied.faces), tied)


def _layers(
    name: str, places: FloatArray, across: FloatArray, thick: Even, dense: Even, colour: FloatArray
) -> Part:
    """Strands side by side, in layers.

    places: along each from its root, where the outermost layer lies [mm], shape (n, m, 3). across,
    thick, dense: their place beside each other [mm], the volume that they fill [mm], how dense they
    are, (n, m). colour: sRGB, (n, m, 3).
    """
    shape = places.shape
    points, number = places.reshape(-1, 3), np.arange(places.size // 3).reshape(shape[:2])
    out = unit(points - points.mean(axis=0))
    normals = unit(vertex_normals(points, grid_faces(number)) + AT_A_POINT * out)
    ahead = unit(np.gradient(places, axis=1).reshape(-1, 3))
    columns = across, short.FINE * _along(places), OUTER * thick, np.minimum(dense, FULL)
    rows = np.stack([np.broadcast_to(each, shape[:2]) for each in columns], axis=-1)
    across, along, thick, dense = np.split(rows.reshape(-1, 4), 4, axis=1)
    way = thick * (normals + SLIDE * ahead)
    return Part(
        name=name,
        vertices=(points - (1.0 - short.MEAN) * thick * normals).astype(np.float32),
        normals=normals.astype(np.float32),
        faces=grid_faces(number),
        colours=np.broadcast_to(colour, shape).reshape(-1, 3).astype(np.float32),
        bone="cranium",
        shine=short.SLEEK,
        striation=np.hstack([across, along, way, dense]).astype(np.float32),
    )


def _along(places: FloatArray) -> FloatArray:
    """How far along strands their places lie [mm], (n, m, 3) -> (n, m)."""
    steps = np.linalg.norm(np.diff(places, axis=1, prepend=places[:, :1]), axis=2)
    return np.asarray(steps.cumsum(axis=1))
