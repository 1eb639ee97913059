"""Additional heights of a person's skin over the built-in head's, in a part of its maps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from risorius.geometry.texels import Texels

from ...geometry.arrays import Floats32, Floats64
from ..data_files import Image
from ..model import FineShape


class Relief(NamedTuple):
    """A part of a map, with a person's heights and light there.

    rows, columns: the part. heights: added to the skin [mm], (h, w). light: share of ambient light
    that arrives, (h, w).
    """

    rows: slice
    columns: slice
    heights: Floats64
    light: Floats64


def relief_of(texels: Texels, heights: Floats64, light: Floats64) -> Relief:
    """The part of a map that holds these texels; heights and light: those of each, shape (n,)."""
    top, left = texels.rows.min(), texels.columns.min()
    rows = slice(int(top), int(texels.rows.max()) + 1)
    columns = slice(int(left), int(texels.columns.max()) + 1)
    shape = rows.stop - rows.start, columns.stop - columns.start
    found = Relief(rows, columns, np.zeros(shape), np.ones(shape))
    at = texels.rows - top, texels.columns - left
    found.heights[at] = heights
    found.light[at] = light
    return found


def add_to(part: Image, more: Floats32) -> None:
    """Add to bytes of a map, which keep their bounds; both of one shape."""
    changed = part + more
    np.rint(changed, out=changed)
    part[...] = np.clip(changed, 0.0, 255.0, out=changed)


def with_reliefs(known: FineShape, reliefs: Sequence[Relief]) -> FineShape:
    """A fine shape with reliefs in maps of its size."""
    slopes = known.slopes.copy()
    height, width = slopes.shape[:2]
    for relief in reliefs:
        down, across = np.gradient(relief.heights.astype(np.float32))
        steep = np.float32(127.0 / known.steepest)
        added = np.stack([across * (steep * width), down * (-steep * height)], axis=2)
        add_to(slopes[relief.rows, relief.columns], added)
    slopes.flags.writeable = False
    return FineShape(slopes, known.steepest)
