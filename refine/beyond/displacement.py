"""The criterion `displacement`: how far a split moves an edge's midpoint and turns its normal.

Where the straight edge is far from the scheme's curve, the unsplit mesh is wrong. Where the normal
in the middle differs from the mean of those at the ends, the shading is wrong. The criterion needs
a scheme that measures both (`Scheme.measure`): a scheme with curved edges, or any scheme with
`normals="refined"`.

    size of an edge     hypot(displacement, turning x angle x length)      a distance

A border is an outline from every viewpoint, and shading does not show how it bends. So the turn of
the border curve counts there: an arc of height s turns by 8 s / length between its ends.
"""

from typing import Annotated

import numpy as np

from ...geometry.arrays import Floats32, Floats64, Unsigned32
from ...jit import njit
from ..border.option import Option
from ..kahler.criterion import Levels
from ..kahler.scheme import Scheme
from ..mesh.connectivity import Connectivity
from .blending import RAMP_WIDTH
from .measuring import Measuring, Once, Twice, mean_length

GROWTH_SHARE = 0.6
"""Fraction of the first threshold over which a blended point moves to its final position. Chosen
small, because a half moved point costs as much as a fully moved one; with a still smaller one,
the surface moves faster than its input.
"""

BORDER_WEIGHT = np.float32(8.0)
"""Factor on the size of an edge on a border."""


Turning = Annotated[
    float, Option("weight of a turn of the normal by a radian, in lengths of the edge", least=0.0)
]


class Displacement(Measuring):
    """The criterion `displacement`: how far a split moves an edge's midpoint and turns its normal.

    Unlike in the paper, edges that are too coarse at rest also count.
    """

    uses_normals = False

    def __init__(
        self,
        once: Once = 0.08,
        twice: Twice = 0.4,
        *,
        turning: Turning = 0.35,
        levels: Levels = 2,
    ) -> None:
        """`once`, `twice`: distances in mean edge lengths of the mesh at rest.

        `turning`: the distance, in lengths of the edge, that counts as much as a turn of the normal
        by one radian; at 0 only distances count. `levels`: the most splits of an edge.
        """
        super().__init__(once, twice, "distances in mean edge lengths", levels)
        self.turning = turning

    def set_scheme(self, scheme: Scheme) -> None:
        """Take the scheme of the refiner; raises ValueError for a scheme without `measure`."""
        if not scheme.measures:
            raise ValueError(
                'criterion "displacement" needs a scheme that measures how far it moves edges; '
                f'{type(scheme).__name__} does so with normals="refined" only'
            )
        self._scheme = scheme

    def bind(
        self, connectivity: Connectivity, rest_positions: Floats64, rest_normals: Floats32
    ) -> None:
        """Store the unit of length, and find the borders."""
        super().bind(connectivity, rest_positions, rest_normals)
        self._unit = mean_length(connectivity, rest_positions)
        self._turns = np.zeros(len(connectivity.edges), dtype=np.float32)
        is_outline = ~connectivity.around.is_interior | self._scheme.curved(connectivity)
        self._borders = np.flatnonzero(is_outline).astype(np.uint32)

    def measure(self, positions: Floats64, normals: Floats32, metric: Floats32) -> None:
        """Write the refinement metric of every edge, shape (E,)."""
        limits = self.thresholds
        self._scheme.measure(metric, self._turns)
        if self.turning > 0.0:
            count_turns(metric, self._turns, np.float32(self.turning))
        weigh_borders(metric, self._borders)
        limits.scale(metric, self._unit)
        advance_metric(metric, np.float32(GROWTH_SHARE) * limits.once / limits.width, RAMP_WIDTH)


@njit
def count_turns(sizes: Floats32, turns: Floats32, scale: np.float32) -> None:
    """Add turns of normals to the sizes of edges: write hypot(size, scale x turn), shape (E,)."""
    for e in range(sizes.shape[0]):
        turn = scale * turns[e]
        sizes[e] = np.sqrt(sizes[e] * sizes[e] + turn * turn)


@njit
def weigh_borders(sizes: Floats32, borders: Unsigned32) -> None:
    """Multiply the sizes, shape (E,), of the edges `borders`, shape (B,), by BORDER_WEIGHT."""
    for k in range(borders.shape[0]):
        sizes[borders[k]] *= BORDER_WEIGHT


@njit
def advance_metric(metric: Floats32, soon: np.float32, ramp: np.float32) -> None:
    """Scale the metrics, (E,), so that `soon` becomes `ramp`, at which points are fully moved."""
    if soon >= ramp:
        return
    for e in range(metric.shape[0]):
        if metric[e] <= np.float32(0.0) or metric[e] >= np.float32(1.0):
            continue
        if metric[e] < soon:
            metric[e] *= ramp / soon
        else:
            rest = (np.float32(1.0) - metric[e]) / (np.float32(1.0) - soon)
            metric[e] = np.float32(1.0) - (np.float32(1.0) - ramp) * rest
