"""Edge springs: the skin as a membrane.

Every edge is a spring with the rest length of the undeformed mesh. Its stiffness follows from the
adjacent triangle areas (Van Gelder), so the membrane does not depend on the triangulation; beyond
a strain it stiffens (biphasic, as skin does). A second, linear term lets neighbours move alike:
edge springs alone resist no shear on a valence-4 grid and leave single vertices behind.

Source: Kähler et al. 2001 (edges are springs); Van Gelder 1998; Lee, Terzopoulos, Waters 1995
(biphasic stiffness).
Differs from them: the shear term; measured against scans it, not the membrane, gives skin its
smooth field of motion.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from .landmarks import Array
from .rig import Tissue
from .surface import Surface

MODIOLUS = 5.0  # mm: its radius (anatomy: a knot of some 10 mm across)


class EdgeSprings(NamedTuple):
    """All edges of the skin as springs."""

    edges: npt.NDArray[np.uint32]  # (E, 2); unsigned saves the kernel a test per access
    rows: npt.NDArray[np.uint32]  # (V + 1,) edges that begin at vertex i: rows[i] up to rows[i + 1]
    rest_length: Array  # (E,) mm
    stiffness: Array  # (E,) of the membrane
    shear: Array  # (E,)
    stiffening: float
    strain_limit: float

    @classmethod
    def along(cls, surface: Surface, tissue: Tissue, knots: Array) -> EdgeSprings:
        """Springs along all edges of a surface.

        knots: points (K, 3) [mm] around which skin is firm, the mouth corners: there many muscles
        are knotted together (the modiolus), and no fold may turn inside out. The knot resists
        stretch more than turning, or a round mouth has pointed corners.
        """
        stiffness = tissue.membrane * tissue.stiffness_scale * surface.edge_stiffness
        middle = surface.positions[surface.edges].mean(axis=1)
        shear = tissue.shear * stiffness
        for knot in knots:
            near = np.exp(-((middle - knot) ** 2).sum(axis=1) / MODIOLUS**2)
            stiffness = stiffness * (1.0 + tissue.modiolus * near)
            shear = shear * (1.0 + tissue.modiolus_shear * near)
        rows = np.searchsorted(surface.edges[:, 0], np.arange(surface.vertex_count + 1))
        return cls(
            surface.edges.astype(np.uint32), rows.astype(np.uint32), surface.lengths, stiffness,
            shear, tissue.stiffening, tissue.stiffening_strain,
        )  # fmt: skip

    def row_bound(self, vertex_count: int) -> Array:
        """Gershgorin bound of the springs' stiffness per vertex, stiff slope, shape (V,)."""
        most = 2.0 * (self.stiffness * self.stiffening + self.shear)
        bound = np.zeros(vertex_count)
        for end in range(2):
            np.add.at(bound, self.edges[:, end], most)
        return bound

    def energy(self, x: Array, offset: Array) -> float:
        """Energy stored in all edges; `offset` is x minus the bone-carried rest."""
        i, j = self.edges.T
        edge = x[j] - x[i]
        extension = np.linalg.norm(edge, axis=1) - self.rest_length
        beyond = np.maximum(extension - self.strain_limit * self.rest_length, 0.0)
        stored = self.stiffness * (extension**2 + (self.stiffening - 1.0) * beyond**2)
        stored += self.shear * ((offset[j] - offset[i]) ** 2).sum(axis=1)
        return float(stored.sum() / 2.0)
