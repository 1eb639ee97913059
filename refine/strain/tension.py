r"""Tension map: how far the skin is stretched and compressed at each vertex, and which way.

A by-product for artists: wrinkle maps, blood flow and dirt are driven by it. Not in the paper; the
quantities are those of continuum mechanics. On a triangle the deformation maps rest edges to edges,

    F = [b - a   c - a] [rest edges in the plane of the rest triangle]^-1,  3 x 2

and F F^T, the left Cauchy-Green tensor, says by how much lengths have grown in each direction of
the deformed surface. A vertex takes the mean over its triangles, weighted by area at rest, each
turned into the vertex's tangent plane first by the smallest rotation, so that a bend alone is no
tension. The square roots of the two eigenvalues are the principal stretches, largest >= smallest:

    stretch     = max(largest - 1, 0)       0.2: a fifth longer than at rest
    compression = max(1 - smallest, 0)      0.2: a fifth shorter than at rest

Both may be at work at once, across each other: that is where folds run, along `direction`, which is
the direction of the largest stretch; the strongest compression is at right angles to it.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ...jit import njit
from ..mesh.normals import vertex_normals
from ..mesh.validation import checked_indices, checked_positions, not_finite, round_finite

Floats = npt.NDArray[np.float32]
Doubles = npt.NDArray[np.float64]
Unsigned = npt.NDArray[np.uint32]

ZERO = np.float32(0.0)
HALF = np.float32(0.5)
ONE = np.float32(1.0)
TINY = np.finfo(np.float32).tiny
THINNEST = 1e-6
"""Height over length below which a triangle at rest has no area to measure strain against."""
OPPOSITE = np.float32(1e-3)
"""1 + cosine below which two normals are opposite and no rotation between them is smallest."""
ROUND = np.float32(1e-4)
"""Difference of the squared stretches below which no direction is special (chosen: rounding)."""


class TensionMap(NamedTuple):
    """Tension of one frame: views of buffers that the next frame overwrites."""

    stretch: Floats
    """Growth of length where it is largest, 0 = none, shape (V,)."""
    compression: Floats
    """Loss of length where it is largest, 0 = none, up to 1, shape (V,)."""
    direction: Floats
    """Unit vector of the largest stretch, in the deformed surface, its sign without meaning; zero
    where all directions are alike; shape (V, 3)."""


class Tension:
    """Measures deformed positions of one mesh against its rest positions.

        tension = refine.Tension(faces, rest_positions)
        stretch, compression, direction = tension.measure(positions)

    The rows of a refined mesh get theirs through `origins()`, like any other attribute.
    """

    def __init__(self, faces: npt.ArrayLike, rest_positions: npt.ArrayLike) -> None:
        """Learn the mesh at rest: `faces`, shape (F, 3), `rest_positions`, shape (V, 3).

        Triangles without area and vertices without triangles are fine and have no tension. Raises
        ValueError for arrays of other shapes, indices out of range, and positions not finite.
        """
        rest = checked_positions(rest_positions)
        self._faces = checked_indices("faces", faces, len(rest), "rest_positions").astype(np.uint32)
        self._inverses, weights = _rest_frames(rest, self._faces)
        totals = np.zeros(len(rest))
        for k in range(3):
            np.add.at(totals, self._faces[:, k], weights)
        self._weights = weights.astype(np.float32)
        self._shares = (1.0 / np.where(totals > 0.0, totals, np.inf)).astype(np.float32)
        self._positions = rest
        self._points = np.zeros(rest.shape, dtype=np.float32)
        self._normals = np.zeros((len(rest), 3), dtype=np.float32)
        self._sums = np.zeros((len(rest), 6), dtype=np.float32)
        self._stretch = np.zeros(len(rest), dtype=np.float32)
        self._compression = np.zeros(len(rest), dtype=np.float32)
        self._direction = np.zeros((len(rest), 3), dtype=np.float32)

    def measure(self, positions: npt.NDArray[np.floating]) -> TensionMap:
        """Measure deformed `positions`, shape (V, 3), any float type; they are only read.

        Raises ValueError for another shape.
        """
        positions = np.asarray(positions)
        if positions.shape != self._positions.shape or positions.dtype.kind != "f":
            raise ValueError(
                f"positions must be floats of shape {self._positions.shape} like the rest "
                f"positions, got {positions.dtype} of shape {positions.shape}"
            )
        np.copyto(self._positions, positions)
        if round_finite(self._positions, self._points) > 0:
            raise ValueError(not_finite(positions))
        vertex_normals(self._positions, self._faces, self._normals)
        sum_tensors(
            self._positions, self._faces, self._inverses, self._weights, self._normals, self._sums
        )
        find_principal(
            self._sums,
            self._shares,
            self._normals,
            self._stretch,
            self._compression,
            self._direction,
        )
        return TensionMap(self._stretch, self._compression, self._direction)


def _rest_frames(rest: Doubles, faces: Unsigned) -> tuple[Floats, Doubles]:
    """Inverse of the rest edges of each triangle, upper triangular, shape (F, 3), and its area.

    Zero for triangles without area: they measure nothing.
    """
    a, b, c = (rest[faces[:, k]] for k in range(3))
    first, second = b - a, c - a
    length = np.linalg.norm(first, axis=1)
    area = 0.5 * np.linalg.norm(np.cross(first, second), axis=1)
    longest = np.maximum(length, np.linalg.norm(second, axis=1))
    is_proper = (length > 0.0) & (2.0 * area > THINNEST * longest**2)
    length = np.where(is_proper, length, 1.0)
    height = np.where(is_proper, 2.0 * area / length, 1.0)
    along = np.einsum("fi,fi->f", first, second) / length
    inverses = np.stack([1.0 / length, -along / (length * height), 1.0 / height], axis=1)
    inverses[~is_proper] = 0.0
    return inverses.astype(np.float32), np.where(is_proper, area, 0.0)


@njit
def sum_tensors(
    positions: Doubles,
    faces: Unsigned,
    inverses: Floats,
    weights: Floats,
    normals: Floats,
    sums: Floats,
) -> None:
    """Add up F F^T (xx xy xz yy yz zz) of the triangles at each vertex into `sums`, (V, 6)."""
    sums[:] = ZERO
    for t in range(faces.shape[0]):
        a, b, c = faces[t, 0], faces[t, 1], faces[t, 2]
        ux = np.float32(positions[b, 0] - positions[a, 0])
        uy = np.float32(positions[b, 1] - positions[a, 1])
        uz = np.float32(positions[b, 2] - positions[a, 2])
        vx = np.float32(positions[c, 0] - positions[a, 0])
        vy = np.float32(positions[c, 1] - positions[a, 1])
        vz = np.float32(positions[c, 2] - positions[a, 2])
        nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        scale = ONE / np.sqrt(max(nx * nx + ny * ny + nz * nz, TINY))
        nx, ny, nz = scale * nx, scale * ny, scale * nz
        first, mixed, second = inverses[t, 0], inverses[t, 1], inverses[t, 2]
        px, py, pz = first * ux, first * uy, first * uz
        qx, qy, qz = mixed * ux + second * vx, mixed * uy + second * vy, mixed * uz + second * vz
        for i in range(3):
            v = faces[t, i]
            mx, my, mz = normals[v, 0], normals[v, 1], normals[v, 2]
            # The smallest rotation that takes the normal n to m takes p, at right angles to n,
            # to p - (m p) / (1 + n m) (n + m).
            turn = ONE / max(ONE + nx * mx + ny * my + nz * mz, OPPOSITE)
            turn_p = turn * (mx * px + my * py + mz * pz)
            turn_q = turn * (mx * qx + my * qy + mz * qz)
            sx, sy, sz = nx + mx, ny + my, nz + mz
            gx, gy, gz = px - turn_p * sx, py - turn_p * sy, pz - turn_p * sz
            hx, hy, hz = qx - turn_q * sx, qy - turn_q * sy, qz - turn_q * sz
            sums[v, 0] += weights[t] * (gx * gx + hx * hx)
            sums[v, 1] += weights[t] * (gx * gy + hx * hy)
            sums[v, 2] += weights[t] * (gx * gz + hx * hz)
            sums[v, 3] += weights[t] * (gy * gy + hy * hy)
            sums[v, 4] += weights[t] * (gy * gz + hy * hz)
            sums[v, 5] += weights[t] * (gz * gz + hz * hz)


@njit
def find_principal(
    sums: Floats,
    shares: Floats,
    normals: Floats,
    stretch: Floats,
    compression: Floats,
    direction: Floats,
) -> None:
    """Write the principal stretches of the mean tensor in each vertex's tangent plane."""
    for v in range(sums.shape[0]):
        share = shares[v]
        xx, xy, xz = share * sums[v, 0], share * sums[v, 1], share * sums[v, 2]
        yy, yz, zz = share * sums[v, 3], share * sums[v, 4], share * sums[v, 5]
        nx, ny, nz = normals[v, 0], normals[v, 1], normals[v, 2]
        if share == ZERO or nx * nx + ny * ny + nz * nz < HALF:
            stretch[v] = compression[v] = ZERO
            direction[v, 0] = direction[v, 1] = direction[v, 2] = ZERO
            continue
        # Two axes of the tangent plane without a special case (Duff et al. 2017).
        sign = ONE if nz >= ZERO else -ONE
        slope = -ONE / (sign + nz)
        shear = nx * ny * slope
        sx, sy, sz = ONE + sign * nx * nx * slope, sign * shear, -sign * nx
        tx, ty, tz = shear, sign + ny * ny * slope, -ny
        bx, by, bz = (
            xx * sx + xy * sy + xz * sz,
            xy * sx + yy * sy + yz * sz,
            (xz * sx + yz * sy + zz * sz),
        )
        ss, st = sx * bx + sy * by + sz * bz, tx * bx + ty * by + tz * bz
        tt = (
            tx * (xx * tx + xy * ty + xz * tz)
            + ty * (xy * tx + yy * ty + yz * tz)
            + tz * (xz * tx + yz * ty + zz * tz)
        )
        middle, half = HALF * (ss + tt), HALF * (ss - tt)
        reach = np.sqrt(half * half + st * st)
        stretch[v] = max(np.sqrt(middle + reach) - ONE, ZERO)
        compression[v] = max(ONE - np.sqrt(max(middle - reach, ZERO)), ZERO)
        # Eigenvector of the larger eigenvalue, from the row that cancels less.
        along_s, along_t = (half + reach, st) if half >= ZERO else (st, reach - half)
        length = np.sqrt(along_s * along_s + along_t * along_t)
        turn = ONE / length if reach > ROUND * middle else ZERO
        along_s, along_t = turn * along_s, turn * along_t
        direction[v, 0] = along_s * sx + along_t * tx
        direction[v, 1] = along_s * sy + along_t * ty
        direction[v, 2] = along_s * sz + along_t * tz
