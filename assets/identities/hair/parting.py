"""Where the scalp is bare: a line along the parting, on which the skin's picture shows no hair."""

from __future__ import annotations

import numpy as np

from ...model import IndexArray, SingleArray
from ...smooth import Points
from ...topology import places_in_triangle
from .combing import ON_TOP, PARTED_TO, near_parting
from .cuts import Cut

SAMPLES = 90  # places along an edge of a triangle: those on the scalp are 60 texels long
WIDTH = 2.0  # [mm] beside the parting, where all hair is there again
SHORTER = 6.0  # [mm] than the rows of roots


def bared(
    cut: Cut | None, vertices: Points, faces: IndexArray, places: Points, shape: tuple[int, int]
) -> SingleArray:
    """How bare each texel of the skin's picture is, 0 to 1, (H, W) = shape.

    vertices, faces: of the skin. places: texture coordinates of corners, (F, 3, 2).
    """
    bare = np.zeros(shape, np.float32)
    if cut is None:
        return bare
    corners = vertices[faces]
    aside, (_, height, ahead) = corners[..., 0] - cut.parting, np.moveaxis(corners, 2, 0)
    is_near = (aside.min(axis=1) < WIDTH) & (aside.max(axis=1) > -WIDTH)
    is_near &= (height.min(axis=1) > ON_TOP - 20.0) & (ahead.max(axis=1) > PARTED_TO)
    weights = places_in_triangle(SAMPLES)
    points = np.einsum("kc,fcx->fkx", weights, corners[is_near]).reshape(-1, 3)
    u, v = np.einsum("kc,fcx->xfk", weights, places[is_near]).reshape(2, -1)
    row, column = ((1.0 - v) * shape[0]).astype(int), (u * shape[1]).astype(int)
    np.maximum.at(bare, (row, column), near_parting(cut, points - [0.0, 0.0, SHORTER], WIDTH))
    return bare
