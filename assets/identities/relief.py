"""Add relief to a part of a map: heights of a person's skin above the built-in head's skin."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ...geometry.arrays import Flags, Floats32, Floats64
from ...geometry.texels import Texels
from ..data_files import Image
from ..loading import load
from ..model import FineShape


class Relief(NamedTuple):
    """Heights and light of a person's skin in a rectangle of a map.

    rows, columns: the rectangle.
    heights: added to the skin [mm], (h, w).
    light: fraction of ambient light that reaches the skin, 0 to 1, (h, w).
    """

    rows: slice
    columns: slice
    heights: Floats64
    light: Floats64


def texels_of(is_chosen: Flags, size: int) -> Texels:
    """Find the texels of flagged triangles of the built-in head, (F,), in a (size, size) map."""
    head = load("head")
    corners = head.uv[head.face_uv].astype(np.float64)
    corners[~is_chosen] = -1.0  # outside the map
    return Texels.within(corners, (size, size))


def relief_of(texels: Texels, heights: Floats64, light: Floats64) -> Relief:
    """Make a relief of n texels; heights [mm] and light (0 to 1) of each texel, (n,)."""
    top = texels.rows.min()
    left = texels.columns.min()
    rows = slice(int(top), int(texels.rows.max()) + 1)
    columns = slice(int(left), int(texels.columns.max()) + 1)
    shape = rows.stop - rows.start, columns.stop - columns.start
    found = Relief(rows, columns, np.zeros(shape), np.ones(shape))
    at = texels.rows - top, texels.columns - left
    found.heights[at] = heights
    found.light[at] = light
    return found


def add_to(part: Image, more: Floats32) -> None:
    """Add values to the bytes of a map in place, clipped to 0 to 255; both have the same shape."""
    changed = part + more
    np.rint(changed, out=changed)
    part[...] = np.clip(changed, 0.0, 255.0, out=changed)


def with_reliefs(known: FineShape, reliefs: Sequence[Relief]) -> FineShape:
    """Add reliefs, made for maps of the same size, to a fine shape."""
    slopes = known.slopes.copy()
    height, width = slopes.shape[:2]
    for relief in reliefs:
        down, across = np.gradient(relief.heights.astype(np.float32))
        steep = np.float32(127.0 / known.steepest)
        added = np.stack([across * (steep * width), down * (-steep * height)], axis=2)
        add_to(slopes[relief.rows, relief.columns], added)
    slopes.flags.writeable = False
    return FineShape(slopes, known.steepest)
