"""Skin and tissue: the springs from each vertex to the bone and to its neighbours, and its mass.

Kähler ties each skin vertex to a bone or muscle point by a spring and adds its mirror image outside
the skin, so that skin slides sideways but neither sinks in nor lifts off. With anchor depth d,
stiffness k and pre-tension p of each spring (a fraction), the force of the pair is

    force = -A [ kt (I - n n^T) + kn n n^T ] (x - r),      kn = 2 k,  kt = 2 k p

to first order. We use this linearised pair instead of the two springs. It needs no square root, and
has no rest-length singularity when skin slides far: a smile moves skin by more than the thickness
of tissue. n turns with the bone.

The skin itself is a membrane. Every edge is a spring with the rest length of the undeformed mesh.
Its stiffness follows from the adjacent triangle areas (Van Gelder), so the membrane does not depend
on the triangulation; beyond a strain it stiffens (biphasic, as skin does). A second, linear term
makes neighbours move alike, because edge springs do not resist shear on a valence-4 grid, and
single vertices would lag behind.

Source: Kähler et al. 2001, section 3.2 (edges are springs, counter springs); Van Gelder 1998; Lee,
Terzopoulos, Waters 1995 for layered tissue and biphasic stiffness. Differs from them: the pair is
linearised; the far end r is the rest position carried by bones; muscles act as springs of their own
(muscles.py). The shear term is our own: compared with scans, this term makes the motion of skin
smooth, and the membrane does not.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..geometry.arrays import Floats64, Unsigned32
from ..geometry.vectors import dot, rotated, row_of, times, toward, write_row
from ..jit import njit
from .polylines import polyline_distance
from .rig import Tissue
from .skull import RigidMotion, moved_rigidly
from .state import State
from .surface import SkinSurface


class TissueSprings(NamedTuple):
    """The anchors of all vertices, and the damping."""

    tangential: Floats64  # (V,) stiffness along the skin
    normal: Floats64  # (V,) stiffness across it
    damping: float  # 1/s
    damping_ratio: float  # of critical

    @classmethod
    def under(cls, surface: SkinSurface, tissue: Tissue, septum: Floats64) -> TissueSprings:
        """Uniform tissue under a whole surface, except the nose.

        septum: points from the base of the nose to its tip (K, 3) [mm]; none without landmarks.
        Skin there lies on cartilage above the bone, and rises little with the lip.
        """
        scale = tissue.stiffness_scale * surface.areas
        firm = np.zeros(surface.vertex_count)
        if len(septum):
            away = polyline_distance(surface.positions, septum)
            half_width = 5.0  # mm of the columella: wings and lip are as free as other skin
            near = np.maximum(0.0, 1.0 - (away / half_width) ** 2)
            firm = tissue.septum * near**2
        return cls(
            (tissue.tangential + firm) * scale,
            (tissue.normal + firm) * scale,
            tissue.damping,
            tissue.damping_ratio,
        )


class EdgeSprings(NamedTuple):
    """All edges of the skin as springs."""

    edges: Unsigned32  # (E, 2); unsigned saves the kernel a test per access
    rows: Unsigned32  # (V + 1,) edges that begin at vertex i have rows[i] up to rows[i + 1]
    rest_length: Floats64  # (E,) mm
    stiffness: Floats64  # (E,) of the membrane
    shear: Floats64  # (E,)
    stiffening: float
    strain_limit: float

    @classmethod
    def along(cls, surface: SkinSurface, tissue: Tissue, knots: Floats64) -> EdgeSprings:
        """Springs along all edges of a surface.

        knots: points (K, 3) [mm] around which skin is firm, the mouth corners. Many muscles are
        joined there (the modiolus), and folds must not turn inside out. The knot resists stretch
        more than turning, or a round mouth would have pointed corners.
        """
        stiffness = tissue.membrane * tissue.stiffness_scale * surface.edge_stiffness
        middle = surface.positions[surface.edges].mean(axis=1)
        shear = tissue.shear * stiffness
        modiolus = 5.0  # mm: its radius (anatomy: a knot of some 10 mm across)
        for knot in knots:
            near = np.exp(-((middle - knot) ** 2).sum(axis=1) / modiolus**2)
            stiffness = stiffness * (1.0 + tissue.modiolus * near)
            shear = shear * (1.0 + tissue.modiolus_shear * near)
        rows = np.searchsorted(surface.edges[:, 0], np.arange(surface.vertex_count + 1))
        return cls(
            surface.edges.astype(np.uint32), rows.astype(np.uint32), surface.lengths, stiffness,
            shear, tissue.stiffening, tissue.stiffening_strain,
        )  # fmt: skip

    def row_bound(self, vertex_count: int) -> Floats64:
        """Gershgorin bound of each vertex's row of the stiffened stiffness matrix, shape (V,)."""
        most = 2.0 * (self.stiffness * self.stiffening + self.shear)
        bound = np.bincount(self.edges.T.ravel(), np.tile(most, 2), vertex_count)
        return np.asarray(bound, np.float64)


def masses_for_step(areas: Floats64, stiffness: Floats64, step: float) -> Floats64:
    """Return the mass of each vertex's skin, (V,), raised where the step would be unstable.

    stiffness: bound on each row of the stiffness matrix (Gershgorin), shape (V,). An explicit step
    h is stable for h^2 K < 4 m. Small triangles would need a tiny step for the whole mesh, so their
    vertices get a larger mass.
    """
    # Share of the square of the largest stable step; the rest is margin for geometry.
    stable_step_share = 0.5
    needed = stiffness * step**2 / (4.0 * stable_step_share)
    areal_mass = 1.0  # g/cm2: skin and fat of about 1 cm; only ratios to stiffness matter
    return np.maximum(areas * areal_mass, needed)


@njit
def carry(
    state: State, rest: Floats64, normals: Floats64, weight: Floats64, mandible: RigidMotion
) -> None:
    """Move the far ends of the tissue springs with the mandible, each vertex by its weight."""
    carried = state.carried
    carried_normals = state.normals
    for i in range(len(rest)):
        point = row_of(rest, i)
        normal = row_of(normals, i)
        if weight[i] > 0.0:
            point = toward(point, moved_rigidly(mandible, point), weight[i])
            normal = toward(normal, rotated(mandible.rotation, normal), weight[i])
            normal = times(1.0 / np.sqrt(dot(normal, normal)), normal)
        write_row(carried, i, point)
        write_row(carried_normals, i, normal)
