"""The criterion `bulge`: how far the scheme would move the middle of an edge.

For schemes whose edges are curves (curves.py): where the straight edge is far from its curve, the
unsplit mesh is wrong.
"""

import numpy as np

from ...jit import njit
from ..mesh.arrays import Doubles, Floats
from ..mesh.connectivity import Connectivity
from .blending import RAMP
from .measuring import Measuring, mean_length

HASTE = 0.6
"""Share of the first threshold of `bulge` in which a blended point grows. Chosen: a point that is
half grown costs as much as a whole one; with less than this surfaces jump farther than their input
moves."""


class Bulge(Measuring):
    """How far the scheme would move the middle of an edge: what is wrong without a split.

    For the schemes that interpolate. What is coarse at rest counts as well, unlike in the paper.
    """

    def __init__(self, once: float = 0.08, twice: float = 0.4, *, turning: float = 0.35) -> None:
        """`once`, `twice`: distances in mean edge lengths of the mesh at rest.

        `turning`: the distance that an error of normals of a radian counts that a split would mend,
        for the scheme `detail`; 0 looks at distances only.
        """
        super().__init__(once, twice, "distances in mean edge lengths")
        self.turning = turning

    def set_scheme(self, scheme: object) -> None:
        """Take the scheme of the refiner; raises ValueError for one without curves."""
        if not hasattr(scheme, "measure"):
            raise ValueError(
                'criterion "bulge" asks the scheme how far it moves edges, which '
                f'{type(scheme).__name__} does not tell; normals="refined" does'
            )
        self._scheme = scheme

    def bind(
        self, connectivity: Connectivity, rest_positions: Doubles, rest_normals: Floats
    ) -> None:
        """Store the unit of length."""
        super().bind(connectivity, rest_positions, rest_normals)
        self._unit = mean_length(connectivity, rest_positions)
        self._turns = np.zeros(len(connectivity.edges), dtype=np.float32)

    def measure(self, positions: Doubles, normals: Floats, need: Floats) -> None:
        """Write the need of every edge, shape (E,)."""
        limits = self.thresholds
        self._scheme.measure(need, self._turns)
        if self.turning > 0.0:
            count_turns(need, self._turns, np.float32(self.turning))
        limits.scale(need, self._unit)
        advance_needs(need, np.float32(HASTE) * limits.once / limits.width, RAMP)


@njit
def count_turns(sizes: Floats, turns: Floats, scale: np.float32) -> None:
    """Add what the turns of normals count to the sizes of edges, shape (E,), as squares."""
    for e in range(sizes.shape[0]):
        turn = scale * turns[e]
        sizes[e] = np.sqrt(sizes[e] * sizes[e] + turn * turn)


@njit
def advance_needs(need: Floats, soon: np.float32, ramp: np.float32) -> None:
    """Stretch the needs, shape (E,), so that `soon` becomes `ramp`, where points have grown."""
    if soon >= ramp:
        return
    for e in range(need.shape[0]):
        if need[e] <= np.float32(0.0) or need[e] >= np.float32(1.0):
            continue
        if need[e] < soon:
            need[e] *= ramp / soon
        else:
            rest = (np.float32(1.0) - need[e]) / (np.float32(1.0) - soon)
            need[e] = np.float32(1.0) - (np.float32(1.0) - ramp) * rest
