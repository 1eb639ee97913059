"""Gradients of texture coordinates along a moving surface."""

import numpy as np
import numpy.typing as npt

from ..jit import njit
from .arrays import Floats32, Floats64, Integers32
from .read_only import read_only
from .vectors import cross, difference, dot


class TextureGradients:
    """Gradients of u and v at texture coordinates: area-weighted means over adjacent triangles.

    gradients = TextureGradients(faces, uv, face_uv)
    along_u_and_v = gradients.measure(positions)
    """

    def __init__(self, faces: Integers32, uv: Floats32, face_uv: Integers32) -> None:
        """Bind triangles (F, 3), texture coordinates (U, 2), their indices at corners (F, 3)."""
        self._faces = read_only(np.ascontiguousarray(faces))
        self._face_uv = read_only(np.ascontiguousarray(face_uv))
        self._corners = uv.astype(np.float64)[face_uv]
        self._sums = np.zeros((len(uv), 7))

    def measure(self, positions: Floats64) -> Floats32:
        """Gradient of u, then of v [1/unit of positions], shape (U, 6); 0 at flat triangles.

        positions: positions of the vertices, shape (V, 3).
        """
        self._sums[:] = 0.0
        positions = read_only(positions)
        _add_gradients(positions, self._faces, self._face_uv, self._corners, self._sums)
        area = np.maximum(self._sums[:, 6:], 1e-30)
        gradients: Floats32 = (self._sums[:, :6] / area).astype(np.float32)
        return gradients


@njit
def _add_gradients(
    positions: Floats64,
    faces: Integers32,
    face_uv: Integers32,
    corners: Floats64,
    sums: npt.NDArray[np.float64],
) -> None:
    """Add each triangle's gradients, times twice its area, and this area to its corners' sums.

    Vectors are tuples here: arrays of three numbers would be allocated for each triangle.
    """
    for t in range(faces.shape[0]):
        a = faces[t, 0]
        b = faces[t, 1]
        c = faces[t, 2]
        from_a_to_b = difference(positions, a, b)
        normal = cross(from_a_to_b, difference(positions, a, c))
        area = np.sqrt(dot(normal, normal))
        if area < 1e-12:
            continue
        across_a = cross(normal, difference(positions, b, c))
        across_b = cross(normal, difference(positions, c, a))
        across_c = cross(normal, from_a_to_b)
        for j in range(3):
            by_a = across_a[j] / area
            by_b = across_b[j] / area
            by_c = across_c[j] / area
            for k in range(2):
                along = corners[t, 0, k] * by_a + corners[t, 1, k] * by_b + corners[t, 2, k] * by_c
                for i in range(3):
                    sums[face_uv[t, i], 3 * k + j] += along
        for i in range(3):
            sums[face_uv[t, i], 6] += area
