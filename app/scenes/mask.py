"""A mask on a face: it follows both jaws, and moves outward where skin pushes against it."""

from __future__ import annotations

import numpy as np
import scipy

from risorius.assets.fitting.mouth_walls import stretched_walls
from risorius.assets.identities.mask import MASK_SHAPE
from risorius.assets.model import Part
from risorius.geometry.arrays import Floats64
from risorius.geometry.directions import unit_vectors
from risorius.geometry.normals import vertex_normals

from .bent_part import FaceNow, FacePart


class Mask(FacePart):
    """A mask in front of the mouth, which is drawn like any other part."""

    def __init__(self, part: Part, skin: Floats64) -> None:
        """Make a mask that lies on a skin at rest, (V, 3)."""
        super().__init__(part)
        assert part.mandible_shares is not None
        self._shares = part.mandible_shares
        self._rest = part.vertices.astype(np.float64)
        count = MASK_SHAPE[0] * MASK_SHAPE[1]
        sheet = self._rest[:count]
        # Smooth normals ignore the pleats.
        normals = vertex_normals(self._rest, part.faces)[:count].reshape(*MASK_SHAPE, 3)
        smooth = scipy.ndimage.gaussian_filter(normals, (4.0, 4.0, 0.0), mode="nearest")
        self._outward = unit_vectors(smooth).reshape(-1, 3)
        self._near = scipy.spatial.cKDTree(skin).query(sheet, k=24)[1]
        self._resting_heights = self._heights(skin, sheet)
        # The inner side and the loops follow the sheet; the loops follow less near the ear.
        distances, self._held_by = scipy.spatial.cKDTree(sheet).query(self._rest)
        reach = 60.0  # [mm]
        self._held = np.clip(1.0 - distances / reach, 0.0, 1.0)[:, None]

    def follow(self, now: FaceNow) -> None:
        """Change the shape to fit the current skin."""
        moved = stretched_walls(self._rest, self._shares, now.mandible())
        clearance = 2.0  # [mm]
        heights = self._heights(now.skin_on("cranium"), moved[: len(self._outward)])
        pushed = np.minimum(heights + clearance, heights - self._resting_heights).max(axis=1)
        least = np.maximum(pushed, 0.0).reshape(MASK_SHAPE)
        push = least
        for _ in range(40):  # the sheet forms a tent over pushed places
            around = np.pad(push, 1, mode="edge")
            beside_rows = around[:-2, 1:-1] + around[2:, 1:-1]
            four = beside_rows + around[1:-1, :-2] + around[1:-1, 2:]
            push = np.maximum(least, 0.25 * four)
        away = push.reshape(-1, 1) * self._outward
        self.take_shape(moved + self._held * away[self._held_by])

    def _heights(self, skin: Floats64, sheet: Floats64) -> Floats64:
        """Return heights of 24 skin vertices above each vertex of the sheet, (n, 24) [mm].

        Beside a vertex, skin is assumed to curve away like a ball.
        """
        apart = skin[self._near] - sheet[:, None]
        outside = (apart * self._outward[:, None]).sum(axis=-1)
        beside = (apart * apart).sum(axis=-1) - outside**2
        diameter = 16.0  # [mm]
        return np.asarray(outside - beside / diameter)
