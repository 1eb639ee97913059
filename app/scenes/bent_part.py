"""Parts that change their shape with the face."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from risorius.assets.model import Part
from risorius.geometry.arrays import Floats64, Integers
from risorius.geometry.normals import vertex_normals
from risorius.geometry.read_only import read_only


class FaceNow(NamedTuple):
    """The current shape of a face, for its parts.

    skin: the vertices [mm], (V, 3). bones: the motion of each bone, name -> a matrix (4, 4). jaw:
    values of the jaw; all 0 at rest. tongue: the vertices of the tongue, (n, 3), in the space of
    the mandible; the same array for the same shape, and None for a face without a tongue.
    """

    skin: Floats64
    bones: Mapping[str, Floats64]
    jaw: tuple[float, ...] = ()
    tongue: Floats64 | None = None

    def mandible(self) -> Floats64:
        """Return the motion of the mandible relative to the cranium, a matrix (4, 4)."""
        return np.linalg.inv(self.bones["cranium"]) @ self.bones["mandible"]

    def skin_on(self, bone: str, numbers: Integers | slice = slice(None)) -> Floats64:
        """Return vertices of the skin, by default all, in the space of a bone [mm]."""
        matrix = self.bones[bone]
        turned_back = np.linalg.inv(matrix[:3, :3])
        there: Floats64 = (self.skin[numbers] - matrix[:3, 3]) @ turned_back.T
        return there


class BentPart:
    """A part that changes its shape; it is drawn like any other part (render/parts.py).

    It has all attributes of `rest`, the part at rest, except those that change.
    """

    def __init__(self, rest: Part) -> None:
        self.rest = rest
        self.vertices = rest.vertices
        self.normals = rest.normals
        self.colours = rest.colours

    def __getattr__(self, name: str) -> Any:
        if name == "rest":  # a copy has no attributes yet
            raise AttributeError(name)
        return getattr(self.rest, name)

    def follow(self, now: FaceNow) -> None:
        """Change the shape to fit the current face, relative to the part's bone."""
        raise NotImplementedError

    def take_shape(self, vertices: Floats64) -> None:
        """Set the vertices, shape (n, 3), and compute their normals."""
        self.vertices = read_only(vertices.astype(np.float32))
        self.normals = read_only(vertex_normals(vertices, self.rest.faces).astype(np.float32))
