"""The criterion `rest`: it splits edges curved at rest, where a mesh is too coarse for its form.

The paper's criterion counts bending since rest, so an outline that is a polygon at rest remains
one. This criterion splits such edges.

    measure = height of the arc x cube root of (length / usual length)

The height of the arc over an edge (Taubin 1995) is k L^2 / 8, with the curvature k the mean of
2 n_a . d / L^2 and, from the other side, -2 n_b . d / L^2.

The root prefers long edges, because corners between long edges are most visible. Where a mesh is
already fine, such as at touching lips, smoothing would only open gaps. (A fixed limit of length
gave ragged rims of ears, where long and short edges meet.)
"""

import numpy as np

from ...geometry.arrays import Floats32, Floats64, Unsigned32
from ...geometry.directions import unit_vectors
from ...geometry.normals import cross_products
from ..kahler.criterion import Levels
from ..mesh.connectivity import Connectivity
from ..mesh.creases import Sectors, sectors_of
from .blending import RAMP_WIDTH
from .measuring import Measuring, Once, Twice

USUAL_LENGTH = 1.0 / 40.0
"""The usual length of an edge, in sizes of the mesh: an edge of this length has the height of its
arc as its measure.
"""


class RestCurvature(Measuring):
    """The criterion `rest`: the height of the arc over an edge at rest, times a root of its length.

    It is measured once. The same edges are split in every frame, from any viewpoint, so no point
    can pop.
    """

    uses_normals = False
    is_constant = True

    def __init__(self, once: Once = 0.00077, twice: Twice = 0.0053, levels: Levels = 2) -> None:
        """`once`, `twice`: measures in sizes of the mesh, so a fine mesh stays unchanged.

        The defaults are chosen by eye on a head of 2030 triangles, 720 pixels high: lower limits do
        not improve its outline. Splits must cover a round region completely: smoothing moves
        vertices at split edges inward, and a vertex without splits would stick out beside them.
        `levels`: the most splits of an edge.
        """
        super().__init__(once, twice, "heights in sizes of the mesh", levels)

    def bind(
        self, connectivity: Connectivity, rest_positions: Floats64, rest_normals: Floats32
    ) -> None:
        """Decide how often each edge is split."""
        super().bind(connectivity, rest_positions, rest_normals)
        edges = connectivity.edges
        sectors = sectors_of(connectivity)  # each side of a crease has its own curvature
        edge_of = sectors.edge_of
        normals = rest_normals.astype(np.float64)
        if connectivity.is_sharp.any():
            normals = _normals_of_sectors(sectors, connectivity.faces, rest_positions)
        start, end = sectors.edges.T
        turns = normals[end] - normals[start]
        along = np.diff(rest_positions[edges[edge_of]], axis=1)[:, 0]
        along /= _diagonal(rest_positions[edges])
        heights = 0.125 * np.abs(np.einsum("ij,ij->i", turns, along))
        measures = heights * np.cbrt(np.linalg.norm(along, axis=1) / USUAL_LENGTH)
        once, twice = self.thresholds.limits
        asked = (measures > once).astype(np.uint8) + (measures > twice)
        splits = np.zeros(len(edges), dtype=np.uint8)
        np.maximum.at(splits, edge_of, asked)
        # Metrics at which a blended point is at its final position: a constant metric cannot move
        # it there.
        self._decided = np.array([-np.inf, RAMP_WIDTH, 1.0 + RAMP_WIDTH], np.float32)[splits]

    def measure(self, positions: Floats64, normals: Floats32, metric: Floats32) -> None:
        """Write the refinement metric of every edge, shape (E,)."""
        metric[:] = self._decided


def _normals_of_sectors(sectors: Sectors, faces: Unsigned32, positions: Floats64) -> Floats64:
    """Unit normals of sectors, weighted by area, shape (S, 3)."""
    crosses = cross_products(positions, faces)
    normals = np.zeros((sectors.sector_count, 3))
    for corner in range(3):
        np.add.at(normals, sectors.corners[:, corner], crosses)
    return unit_vectors(normals, 1e-300)


def _diagonal(positions: Floats64) -> float:
    """Diagonal of the box around the ends of edges, shape (E, 2, 3); 1 if it has no size.

    Points that no triangle uses do not count: they are not a part of the mesh.
    """
    sides = np.ptp(positions, axis=(0, 1)) if len(positions) else np.zeros(3)
    size = float(np.linalg.norm(sides))
    return size if size > 0.0 else 1.0
