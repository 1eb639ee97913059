r"""Strain: how far the skin is stretched and compressed against rest, for artists.

Not in the paper. Both measures take a mesh at rest once and deformed positions in every frame, and
give each vertex the mean over the triangles around it, weighted by their area at rest:

    Tension      the largest stretch and compression, and which way
    Shortening   compression along directions that are given at rest

*Tension map*: how far the skin is stretched and compressed at each vertex, and which way.

Wrinkle maps, blood flow and dirt are driven by it. The quantities are those of continuum
mechanics. On a triangle the deformation maps rest edges to edges,

    F = [b - a   c - a] [rest edges in the plane of the rest triangle]^-1,  3 x 2

and F F^T, the left Cauchy-Green tensor, says by how much lengths have grown in each direction of
the deformed surface. A vertex takes the mean over its triangles, weighted by area at rest, each
turned into the vertex's tangent plane first by the smallest rotation, so that a bend alone is no
tension. The square roots of the two eigenvalues are the principal stretches, largest >= smallest:

    stretch     = max(largest - 1, 0)       0.2: a fifth longer than at rest
    compression = max(1 - smallest, 0)      0.2: a fifth shorter than at rest

Both may be at work at once, across each other: that is where folds run, along `direction`, which is
the direction of the largest stretch; the strongest compression is at right angles to it.

*Shortening*: how much shorter the skin is than at rest along given directions, which wrinkles
follow. The tension map finds the direction of the strongest compression anew in each frame, and
where there is little of it the direction is anybody's guess. Wrinkles stay where they are; so
here the directions are given at rest, d at each vertex, and only the amount is measured:

    shortening = 1 - |F d|                 F: from rest to now, in the plane of a triangle

Written with the barycentric coordinates b of d, which add up to 0, |F d|^2 needs nothing but the
squared lengths l of the triangle's edges,

    |F d|^2 = - b0 b1 l01^2 - b1 b2 l12^2 - b2 b0 l20^2

so neither a rigid motion nor a bend counts, and the mean over the triangles around a vertex,
weighted by area, is a sum with weights that never change. At rest it is 0 to the last bit.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ..jit import njit
from .mesh.arrays import Doubles, Floats, Unsigned, Wide
from .mesh.normals import vertex_normals
from .mesh.validation import checked_indices, checked_positions, not_finite, round_finite
from .mesh.vectors import (
    HALF,
    ONE,
    TINY,
    ZERO,
    between,
    cross,
    difference,
    dot,
    less,
    plus,
    row_of,
    times,
    write_row,
)

THINNEST = 1e-6
"""Height over length below which a triangle at rest has no plane to measure strain in."""
ROWS, COLUMNS = (0, 0, 0, 1, 1, 2), (0, 1, 2, 1, 2, 2)
"""Of the six different entries of a symmetric tensor: xx xy xz yy yz zz."""
OPPOSITE = np.float32(1e-3)
"""1 + cosine below which two normals are opposite and no rotation between them is smallest."""
ROUND = np.float32(1e-4)
"""Difference of the squared stretches below which no direction is special (chosen: rounding)."""


class StrainMeasure:
    """Deformed positions of one mesh beside its rest positions."""

    def __init__(self, faces: npt.ArrayLike, rest_positions: npt.ArrayLike) -> None:
        """Learn the mesh at rest: `faces`, shape (F, 3), `rest_positions`, shape (V, 3).

        Triangles without area and vertices without triangles are fine and have no strain. Raises
        ValueError for arrays of other shapes, indices out of range, and positions not finite.
        """
        self._positions = checked_positions(rest_positions)
        triangles = checked_indices("faces", faces, len(self._positions), "rest_positions")
        self._faces = triangles.astype(np.uint32)
        self._points = np.zeros(self._positions.shape, dtype=np.float32)

    def _set_positions(self, positions: npt.NDArray[np.floating]) -> None:
        """Copy deformed positions, shape (V, 3); ValueError for another shape or not finite."""
        given = np.asarray(positions)
        if given.shape != self._positions.shape or given.dtype.kind != "f":
            raise ValueError(
                f"positions must be floats of shape {self._positions.shape} like the rest "
                f"positions, got {given.dtype} of shape {given.shape}"
            )
        np.copyto(self._positions, given)
        if round_finite(self._positions, self._points) > 0:
            raise ValueError(not_finite(given))


class TensionMap(NamedTuple):
    """Tension of one frame: views of buffers that the next frame overwrites."""

    stretch: Floats
    """Growth of length where it is largest, 0 = none, shape (V,)."""
    compression: Floats
    """Loss of length where it is largest, 0 = none, up to 1, shape (V,)."""
    direction: Floats
    """Unit vector of the largest stretch, in the deformed surface, its sign without meaning; zero
    where all directions are alike; shape (V, 3)."""


class Tension(StrainMeasure):
    """Measures deformed positions of one mesh against its rest positions.

        tension = refine.Tension(faces, rest_positions)
        stretch, compression, direction = tension.measure(positions)

    The rows of a refined mesh get theirs through `origins()`, like any other attribute.
    """

    def __init__(self, faces: npt.ArrayLike, rest_positions: npt.ArrayLike) -> None:
        """Learn the mesh at rest: `faces`, shape (F, 3), `rest_positions`, shape (V, 3)."""
        super().__init__(faces, rest_positions)
        count = len(self._positions)
        self._inverses, weights = _inverse_edges(self._positions, self._faces)
        totals = np.zeros(count)
        for k in range(3):
            np.add.at(totals, self._faces[:, k], weights)
        self._weights = weights.astype(np.float32)
        self._shares = (1.0 / np.where(totals > 0.0, totals, np.inf)).astype(np.float32)
        self._normals = np.zeros((count, 3), dtype=np.float32)
        self._sums = np.zeros((count, 6), dtype=np.float32)
        self._map = TensionMap(
            np.zeros(count, np.float32), np.zeros(count, np.float32), np.zeros_like(self._normals)
        )

    def measure(self, positions: npt.NDArray[np.floating]) -> TensionMap:
        """Measure deformed `positions`, shape (V, 3), any float type; they are only read.

        Raises ValueError for another shape and for positions that are not finite.
        """
        self._set_positions(positions)
        vertex_normals(self._positions, self._faces, self._normals)
        sum_tensors(
            self._positions, self._faces, self._inverses, self._weights, self._normals, self._sums
        )
        find_principal(self._sums, self._shares, self._normals, self._map)
        return self._map


def _inverse_edges(rest: Doubles, faces: Unsigned) -> tuple[Floats, Doubles]:
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
        u = between(positions, faces[t, 0], faces[t, 1])
        v = between(positions, faces[t, 0], faces[t, 2])
        n = cross(u, v)
        n = times(ONE / np.sqrt(max(dot(n, n), TINY)), n)
        p = times(inverses[t, 0], u)
        q = plus(times(inverses[t, 1], u), times(inverses[t, 2], v))
        for i in range(3):
            m = row_of(normals, faces[t, i])
            # The smallest rotation that takes the normal n to m takes p, at right angles to n,
            # to p - (m p) / (1 + n m) (n + m).
            both, one_plus_cosine = plus(n, m), ONE + n[0] * m[0] + n[1] * m[1] + n[2] * m[2]
            turn = ONE / max(one_plus_cosine, OPPOSITE)
            g, h = less(p, turn * dot(m, p), both), less(q, turn * dot(m, q), both)
            for k in range(6):
                r, c = ROWS[k], COLUMNS[k]
                sums[faces[t, i], k] += weights[t] * (g[r] * g[c] + h[r] * h[c])


@njit
def find_principal(sums: Floats, shares: Floats, normals: Floats, out: TensionMap) -> None:
    """Write the principal stretches of the mean tensor in each vertex's tangent plane."""
    stretch, compression, direction = out
    for v in range(sums.shape[0]):
        share = shares[v]
        x = times(share, (sums[v, 0], sums[v, 1], sums[v, 2]))
        y = times(share, (sums[v, 1], sums[v, 3], sums[v, 4]))
        z = times(share, (sums[v, 2], sums[v, 4], sums[v, 5]))
        n = row_of(normals, v)
        if share == ZERO or dot(n, n) < HALF:
            stretch[v] = compression[v] = ZERO
            direction[v, :] = ZERO
            continue
        # Two axes of the tangent plane without a special case (Duff et al. 2017).
        sign = ONE if n[2] >= ZERO else -ONE
        slope = -ONE / (sign + n[2])
        shear = n[0] * n[1] * slope
        s = ONE + sign * n[0] * n[0] * slope, sign * shear, -sign * n[0]
        t = shear, sign + n[1] * n[1] * slope, -n[1]
        along_s, along_t = (dot(x, s), dot(y, s), dot(z, s)), (dot(x, t), dot(y, t), dot(z, t))
        ss, st, tt = dot(s, along_s), dot(t, along_s), dot(t, along_t)
        middle, half = HALF * (ss + tt), HALF * (ss - tt)
        reach = np.sqrt(half * half + st * st)
        stretch[v] = max(np.sqrt(middle + reach) - ONE, ZERO)
        compression[v] = max(ONE - np.sqrt(max(middle - reach, ZERO)), ZERO)
        # Eigenvector of the larger eigenvalue, from the row that cancels less.
        of_s, of_t = (half + reach, st) if half >= ZERO else (st, reach - half)
        length = np.sqrt(of_s * of_s + of_t * of_t)
        turn = ONE / length if reach > ROUND * middle else ZERO
        write_row(direction, v, plus(times(turn * of_s, s), times(turn * of_t, t)))


class Shortening(StrainMeasure):
    """Measures deformed positions of one mesh along directions that are known at rest.

    shortening = refine.Shortening(faces, rest_positions, directions)
    amounts = shortening.measure(positions)
    """

    def __init__(
        self, faces: npt.ArrayLike, rest_positions: npt.ArrayLike, directions: npt.ArrayLike
    ) -> None:
        """Learn the mesh at rest: `faces`, (F, 3), `rest_positions`, (V, 3), `directions`.

        `directions`: k for each vertex, of any length, shape (V, k, 3); what of one stands on the
        skin is left away, and one that is zero measures nothing. Raises ValueError for arrays that
        do not fit together.
        """
        super().__init__(faces, rest_positions)
        rest, triangles = self._positions, self._faces.astype(np.int64)
        wanted = np.asarray(directions, dtype=np.float64)
        if wanted.ndim != 3 or wanted.shape[::2] != (len(rest), 3) or not np.isfinite(wanted).all():
            raise ValueError(
                f"directions must be finite, of shape ({len(rest)}, k, 3), got shape {wanted.shape}"
            )
        asked = (wanted != 0.0).any(axis=(1, 2))[triangles].any(axis=1)
        triangles = triangles[asked]
        self._faces = triangles.astype(np.uint32)
        self._weights = _weights(rest, triangles, wanted)
        self._lost = np.zeros(wanted.shape[:2], dtype=np.float32)
        self._rest = np.zeros((len(triangles), 3))
        _square_lengths(rest, self._faces, self._rest)

    def measure(self, positions: npt.NDArray[np.floating]) -> Floats:
        """Loss of length of each vertex along its directions, up to 1, shape (V, k).

        0 = none, below 0 what it has gained. `positions`: shape (V, 3), any float type. The result
        is overwritten by the next call.
        Raises ValueError for another shape and for positions that are not finite.
        """
        self._set_positions(positions)
        _shorten(self._positions, self._faces, self._rest, self._weights, self._lost)
        return self._lost


def _weights(rest: Doubles, faces: Wide, directions: Doubles) -> Floats:
    """Of each triangle's squared edge lengths at its corners, shape (F, 3, k, 3)."""
    a, b, c = (rest[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    area = np.linalg.norm(normal, axis=1)
    longest = np.max([np.linalg.norm(each, axis=1) for each in (b - a, c - b, a - c)], axis=0)
    is_proper = area > THINNEST * longest**2
    squared = np.where(is_proper, area, 1.0) ** 2
    # Gradients of the barycentric coordinates: coordinate i grows away from the edge opposite.
    gradients = np.cross(normal[:, None], np.stack([c - b, a - c, b - a], axis=1))
    gradients /= squared[:, None, None]
    shares = np.einsum("tik,tcsk->tcsi", gradients, directions[faces])  # (F, corner, k, i)
    sides = -shares * np.roll(shares, -1, axis=3)  # of the edges 01, 12, 20
    lengths = np.stack(
        [((b - a) ** 2).sum(1), ((c - b) ** 2).sum(1), ((a - c) ** 2).sum(1)], axis=1
    )
    in_plane = np.einsum("tcsi,ti->tcs", sides, lengths)  # |d|^2, without what stands on the skin
    whole = (directions[faces] ** 2).sum(axis=3)
    is_visible = is_proper[:, None, None] & (in_plane > 0.05 * whole) & (whole > 0.0)
    weight = np.where(is_visible, area[:, None, None], 0.0)
    totals = np.zeros(directions.shape[:2])
    for k in range(3):
        np.add.at(totals, faces[:, k], weight[:, k])
    share = weight / np.maximum(totals[faces], 1e-300) / np.where(is_visible, in_plane, 1.0)
    return np.ascontiguousarray(share[..., None] * sides, dtype=np.float32)


@njit
def _square_lengths(positions: Doubles, faces: Unsigned, squares: Doubles) -> None:
    """Write the squared lengths of the edges 01, 12, 20 of each triangle, shape (F, 3)."""
    for t in range(faces.shape[0]):
        for i in range(3):
            edge = difference(positions, faces[t, i], faces[t, (i + 1) % 3])
            squares[t, i] = dot(edge, edge)


@njit
def _shorten(
    positions: Doubles, faces: Unsigned, rest: Doubles, weights: Floats, lost: Floats
) -> None:
    """Write the loss of length along the directions, (V, k)."""
    lost[:] = np.float32(0.0)
    grown = np.empty(3, dtype=np.float32)
    for t in range(faces.shape[0]):
        for i in range(3):
            edge = difference(positions, faces[t, i], faces[t, (i + 1) % 3])
            grown[i] = dot(edge, edge) - rest[t, i]
        for i in range(3):
            v = faces[t, i]
            for k in range(lost.shape[1]):
                lost[v, k] += (
                    weights[t, i, k, 0] * grown[0]
                    + weights[t, i, k, 1] * grown[1]
                    + weights[t, i, k, 2] * grown[2]
                )
    for v in range(lost.shape[0]):
        for k in range(lost.shape[1]):
            left = np.sqrt(max(np.float32(1.0) + lost[v, k], np.float32(0.0)))
            lost[v, k] = np.float32(1.0) - left
