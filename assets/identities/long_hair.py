"""Hair that falls beside the face: strands run over the head from a parting, then hang down.

It is drawn as short hair is (hair.py): one surface of strands side by side, in layers from the
inside out, and a second one that is seen from within.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import scipy

from risorius.geometry.normals import vertex_normals

from ..model import FloatArray, Part
from ..smooth import unit
from ..topology import grid_faces
from .hair import HAIR, LOOSE_LENGTH, MEAN, Fall, Scalp, loose_hairs

Strands = tuple[FloatArray, FloatArray, FloatArray]  # inner and outer side, place around the head
STRANDS, SAMPLES = 26, 14  # of one side, and over the head along each, and as many below
ABOVE_EARS, BEHIND_EARS = 29.0, 8.0  # [mm] that the middle of the head lies so
WIDEST = np.radians(-6.0)  # how far below it strands leave the head
EDGE, TUCKED = np.radians(62.0), np.radians(113.0)  # from the face's middle, where hair begins
LIFTED = np.radians(11.0)  # by how much higher strands leave the head that go behind the ear
BOWED = 0.7  # how far those go around the temple
ROUNDED = np.radians(50.0)  # beside that edge, as far as hair is thinner
SHARP, HIGHEST = 120.0, 24.0  # of the mean over directions that tells how far the skin is
CLEAR = 5.0  # [mm] of the inner side, off the skin
SLIDE = 1.3  # of layers along strands, beside their distance
OUTER = 0.4  # of the volume, that layers fill
FINE = 0.22  # of the way along strands, in which they change less than short ones
HEM, RAGGED = 28.0, 6.0  # [mm] over which tips thin out, and by which they are uneven
PARTED, FRONT = 2.0, 11.0  # [mm] over which hair gets dense from the parting, from the face
FULL = 2.0  # density where no layer is thin
VOLUME = 9.0  # [mm] that it stands off the head
LOW, RISES = 0.1, 0.35  # of all that at the roots, and of the way over the head until it is whole
LIMP = 1.3  # steps along strands, over which they bend from the head
THIN_ENDS, CURVED_IN = 0.7, 0.27  # of the volume and of the radius, that tips have less
WAVE, SWING, LOCK = 46.0, 0.02, 0.31  # [mm] one wave; [1/mm] its turn aside; its change around
SLEEK, SHADED = 0.4, 0.6  # how much it shines; how light it is inside, where lamps do not get
AT_A_POINT = 0.01  # share of the way out in normals: where strands meet there is no triangle


def falling_hair(
    cut: Fall, scalp: Scalp, head: Any, colour: FloatArray, length: float
) -> tuple[Part, ...]:
    """The parts that are drawn as hair, the inner side first.

    head: with vertices and anatomy. colour: sRGB, shape (3,); length: beside that of the cut.
    """
    vertices, at = head.vertices, head.anatomy
    ear = 0.5 * (vertices[at["tragion_left"]] + vertices[at["tragion_right"]])
    middle = np.array([0.0, ear[1] + ABOVE_EARS, ear[2] - BEHIND_EARS])
    solid = np.vstack([scalp.points, vertices[vertices[:, 1] > ear[1] - 53.0]]) - middle
    far = np.linalg.norm(solid, axis=1)

    def skin(ways: FloatArray) -> FloatArray:
        """How far the skin is from the middle [mm] in directions, (..., 3)."""
        weights = np.exp(SHARP * (ways @ (solid / far[:, None]).T - 1.0))
        mean = (weights * far**HIGHEST).sum(axis=-1) / weights.sum(axis=-1)
        return np.asarray(mean ** (1.0 / HIGHEST))

    end = ear[1] - cut.below * length
    sides = [(side, _strands(cut, side, head, middle, skin, end)) for side in (-1.0, 1.0)]
    inside, hair = (
        [_surface(strands, side, colour, is_inside=is_inside) for side, strands in sides]
        for is_inside in (True, False)
    )
    return (*inside, loose_hairs(hair, LOOSE_LENGTH), *hair)


def _strands(
    cut: Fall,
    side: float,
    head: Any,
    middle: FloatArray,
    skin: Callable[[FloatArray], FloatArray],
    end: float,
) -> Strands:
    """Strands of a side, 1 the subject's left, that end about a height: from root to tip their
    inner and outer side, and how far around the head they hang [mm].
    """
    share = np.linspace(0.0, 1.0, STRANDS)
    crown = head.vertices[head.anatomy["vertex"]] + [0.4 * cut.parting, 0.0, -30.0] - middle
    front = head.vertices[head.anatomy["trichion"]] + [cut.parting, 0.0, -4.0] - middle
    is_tucked = side == cut.tucked
    edge = TUCKED if is_tucked else EDGE
    angle = edge + (np.pi - edge) * share**1.3
    roots = unit(front + (share**0.8)[:, None] * (crown - front))
    lowest = WIDEST + is_tucked * LIFTED * (1.0 - share) ** 2
    leave = np.cos(lowest)[:, None] * _level(side, angle)
    leave[:, 1] = np.sin(lowest)
    over, drop = np.linspace(0.0, 1.0, SAMPLES), np.linspace(0.0, 1.0, SAMPLES)[1:]
    pairs = zip(roots, leave, strict=True)
    ways = np.array([scipy.spatial.geometric_slerp(*pair, over) for pair in pairs])
    bow = BOWED * is_tucked * np.outer((1.0 - share) ** 2, np.sin(np.pi * over))
    ways = ways + bow[..., None] * [0.6 * side, -0.2, 1.0]
    ways /= np.linalg.norm(ways, axis=-1, keepdims=True)
    across = side * 88.0 * angle
    uneven = 0.6 * np.sin(0.9 * across) + 0.4 * np.sin(0.37 * across + 1.0)
    # Beside the face the outer side comes round to the inner one.
    beside = np.clip((angle - edge) / ROUNDED, 0.0005, 1.0)
    ends = end + cut.slant * np.cos(angle) + cut.layered * (1.0 - beside) ** 3 + RAGGED * uneven
    risen = LOW + (1.0 - LOW) * np.sin(0.5 * np.pi * np.clip(over / RISES, 0.0, 1.0))
    thick = VOLUME * risen * np.sin(0.5 * np.pi * beside)[:, None]
    grids = []
    for off in (np.zeros_like(thick), thick):
        grid = middle + (skin(ways) + CLEAR + off)[..., None] * ways
        start = grid[:, -1]
        wide = np.linalg.norm((start - middle)[:, [0, 2]], axis=1)
        wide = wide[:, None] * (1.0 - CURVED_IN * drop**1.6) - THIN_ENDS * drop**2 * off[:, -1:]
        height = start[:, 1:2] + drop * (ends[:, None] - start[:, 1:2])
        phase = 2.0 * np.pi * height / WAVE + 1.7 * np.sin(LOCK * across + 0.5 * side)[:, None]
        wide += cut.wave * np.sqrt(drop) * np.sin(phase)
        turned = angle[:, None] + SWING * cut.wave * drop * np.cos(phase)
        fall = middle + wide[..., None] * _level(side, turned)
        fall[..., 1] = height
        bent = np.concatenate([grid, fall], axis=1)
        grids.append(scipy.ndimage.gaussian_filter1d(bent, LIMP, axis=1, mode="nearest"))
        grids[-1][:, 0] = bent[:, 0]  # roots stay where they are
    return grids[0], grids[1], across


def _level(side: float, angle: FloatArray) -> FloatArray:
    """Unit vectors to a side, by their angle from the face's middle, (...) -> (..., 3)."""
    return np.stack([side * np.sin(angle), np.zeros_like(angle), np.cos(angle)], axis=-1)


def _surface(strands: Strands, side: float, colour: FloatArray, *, is_inside: bool) -> Part:
    """One of the two surfaces of a side."""
    low, high, across = strands
    along = np.cumsum(np.linalg.norm(np.diff(high, axis=1, prepend=high[:, :1]), axis=2), axis=1)
    left = (along[:, -1:] - along) / HEM
    ahead = unit(np.gradient(high, axis=1).reshape(-1, 3)).reshape(high.shape)
    thickness = np.linalg.norm(high - low, axis=-1, keepdims=True)
    way = OUTER * (high - low + SLIDE * thickness * ahead)
    places = high - OUTER * (1.0 - MEAN) * (high - low)
    beside = np.abs(across - across[0])[:, None]
    if is_inside:  # nothing shines through at its front, and hardly anything at its tips
        way, places = -0.1 * (high - low) + 0.2 * thickness * ahead, 0.5 * (low + high)
        dense = 4.0 * (left - 0.4)
    else:
        dense = np.minimum(left, np.minimum(0.6 + along / PARTED, 0.45 + beside / FRONT))
    points = places.reshape(-1, 3)
    faces = grid_faces(np.arange(len(points)).reshape(along.shape))
    if (side > 0.0) != is_inside:
        faces = faces[:, ::-1]
    normals = unit(vertex_normals(points, faces) + AT_A_POINT * unit((high - low).reshape(-1, 3)))
    beside = np.broadcast_to(across[:, None, None], (*along.shape, 1))
    rows = [beside, FINE * along[..., None], way, np.minimum(dense, FULL)[..., None]]
    return Part(
        name=HAIR + "_inside" * is_inside + ("_left" if side > 0.0 else "_right"),
        vertices=points.astype(np.float32),
        normals=normals.astype(np.float32),
        faces=faces,
        colours=np.full(points.shape, colour * (SHADED if is_inside else 1.0), np.float32),
        bone="cranium",
        shine=SLEEK,
        striation=np.concatenate(rows, axis=-1).reshape(-1, 6).astype(np.float32),
    )
