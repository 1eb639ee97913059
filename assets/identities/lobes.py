"""Round the lobes of persons' ears, whose rims end in a corner of few vertices.

From the front and the side, the rim ran straight down to its last vertex, so lobes were pointed.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ...geometry.arrays import Floats64
from ..loading import load

LAST = 12  # number of a rim's vertex at the lowest point of the lobe


class _Lobe(NamedTuple):
    """The vertices of a lobe.

    rims: rows of vertices along the ear's free edge, the row on the head first. below: the vertex
    of the cheek at which the lobe ends.
    """

    rims: tuple[list[int], ...]
    below: int


def rounded_lobes(vertices: Floats64) -> Floats64:
    """Move the ends of ears' rims toward the middle of their neighbours; vertices [mm], (V, 3).

    The shares are chosen by eye.
    """
    x = vertices.copy()
    shares = {LAST: 0.45, LAST - 1: 0.13}  # vertex of a rim -> how far it is moved
    followed_share = 0.7  # how far the cheek follows the row on the head
    for rims, below in _lobes():
        for rim in rims:
            for k, share in shares.items():
                before, here, after = vertices[rim[k - 1 : k + 2]]
                x[rim[k]] += share * (0.5 * (before + after) - here)
        first = rims[0][LAST]
        x[below] += followed_share * (x[first] - vertices[first])
    return x


@lru_cache(maxsize=1)
def _lobes() -> tuple[_Lobe, ...]:
    """Find both lobes of the built-in head."""
    head = load("head")
    ears = np.concatenate([row for name, row in head.rings.items() if name.startswith("ear_")])
    found = []
    for side in ("left", "right"):
        rims = tuple(head.rings[f"ear_{row}_{side}"].tolist() for row in range(3))
        around = head.faces[(head.faces == rims[0][LAST]).any(axis=1)]
        (below,) = np.setdiff1d(around, ears).tolist()
        found.append(_Lobe(rims, below))
    return tuple(found)
