"""The surface on which hair lies: head and ears, and what hangs from them."""

from __future__ import annotations

import numpy as np
import scipy

from risorius.geometry.normals import vertex_normals

from ...around import TOP, direction_coordinates
from ...model import IndexArray
from ...smooth import Points, Values
from ...topology import places_in_triangle

RISE, FALL = 0.26, 0.16  # how fast hair comes out above ears, and in again below [mm for each mm]
HANGING = 60.0  # [mm] height below which it does
STEPS = 6  # points on an edge of a triangle
BULGE = 0.75  # of what the planes of its corners would make of it, as in the source
ANGLES = np.radians(np.arange(-180.0, 180.0, 3.0))
HEIGHTS = np.arange(-175.0, TOP, 2.5)


class Envelope:
    """How far head and ears reach, over angle and height, and what hangs from them."""

    def __init__(self, vertices: Points, faces: IndexArray, *, over_ears: bool) -> None:
        """over_ears: whether hair hangs from what stands out, else it lies close all over."""
        angle, height, radius = direction_coordinates(_close(vertices, faces))
        row, column = (np.rint(place).astype(int) for place in _places(angle, height))
        reach = np.zeros((len(HEIGHTS), len(ANGLES)))
        np.maximum.at(reach, (row, column % len(ANGLES)), radius)
        for around in reach:  # toward the crown there are fewer points than cells
            known = np.flatnonzero(around)
            if len(known):
                around[:] = np.interp(ANGLES, ANGLES[known], around[known], period=2.0 * np.pi)
        reach = scipy.ndimage.maximum_filter(reach, (5, 3), mode=("nearest", "wrap"))
        # What stands out, an ear, is a slope to hair: it lies on it, and hangs from it.
        step = HEIGHTS[1] - HEIGHTS[0]
        hanging = np.flatnonzero(HEIGHTS < HANGING) if over_ears else np.zeros(0, int)
        for k in hanging[1:]:
            reach[k] = np.maximum(reach[k], reach[k - 1] - step * RISE)
        for k in hanging[::-1]:
            reach[k] = np.maximum(reach[k], reach[k + 1] - step * FALL)
        self._reach = scipy.ndimage.gaussian_filter(reach, (2.5, 2.0), mode=("nearest", "wrap"))

    def radius(self, angle: Values, height: Values) -> Values:
        """From the axis of the head [mm], shape (n,)."""
        row, column = _places(angle, height)
        top, left = np.minimum(row.astype(int), len(HEIGHTS) - 2), np.floor(column).astype(int)
        down, right = row - top, column - left
        left, beside = left % len(ANGLES), (left + 1) % len(ANGLES)
        reach, below = self._reach[top], self._reach[top + 1]
        rows = np.arange(len(row))
        low = (1.0 - right) * reach[rows, left] + right * reach[rows, beside]
        high = (1.0 - right) * below[rows, left] + right * below[rows, beside]
        return np.asarray((1.0 - down) * low + down * high)


def _close(vertices: Points, faces: IndexArray) -> Points:
    """Points all over a surface, some millimetres apart, bulging out between its corners.

    On the scalp, where triangles are large, skin that was refined stands 2 mm above them.
    Source: Boubekeur, Alexa 2008, "Phong tessellation".
    """
    shares = places_in_triangle(STEPS)
    corners, normals = vertices[faces][:, None], vertex_normals(vertices, faces)[faces][:, None]
    flat = np.einsum("kc,fcx->fkx", shares, vertices[faces])[:, :, None]
    above = ((flat - corners) * normals).sum(axis=3, keepdims=True)  # the planes of the corners
    bulge = -(shares[:, :, None] * above * normals).sum(axis=2)
    return np.asarray((flat[:, :, 0] + BULGE * bulge).reshape(-1, 3))


def _places(angle: Values, height: Values) -> tuple[Values, Values]:
    """Row and column in the envelope's grid, not rounded."""
    row = (height - HEIGHTS[0]) / (HEIGHTS[1] - HEIGHTS[0])
    return np.clip(row, 0.0, len(HEIGHTS) - 1.0), (angle - ANGLES[0]) / (ANGLES[1] - ANGLES[0])
