"""The texels of a picture that triangles cover, and their places in the triangles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..jit import njit
from .arrays import Flags, Floats64, Integers32, Integers64


@dataclass(frozen=True)
class Texels:
    """Texels within triangles, row by row; a texel of several triangles belongs to one of them."""

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
        width. A texel belongs to the triangle in which it lies deepest, so triangles hide the
        margins of others. Raises ValueError if triangles cover the picture many times over.
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
        owner = np.full(size, np.int32(-1))
        _find_owners(pixels, boxes, margin, np.full(size, -np.inf), owner)
        rows, columns = np.nonzero(owner >= 0)
        faces = owner[rows, columns].astype(np.int64)
        weights = np.empty((len(rows), 3))
        _write_weights(pixels, rows, columns, faces, weights)
        return cls(rows, columns, faces, weights)

    def only(self, is_kept: Flags) -> Texels:
        """The texels with a flag, (n,)."""
        return Texels(
            self.rows[is_kept], self.columns[is_kept], self.faces[is_kept], self.weights[is_kept]
        )

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
def _find_owners(
    pixels: Floats64, boxes: Integers64, margin: float, depth: Floats64, owner: Integers32
) -> None:
    """Write the triangle in which each texel lies deepest into `owner`, and its depth."""
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
                of_a, of_b, of_c = _weights_at(a, ab, ac, area, x, y)
                if of_a > -slack_a and of_b > -slack_b and of_c > -slack_c:
                    least = min(of_a, of_b, of_c)
                    if least >= depth[y, x]:
                        depth[y, x] = least
                        owner[y, x] = t


@njit
def _write_weights(
    pixels: Floats64, rows: Integers64, columns: Integers64, faces: Integers64, weights: Floats64
) -> None:
    """Write barycentric coordinates of texels, or of points on borders for texels beside them."""
    for n in range(len(rows)):
        a, b, c = pixels[faces[n]]
        ab = b - a
        ac = c - a
        area = ab[0] * ac[1] - ab[1] * ac[0]
        of_a, of_b, of_c = _weights_at(a, ab, ac, area, columns[n], rows[n])
        inside_a = max(of_a, 0.0)
        inside_b = max(of_b, 0.0)
        inside_c = max(of_c, 0.0)
        total = inside_a + inside_b + inside_c
        weights[n, 0] = inside_a / total
        weights[n, 1] = inside_b / total
        weights[n, 2] = inside_c / total


@njit
def _weights_at(
    a: Floats64, ab: Floats64, ac: Floats64, area: float, x: int, y: int
) -> tuple[float, float, float]:
    """Barycentric coordinates of a texel; ab and ac: sides that begin at the corner a."""
    right = x - a[0]
    down = y - a[1]
    of_b = (right * ac[1] - down * ac[0]) / area
    of_c = (ab[0] * down - ab[1] * right) / area
    return 1.0 - of_b - of_c, of_b, of_c
