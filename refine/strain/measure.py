"""What both measures of strain share: a mesh at rest, and deformed positions, checked."""

import numpy as np
import numpy.typing as npt

from ..mesh.validation import checked_indices, checked_positions, not_finite, round_finite

THINNEST = 1e-6
"""Height over length below which a triangle at rest has no plane to measure strain in."""


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
