"""Shortening of the skin, measured from rest and deformed positions.

*Shortening* is the relative loss of length since rest along given directions; wrinkles follow it.
Wrinkles keep their places, so the directions are given at rest, d at each vertex, and only the
amount is measured:

    shortening = 1 - |F d|                 F: from rest to now, in the plane of a triangle

With the barycentric coordinates b of d, which add up to 0, |F d|^2 needs only the squared lengths l
of the triangle's edges,

    |F d|^2 = - b0 b1 l01^2 - b1 b2 l12^2 - b2 b0 l20^2

so neither a rigid motion nor a bend counts. The area-weighted mean over the triangles around a
vertex is a sum with constant weights. At rest the shortening is 0 to the last bit.

Not in the paper.
"""

import numpy as np
import numpy.typing as npt

from ..geometry.arrays import Floats32, Floats64, Integers64, Unsigned32
from ..geometry.vectors import difference, dot
from ..jit import njit
from .mesh.validation import checked_mesh, take_positions_like_rest, used_vertices

LEAST_FLATNESS = 1e-6
"""Height over length below which a triangle at rest has no plane to measure strain in."""


class Shortening:
    """Measures the shortening of one mesh along directions given at rest.

    shortening = refine.Shortening(faces, rest_positions, directions)
    amounts = shortening.measure(positions)
    """

    def __init__(
        self, faces: npt.ArrayLike, rest_positions: npt.ArrayLike, directions: npt.ArrayLike
    ) -> None:
        """Bind to the mesh at rest: `faces`, (F, 3), `rest_positions`, (V, 3), `directions`.

        `directions`: k for each vertex, of any length, shape (V, k, 3). Their parts normal to the
        skin are left out; a zero direction has no shortening. Triangles without area and vertices
        without triangles are allowed and have no strain. Raises ValueError for arrays of other
        shapes, indices out of range, and numbers that are not finite.
        """
        rest, triangles = checked_mesh(rest_positions, faces)
        self._is_used = used_vertices(triangles, len(rest))
        self._positions = rest.copy()
        self._points = rest.astype(np.float32)
        wanted = np.asarray(directions, dtype=np.float64)
        if wanted.ndim != 3 or wanted.shape[::2] != (len(rest), 3) or not np.isfinite(wanted).all():
            raise ValueError(
                f"directions must be finite, of shape ({len(rest)}, k, 3), got shape {wanted.shape}"
            )
        asked = (wanted != 0.0).any(axis=(1, 2))[triangles].any(axis=1)
        triangles = triangles[asked]
        self._faces = triangles.astype(np.uint32)
        self._weights = _corner_weights(rest, triangles, wanted)
        self._lost = np.zeros(wanted.shape[:2], dtype=np.float32)
        self._rest = np.zeros((len(triangles), 3))
        _square_lengths(rest, self._faces, self._rest)

    def measure(self, positions: npt.NDArray[np.floating]) -> Floats32:
        """Return the relative loss of length at each vertex and direction, up to 1, (V, k).

        0 means no loss, below 0 a gain. `positions`: shape (V, 3), any float type. The result is
        overwritten by the next call. Raises ValueError for another shape and for positions that are
        not finite.
        """
        take_positions_like_rest(positions, self._is_used, self._positions, self._points)
        _write_shortening(self._positions, self._faces, self._rest, self._weights, self._lost)
        return self._lost


def _corner_weights(rest: Floats64, faces: Integers64, directions: Floats64) -> Floats32:
    """Weights of each triangle's squared edge lengths at its corners, shape (F, 3, k, 3)."""
    a, b, c = (rest[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    area = np.linalg.norm(normal, axis=1)
    sides = np.stack([b - a, c - b, a - c], axis=1)
    longest = np.linalg.norm(sides, axis=2).max(axis=1)
    is_proper = area > LEAST_FLATNESS * longest**2
    squared = np.where(is_proper, area, 1.0) ** 2
    # Gradients of the barycentric coordinates: coordinate i grows away from the edge opposite.
    gradients = np.cross(normal[:, None], np.stack([c - b, a - c, b - a], axis=1))
    gradients /= squared[:, None, None]
    coordinates = np.einsum("tik,tcsk->tcsi", gradients, directions[faces])  # (F, corner, k, i)
    sides = -coordinates * np.roll(coordinates, -1, axis=3)  # of the edges 01, 12, 20
    lengths = np.stack(
        [((b - a) ** 2).sum(1), ((c - b) ** 2).sum(1), ((a - c) ** 2).sum(1)], axis=1
    )
    in_plane = np.einsum("tcsi,ti->tcs", sides, lengths)  # |d|^2, without d's normal part
    whole = (directions[faces] ** 2).sum(axis=3)
    is_visible = is_proper[:, None, None] & (in_plane > 0.05 * whole) & (whole > 0.0)
    weight = np.where(is_visible, area[:, None, None], 0.0)
    totals = np.zeros(directions.shape[:2])
    for k in range(3):
        np.add.at(totals, faces[:, k], weight[:, k])
    factors = weight / np.maximum(totals[faces], 1e-300) / np.where(is_visible, in_plane, 1.0)
    return np.ascontiguousarray(factors[..., None] * sides, dtype=np.float32)


@njit
def _square_lengths(positions: Floats64, faces: Unsigned32, squares: Floats64) -> None:
    """Write the squared lengths of the edges 01, 12, 20 of each triangle, shape (F, 3)."""
    for t in range(faces.shape[0]):
        for i in range(3):
            edge = difference(positions, faces[t, i], faces[t, (i + 1) % 3])
            squares[t, i] = dot(edge, edge)


@njit
def _write_shortening(
    positions: Floats64, faces: Unsigned32, rest: Floats64, weights: Floats32, lost: Floats32
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
