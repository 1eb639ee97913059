"""The texels of a picture that triangles cover, and their places in the triangles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..jit import njit
from .arrays import Floats64, Integers64


@dataclass(frozen=True)
class Texels:
    """Texels within triangles; a texel of several triangles occurs several times."""

    rows: Integers64
    """From the top, shape (n,)."""
    columns: Integers64
    """From the left, shape (n,)."""
    faces: Integers64
    """The triangle, shape (n,)."""
    weights: Floats64
    """Barycentric coordinates in the triangle, shape (n, 3); of a point on its border for texels
    beside it.
    """

    @classmethod
    def within(cls, corners: Floats64, size: tuple[int, int], margin: float = 0.0) -> Texels:
        """Find the texels in triangles, or within a margin [texels] of triangles.

        corners: texture coordinates (F, 3, 2), from the left and from below, 0..1. size: height and
        width. The result is sorted by depth inside the triangle, deepest last, so that texels
        inside triangles are drawn over margins. Raises ValueError if triangles cover the picture
        many times over.
        """
        height, width = size
        pixels = corners * [width, -height] + [-0.5, height - 0.5]
        first = np.ceil(pixels.min(axis=1) - margin)
        last = np.floor(pixels.max(axis=1) + margin)
        low = first.clip(0, [width, height])
        high = last.clip(-1, [width - 1, height - 1])
        boxes = np.concatenate([low, high], axis=1).astype(np.int64)
        sides = np.maximum(boxes[:, 2:] - boxes[:, :2] + 1, 0)
        most_tries = 60_000_000  # a usual layout needs at most two entries for each texel
        if sides.prod(axis=1).sum() > most_tries:
            raise ValueError("texture coordinates cover the picture many times over")
        found = np.empty((0, 3), np.int64)
        weights = np.empty((0, 3))
        count = _walk_texels(pixels, boxes, margin, found, weights)
        found = np.empty((count, 3), np.int64)
        weights = np.empty((count, 3))
        _walk_texels(pixels, boxes, margin, found, weights)
        order = np.argsort(weights.min(axis=1), kind="stable")
        inside = np.maximum(weights[order], 0.0)
        inside /= inside.sum(axis=1, keepdims=True)
        rows, columns, faces = found[order].T
        return cls(rows, columns, faces, inside)

    def interpolate(self, values: npt.NDArray[np.floating]) -> Floats64:
        """Values of corners, (F, 3, ...), at the texels, shape (n, ...)."""
        found: Floats64 = np.einsum("nc,nc...->n...", self.weights, values[self.faces])
        return found


def rates(corners: npt.NDArray[np.floating], values: npt.NDArray[np.floating]) -> Floats64:
    """Rates of `values` (F, 3, k) along u and along v in triangles, shape (F, 2, k).

    corners: their texture coordinates, (F, 3, 2); triangles without area have the rate 0.
    """
    steps = np.diff(corners, axis=1).astype(np.float64)
    changes = np.diff(values, axis=1).astype(np.float64)
    is_flat = np.abs(np.linalg.det(steps)) < 1e-14
    steps[is_flat] = np.eye(2)
    changes[is_flat] = 0.0
    return np.asarray(np.linalg.solve(steps, changes))


@njit
def _walk_texels(
    pixels: Floats64, boxes: Integers64, margin: float, found: Integers64, weights: Floats64
) -> int:
    """Count all entries; write row, column, triangle and weights of the entries that fit."""
    count = 0
    for t in range(pixels.shape[0]):
        a, b, c = pixels[t]
        ab = b - a
        ac = c - a
        bc = c - b
        area = ab[0] * ac[1] - ab[1] * ac[0]
        if abs(area) < 1e-9:
            continue
        # Least weight of a corner, at the outer border of the margin beyond the opposite side.
        slack_a = margin * np.hypot(bc[0], bc[1]) / abs(area) + 1e-9
        slack_b = margin * np.hypot(ac[0], ac[1]) / abs(area) + 1e-9
        slack_c = margin * np.hypot(ab[0], ab[1]) / abs(area) + 1e-9
        for y in range(boxes[t, 1], boxes[t, 3] + 1):
            for x in range(boxes[t, 0], boxes[t, 2] + 1):
                right = x - a[0]
                down = y - a[1]
                of_b = (right * ac[1] - down * ac[0]) / area
                of_c = (ab[0] * down - ab[1] * right) / area
                of_a = 1.0 - of_b - of_c
                if of_a > -slack_a and of_b > -slack_b and of_c > -slack_c:
                    if count < found.shape[0]:
                        found[count, 0] = y
                        found[count, 1] = x
                        found[count, 2] = t
                        weights[count, 0] = of_a
                        weights[count, 1] = of_b
                        weights[count, 2] = of_c
                    count += 1
    return count
