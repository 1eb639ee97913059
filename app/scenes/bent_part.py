"""Parts that change their shape."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import NamedTuple, TypeAlias

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
    """A part that changes its shape; it has the attributes of `Part`, and is drawn like one.

    rest: the part at rest. vertices, normals, colours: its current arrays, as of `Part`.
    """

    def __init__(self, rest: Part) -> None:
        self.rest = rest
        self.name = rest.name
        self.faces = rest.faces
        self.bone = rest.bone
        self.shine = rest.shine
        self.roots = rest.roots
        self.strand_radius = rest.strand_radius
        self.striation = rest.striation
        self.is_enclosed = rest.is_enclosed
        self.vertices = rest.vertices
        self.normals = rest.normals
        self.colours = rest.colours

    def take_shape(self, vertices: Floats64) -> None:
        """Set the vertices, shape (n, 3), and compute their normals."""
        self.vertices = read_only(vertices.astype(np.float32))
        self.normals = read_only(vertex_normals(vertices, self.faces).astype(np.float32))

    def copy_shape(self, part: HeadPart) -> None:
        """Take the current arrays of a part with the same number of vertices."""
        self.vertices = part.vertices
        self.normals = part.normals
        self.colours = part.colours


HeadPart: TypeAlias = Part | BentPart
"""A part of a head: a rigid one, or one that changes its shape."""


class FacePart(BentPart, ABC):
    """A part that changes its shape with the face."""

    @abstractmethod
    def follow(self, now: FaceNow) -> None:
        """Change the shape to fit the current face, relative to the part's bone."""


def at_rest(part: HeadPart) -> Part:
    """Return the part at rest; a rigid part is always at rest."""
    return part.rest if isinstance(part, BentPart) else part
