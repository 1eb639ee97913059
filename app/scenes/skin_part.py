"""Parts that move with the skin: lashes, and the tears along the lids.

Vertices of a part grow from roots. A root keeps its place over the nearest triangle at rest, and
its vertices turn with the skin there (refine.Embedding).
"""

from __future__ import annotations

import numpy as np

from risorius.assets.fitting.warp import nearest_on
from risorius.assets.model import Part
from risorius.geometry.arrays import Floats64, Integers32
from risorius.geometry.directions import unit_vectors
from risorius.geometry.normals import cross_products
from risorius.geometry.read_only import read_only

from .bent_part import FaceNow, FacePart


class SkinPart(FacePart):
    """A part that follows the skin."""

    def __init__(self, part: Part, skin: Floats64, faces: Integers32) -> None:
        """Bind a part with `roots` to the skin at rest, (V, 3), with triangles (F, 3)."""
        from risorius.refine import Binding, Embedding  # lists of controls do not need it

        super().__init__(part)
        assert part.roots is not None
        rest = part.vertices.astype(np.float64)
        normals = part.normals.astype(np.float64)
        roots, root_of = np.unique(part.roots, return_inverse=True)  # number of each vertex's root
        # Some files have triangles without an area, which cannot carry roots.
        least_area = 1e-6  # doubled area [mm2]
        faces = faces[np.linalg.norm(cross_products(skin, faces), axis=1) > least_area]
        # Upright parts point out of the skin; flat parts have the skin's normal.
        ahead = np.zeros((len(roots), 3))
        np.add.at(ahead, root_of, rest - rest[roots][root_of] + 1e-3 * normals)
        feet = nearest_on(rest[roots], unit_vectors(ahead), skin, faces)
        # Only the triangles near roots are needed, also for normals.
        is_around = np.isin(faces, feet.corners).any(axis=1)
        self._near, around = np.unique(faces[is_around], return_inverse=True)  # vertices of skin
        number = np.cumsum(is_around) - 1  # numbers of triangles, among those around
        self._embedding = Embedding(
            around.reshape(-1, 3),
            skin[self._near],
            rest,
            binding=Binding(
                normals=normals,
                places=(number[feet.triangles], feet.weights),
                groups=root_of,
            ),
        )

    def follow(self, now: FaceNow) -> None:
        """Follow the current skin."""
        moved = self._embedding.evaluate(now.skin_on(self.bone, self._near))
        assert moved.normals is not None
        self.vertices = read_only(moved.positions.astype(np.float32))
        self.normals = read_only(moved.normals)
