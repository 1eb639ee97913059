"""Lay loose hair over collars, so that strands end outside of cloth and do not enter it.

Around the neck, cloth and hair are kept in maps over angle and height.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy

from ...geometry.arrays import Floats32, Floats64
from ..model import Part
from .hair import HAIR_NAME
from .shirts import NECK_AXIS

COLUMN_COUNT = 72  # columns of a map; each covers 5 degrees
ROW_HEIGHT = 4.0  # [mm] of a map's row


def over_collar(hair: Sequence[Part], shirt: Part) -> list[Part]:
    """Push loose hair that hangs into a shirt's collar outward, and strands above less and less.

    hair: the parts of a person's hair. shirt: with its collar.
    """
    layers = next(each for each in hair if each.name == HAIR_NAME)
    bottom = float(layers.vertices[:, 1].min())
    rising_height = 70.0  # [mm] above the collar, over which the push decays
    cloth = _map_of(shirt, bottom, rising_height)
    turning, near = 6, 2  # columns by which heads turn, and rows within which cloth counts
    size = 2 * turning + 1, 2 * near + 1
    farthest = scipy.ndimage.maximum_filter(cloth, size, mode=("wrap", "nearest"))
    clearance, most = 6.5, 18.0  # [mm] between cloth and hair; greatest push: shoulders are wide
    own = _map_of(layers, bottom, rising_height)
    lacking = np.where(own > 0.0, farthest + clearance - own, 0.0)
    push = np.clip(lacking * (farthest > 0.0), 0.0, most)
    if not push.any():
        return list(hair)
    share = np.linspace(1.0, 0.0, int(rising_height / ROW_HEIGHT)) ** 2
    rising = np.zeros_like(push)
    for row, kept in enumerate(share):
        rising[:, row:] = np.maximum(rising[:, row:], kept * push[:, : push.shape[1] - row])
    smooth = scipy.ndimage.gaussian_filter(rising, (2.0, 1.0), mode=("wrap", "nearest"))
    return [_pushed(each, smooth, bottom) for each in hair]


def _map_of(part: Part, bottom: float, height: float) -> Floats64:
    """Return the greatest distances of a part from the neck's axis [mm], 0 where it is not.

    bottom: height of the lowest row [mm]. height: of the map [mm]. The map is (COLUMN_COUNT, rows).
    """
    places, far = _places(part.vertices, bottom)
    found = np.zeros((COLUMN_COUNT, int(2.0 * height / ROW_HEIGHT)))
    column, row = places.astype(np.int64)
    is_within = (places[1] >= 0.0) & (row < found.shape[1])
    np.maximum.at(found, (column[is_within] % COLUMN_COUNT, row[is_within]), far[is_within])
    return found


def _places(points: Floats32, bottom: float) -> tuple[Floats64, Floats64]:
    """Return columns and rows of points in a map, (2, n), and distances from the axis, (n,)."""
    x, y, z = (points - NECK_AXIS).T
    column = (np.arctan2(x, z) / (2.0 * np.pi) + 0.5) * COLUMN_COUNT
    return np.stack([column, (y - bottom) / ROW_HEIGHT]), np.hypot(x, z)


def _pushed(part: Part, push: Floats64, bottom: float) -> Part:
    """Push a part outward by a map of distances [mm]; bottom: height of its lowest row [mm]."""
    (column, row), far = _places(part.vertices, bottom)
    is_low = row < push.shape[1]
    at = np.stack([column[is_low] - 0.5, np.maximum(row[is_low] - 0.5, 0.0)])
    moved = scipy.ndimage.map_coordinates(push, at, order=1, mode="grid-wrap")
    out = (part.vertices[is_low] - NECK_AXIS) * [1.0, 0.0, 1.0] / far[is_low, None]
    vertices = part.vertices.copy()
    vertices[is_low] += (moved[:, None] * out).astype(np.float32)
    return replace(part, vertices=vertices)
