r"""Criteria that split what is curved: now (`curvature`), or at rest (`rest`).

`Curvature` is the height of the arc over an edge (Taubin 1995), less that at rest: what the paper
proposes in section 4.1. `RestCurvature` is for meshes that are too coarse for their own form.

The paper's criterion counts what has been bent since rest, so an outline that is a polygon at rest
stays one. `RestCurvature` sees it.

    measure = height of the arc x cube root of (length / usual length)

The root lets long edges, whose corners are seen most, go before short ones: where a mesh is fine
already, as at lips that touch, smoothing would only open gaps. (A limit of length instead tore the
rims of ears, where long and short edges meet.)
"""

import numpy as np

from ...jit import njit
from ..mesh.arrays import Doubles, Floats, Unsigned
from ..mesh.connectivity import Connectivity
from .blending import RAMP
from .measuring import Measuring, mean_length

USUAL = 1.0 / 40.0
"""Length of the edge whose measure is its height, in sizes of the mesh: about what a face has."""


class Curvature(Measuring):
    """Discrete curvature along the edges (Taubin 1995), as the height of the arc over them."""

    def __init__(self, once: float = 0.025, twice: float = 0.06) -> None:
        """`once`, `twice`: heights in mean edge lengths of the mesh at rest.

        Only what has been added to the height at rest counts, as in the paper.
        """
        super().__init__(once, twice, "heights in mean edge lengths")

    def bind(
        self, connectivity: Connectivity, rest_positions: Doubles, rest_normals: Floats
    ) -> None:
        """Store the heights of the undeformed mesh."""
        super().bind(connectivity, rest_positions, rest_normals)
        self._rest = np.zeros(len(self._edges), dtype=np.float32)
        arc_heights(rest_positions, rest_normals, self._edges, self._rest, self._rest)
        self._unit = mean_length(connectivity, rest_positions)

    def measure(self, positions: Doubles, normals: Floats, metric: Floats) -> None:
        """Write the refinement metric of every edge, shape (E,)."""
        arc_heights(positions, normals, self._edges, self._rest, metric)
        self.thresholds.scale(metric, self._unit)


class RestCurvature(Measuring):
    """The height of the arc over an edge at rest, and a little its length; decided on once.

    The same edges are split in every frame, wherever the eye is, so nothing can pop.
    """

    uses_normals = False

    def __init__(self, once: float = 0.00077, twice: float = 0.0053) -> None:
        """`once`, `twice`: measures in sizes of the mesh, so a fine mesh is left as it is.

        Chosen by eye on a head of 2030 triangles, 720 pixels high: of its outline, lower limits
        show no more. Splits have to reach everything that is round: beside one that was drawn
        inward a vertex without splits sticks out.
        """
        super().__init__(once, twice, "heights in sizes of the mesh")

    def bind(
        self, connectivity: Connectivity, rest_positions: Doubles, rest_normals: Floats
    ) -> None:
        """Decide on all edges."""
        super().bind(connectivity, rest_positions, rest_normals)
        start, end = connectivity.edges.T
        turns = rest_normals[end].astype(np.float64) - rest_normals[start]
        along = (rest_positions[end] - rest_positions[start]) / _diagonal(rest_positions)
        # As in `arc_heights`; once, so it is not worth a kernel to be compiled.
        heights = 0.125 * np.abs(np.einsum("ij,ij->i", turns, along))
        measures = heights * np.cbrt(np.linalg.norm(along, axis=1) / USUAL)
        limits = self.thresholds
        splits = (measures > limits.once).astype(np.uint8) + (measures > limits.twice)
        # Needs at which a blended point has grown: there is nothing that it could grow with.
        self._decided = np.array([-np.inf, RAMP, 1.0 + RAMP], np.float32)[splits]

    def measure(self, positions: Doubles, normals: Floats, metric: Floats) -> None:
        """Write the refinement metric of every edge, shape (E,)."""
        metric[:] = self._decided


def _diagonal(positions: Doubles) -> float:
    """Of the box around all vertices; 1 if it has no size."""
    size = float(np.linalg.norm(np.ptp(positions, axis=0))) if len(positions) else 0.0
    return size if size > 0.0 else 1.0


@njit
def arc_heights(
    positions: Doubles, normals: Floats, edges: Unsigned, rest: Floats, heights: Floats
) -> None:
    """Write the height of the arc over every edge, less that at rest, shape (E,)."""
    for e in range(edges.shape[0]):
        a, b = edges[e, 0], edges[e, 1]
        at_a = at_b = np.float32(0.0)
        for i in range(3):
            d = np.float32(positions[b, i] - positions[a, i])
            at_a += d * normals[a, i]
            at_b += d * normals[b, i]
        # k L^2 / 8 with k the mean of 2 n_a . d / L^2 and, from the other side, -2 n_b . d / L^2.
        heights[e] = np.float32(0.125) * abs(at_a - at_b) - rest[e]
