"""A translucent colour over a part of a surface."""

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ..geometry.arrays import Floats32, Floats64, Unsigned32
from .style import Colour


class Shade(NamedTuple):
    """A colour whose opacity varies over a mesh; it only covers the front sides of triangles."""

    vertices: npt.NDArray[Any]
    """Positions, (V, 3)."""
    faces: npt.NDArray[Any]
    """Vertex indices, counter-clockwise from outside, (F, 3)."""
    opacity: npt.NDArray[Any]
    """Opacity of each vertex, 0 to 1, (V,)."""
    colour: Colour
    """sRGB."""
    lift: float = 0.0
    """Distance toward the camera [unit of the scene] at which another surface still is no cover.

    The picture's surface may be a refined mesh, which lies a little beside this one.
    """

    def triangles(self, eye: Floats64) -> tuple[Floats32, Unsigned32]:
        """Return the visible part: position and opacity of vertices, (n, 4); triangles, (m, 3).

        Vertices are lifted along their line of sight, so they keep their places in the picture.
        """
        visible = np.asarray(self.opacity)[self.faces].any(axis=1)
        used, corners = np.unique(np.asarray(self.faces)[visible], return_inverse=True)
        at = np.asarray(self.vertices, np.float64)[used]
        toward_eye = eye - at
        distance = np.linalg.norm(toward_eye, axis=1, keepdims=True)
        rows = np.empty((len(used), 4), np.float32)
        rows[:, :3] = at + self.lift * toward_eye / np.maximum(distance, self.lift)
        rows[:, 3] = np.asarray(self.opacity)[used]
        return rows, corners.reshape(-1, 3).astype(np.uint32)
