"""Which faces of locks are never seen: what lies under the outermost locks is left out.

Software OpenGL shades all that lies behind one place, and locks lie six deep on a head. Hair is
rigid, so it is known beforehand what covers what. Places are looked at straight from outside, in
cells of angle and height.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy

from ...around import direction_coordinates
from ...topology import places_in_triangle
from .cuts import Cut
from .locks import SECTION

CELL = 1.5, 2.0  # size of a cell: angle [deg], height [mm]
SAMPLES = 5  # places along an edge of a face
CLOSE = 0.6  # [mm] below what is uppermost, as which a place still counts as uncovered
LEAST = 0.12  # of a face's places, that have to be uncovered
CLOSE_BESIDE = 3.0  # the same beside the face:
BESIDE, BELOW = 12.0, 60.0  # so far from its edges [deg], below this height [mm]


def is_seen(cut: Cut, locks: Mapping[str, Any], lining: Mapping[str, Any]) -> npt.NDArray[np.bool_]:
    """Which faces of locks are not covered by others, or the lining; arrays of two `Part`."""
    first = len(locks["vertices"])
    vertices = np.vstack([locks["vertices"], lining["vertices"]]).astype(np.float64)
    faces = np.vstack([locks["faces"], lining["faces"] + first])
    points = np.einsum("kc,fcx->fkx", places_in_triangle(SAMPLES), vertices[faces])
    angle, height, radius = direction_coordinates(points.reshape(-1, 3))
    column, row = (
        np.floor(place / size).astype(np.intp)
        for place, size in zip((np.degrees(angle), height), CELL, strict=True)
    )
    column, row = column - column.min(), row - row.min()
    cell = row * (column.max() + 1) + column
    uppermost = np.zeros(cell.max() + 1)
    np.maximum.at(uppermost, cell, radius)
    # Beside the face one looks in under the uppermost.
    is_beside = np.degrees(np.abs(angle)) < cut.opening[0] + BESIDE
    close = np.where(is_beside & (height < BELOW) & cut.hangs, CLOSE_BESIDE, CLOSE)
    is_open = (radius > uppermost[cell] - close).reshape(len(faces), -1)
    kept = is_open.mean(axis=1)[: len(locks["faces"])] > LEAST
    # All of a lock between two of its rows, or nothing: else it has jagged edges. And the pieces
    # before and after, so that it ends under others.
    piece = locks["faces"].min(axis=1) // len(SECTION)
    is_piece_seen = np.bincount(piece, kept, minlength=first // len(SECTION)) > 0
    return np.asarray(scipy.ndimage.binary_dilation(is_piece_seen)[piece])
