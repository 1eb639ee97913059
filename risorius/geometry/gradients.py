"""How fast texture coordinates change along a surface that moves."""

import numpy as np
import numpy.typing as npt

from ..jit import njit
from .arrays import Floats32, Floats64, Integers32


class TextureGradients:
    """Gradients of u and v at texture coordinates, means of the triangles around each, by area.

    gradients = TextureGradients(faces, uv, face_uv)
    along_u_and_v = gradients.measure(positions)
    """

    def __init__(self, faces: Integers32, uv: Floats32, face_uv: Integers32) -> None:
        """Learn triangles (F, 3), texture coordinates (U, 2) and those of corners (F, 3)."""
        self._faces = np.ascontiguousarray(faces)
        self._face_uv = np.ascontiguousarray(face_uv)
        self._corners = uv.astype(np.float64)[face_uv]
        self._sums = np.zeros((len(uv), 7))

    def measure(self, positions: Floats64) -> Floats32:
        """Gradient of u, then of v [1/unit of positions], shape (U, 6); 0 at flat triangles.

        positions: of vertices, shape (V, 3).
        """
        self._sums[:] = 0.0
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
    """Add to the sums of each corner its triangle's gradients times twice its area, and this."""
    for t in range(faces.shape[0]):
        a = positions[faces[t, 0]]
        b = positions[faces[t, 1]]
        c = positions[faces[t, 2]]
        normal = np.cross(b - a, c - a)
        area = np.sqrt((normal * normal).sum())
        if area < 1e-12:
            continue
        across_a = np.cross(normal, c - b) / area
        across_b = np.cross(normal, a - c) / area
        across_c = np.cross(normal, b - a) / area
        for k in range(2):
            u = corners[t, :, k]
            along = u[0] * across_a + u[1] * across_b + u[2] * across_c
            for i in range(3):
                sums[face_uv[t, i], 3 * k : 3 * k + 3] += along
        for i in range(3):
            sums[face_uv[t, i], 6] += area
