"""A checker for embeddings: it tests whether a fine mesh follows a coarse one as promised.

It is for tests, and for authors of classes like `Embedding`, as `check` is for refiners.
"""

from typing import Protocol

import numpy as np
import numpy.typing as npt

from ...geometry.arrays import Floats64
from ..border.checker import BrokenMeshError
from .embedding import EmbeddedPoints, checked_vectors

CHECK_TOLERANCE = 1e-6
"""Tolerance of points, relative to the size of the fine mesh and the length of its motion."""


class Carrier(Protocol):
    """An `Embedding`, or any object that carries points in the same way."""

    def evaluate(self, positions: Floats64, /) -> EmbeddedPoints:
        """Return the points for the coarse mesh at `positions`, shape (V, 3)."""


def check_embedding(
    embedding: Carrier, rest_positions: npt.ArrayLike, points: npt.ArrayLike
) -> None:
    """Raise BrokenMeshError, which names the relation, unless fine points follow as promised.

    With the coarse mesh at rest, fine points are at their rest positions; a rigid motion of the
    coarse mesh moves them rigidly; both to 1e-6 of the size. `rest_positions`, shape (V, 3), and
    `points`, shape (N, 3): as they were bound. Returns nothing. Raises ValueError for points of
    another shape or not finite.
    """
    rest = np.asarray(rest_positions, dtype=np.float64)
    fine = checked_vectors("points", points, None)
    size = float(np.ptp(fine, axis=0).max()) if len(fine) else 0.0
    finite = rest[np.isfinite(rest).all(axis=1)]
    size = max(size, float(np.ptp(finite, axis=0).max()))
    # A turn by 2.2 radians about a slanted axis, as the rotation of a unit quaternion.
    w, x, y, z = np.array([1.0, 1.0, -1.5, 0.8]) / np.sqrt(4.89)
    turn = np.array(
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
            [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
            [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
        ]
    )
    for relation, rotation, shift in (
        ("at rest points are where they were bound", np.eye(3), 0.0),
        ("a shift carries points along", np.eye(3), size),
        ("a turn carries points along as one piece", turn, 0.0),
    ):
        wanted = fine @ rotation.T + shift
        found = embedding.evaluate(rest @ rotation.T + shift).positions
        off = np.linalg.norm(np.asarray(found, dtype=np.float64) - wanted, axis=1)
        allowed = CHECK_TOLERANCE * max(size, float(np.abs(wanted).max(initial=0.0)))
        bad = np.flatnonzero(~(off <= allowed))
        if len(bad) > 0:
            raise BrokenMeshError(
                f"{relation}, but point {bad[0]} is {off[bad[0]]:.3g} off, more than {allowed:.3g} "
                f"({len(bad)} such points in all)"
            )
