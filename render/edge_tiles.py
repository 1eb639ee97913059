"""Tiles of a picture that contain edges, and the triangles that touch these tiles.

Software OpenGL takes nearly as long for a small triangle without light as for one with light. So
only the skin's triangles that samples beside edges can see are drawn again.
"""

import numpy as np
import numpy.typing as npt

from ..geometry.arrays import Flags, Floats32, Integers32, Unsigned8
from .camera import PlacedView
from .render_target import Rectangle

TILE = 8  # [pixels] each way: a number of 64 bits holds eight of 8 bits
INNER_NUMBER = 254  # of the back of skin

_Span = tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]


class EdgeTiles:
    """The tiles with edges in an area of a target.

    numbers: those of the surfaces that pixels beside edges show.
    """

    def __init__(self, marks: Unsigned8, area: Rectangle) -> None:
        """marks: for each pixel of the area, 0 without an edge, else the number of the surface."""
        left, bottom, width, height = area
        aside = left % TILE
        below = bottom % TILE
        self._corner = left - aside, bottom - below
        self.numbers = frozenset(np.flatnonzero(np.bincount(marks[marks > 0])).tolist())
        rows = -(-(below + height) // TILE)
        columns = -(-(aside + width) // TILE)
        whole = np.zeros((rows * TILE, columns * TILE), np.uint8)
        whole[below : below + height, aside : aside + width] = marks
        self._sums = _sums(whole)
        self._inner_sums = None
        if INNER_NUMBER in self.numbers:
            self._inner_sums = _sums((whole == INNER_NUMBER).view(np.uint8))

    def touched(
        self,
        view: PlacedView,
        vertices: npt.NDArray[np.floating],
        triangles: npt.NDArray[np.integer],
    ) -> Flags:
        """Flags of triangles (M, 3) of world vertices (V, 3) that may touch such a tile, (M,).

        Triangles that face away from the eye count only if a pixel beside an edge shows the inner
        side.
        """
        matrix = view.world_to_clip.astype(np.float32)
        left, bottom, width, height = view.viewport
        with np.errstate(all="ignore"):  # a corner may be infinite
            clip = vertices.astype(np.float32, copy=False) @ matrix[:3] + matrix[3]
            inverse = np.where(clip[:, 3] > 0.0, 1.0 / clip[:, 3], np.float32(np.nan))
            x = left - self._corner[0] + 0.5 * width * (clip[:, 0] * inverse + 1.0)
            y = bottom - self._corner[1] + 0.5 * height * (clip[:, 1] * inverse + 1.0)
            corners = triangles.T.astype(np.intp)
            x = x[corners]
            y = y[corners]
            turn = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0])
            columns = _span(x, self._sums.shape[1] - 1)
            rows = _span(y, self._sums.shape[0] - 1)
        least_turn = 0.5  # [pixels^2] of area beyond rounding
        is_touched = np.isnan(turn) | ((turn > -least_turn) & _has_any(self._sums, columns, rows))
        if self._inner_sums is not None:
            is_touched |= (turn < least_turn) & _has_any(self._inner_sums, columns, rows)
        return np.asarray(is_touched)


def _sums(pixels: Unsigned8) -> Integers32:
    """Numbers of tiles with pixels above 0 below and at the left: a summed-area table.

    Source: Crow 1984, "Summed-area tables for texture mapping".
    """
    rows_of_tiles = pixels.view(np.uint64).reshape(len(pixels) // TILE, TILE, -1)
    is_any = np.bitwise_or.reduce(rows_of_tiles, 1) > 0
    return np.pad(is_any.cumsum(0, np.int32).cumsum(1, np.int32), ((1, 0), (1, 0)))


def _has_any(sums: Integers32, columns: _Span, rows: _Span) -> Flags:
    """Whether any tile counts within the columns and rows of each triangle."""
    (left, right), (bottom, top) = columns, rows
    above = sums[top, right] - sums[top, left]
    below = sums[bottom, right] - sums[bottom, left]
    return np.asarray(above > below)


def _span(corners: Floats32, count: int) -> _Span:
    """First tile along an axis that triangles (3, M) may touch, and the tile after the last."""
    low = corners.min(axis=0) - 1.0  # a pixel to spare
    high = corners.max(axis=0) + 1.0
    first = np.clip(np.nan_to_num(low / TILE), 0, count).astype(np.intp)
    last = np.clip(np.nan_to_num(high / TILE) + 1.0, 0, count).astype(np.intp)
    return first, last
