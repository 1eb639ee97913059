r"""What criteria beside the paper's share: they measure, and compare with two thresholds.

Kähler, Haber, Seidel 2003, section 4.1 ("More complex criteria can be used as well, such as
measuring discrete curvature on the mesh [19]") and section 6 ("refining the mesh along silhouette
edges. To achieve this, appropriate splitting criteria have to be developed").

    curvature   height of the arc over an edge      |k| L^2 / 8, k = 2 n . (b - a) / L^2 the
                in mean edge lengths at rest        curvature along it (Taubin 1995, section 3)
    rest        much the same at rest               the same edges in every frame (curvature.py)
    silhouette  how far the surface turns along     (1 - n_a . n_b) x facing; facing is 1 where the
                an edge that is seen edge-on        line of sight grazes the edge, 0 a BAND away;
                                                    the turn counts up to where points have grown
    screen      length of an edge as it is seen     L x focal / distance from the eye, in pixels
    border      angle by which the border turns     how an opened mouth differs from a shut one
                otherwise than at rest
    displacement                                    for schemes that tell: those with curved edges,
                how far a split moves a middle      and all with refined normals (displacement.py)
                and turns the normal there

Each has two thresholds, above which an edge is split once and twice, and says how much an edge
needs a split, so that all of them can be blended (blending.py) and any of them combined.
"""

from collections.abc import Sequence

import numpy as np

from ..border.plugin import View
from ..kahler.criterion import Criterion, Thresholds
from ..kahler.smoothing import Scheme
from ..mesh.arrays import Doubles, Floats, Small
from ..mesh.connectivity import Connectivity


class Measuring(Criterion):
    """A criterion that measures, and compares with two thresholds."""

    def __init__(self, once: float, twice: float, meaning: str) -> None:
        self.thresholds = Thresholds(once, twice, meaning)

    def bind(
        self, connectivity: Connectivity, rest_positions: Doubles, rest_normals: Floats
    ) -> None:
        """Take the edges."""
        self._edges = connectivity.edges.view(np.uint32)


class Maximum(Criterion):
    """Several criteria: each edge is split as often as the one that asks for most."""

    def __init__(self, criteria: Sequence[Criterion]) -> None:
        if not criteria:
            raise ValueError("criterion: an empty list decides nothing; name at least one")
        self.parts = tuple(criteria)

    def bind(
        self, connectivity: Connectivity, rest_positions: Doubles, rest_normals: Floats
    ) -> None:
        """Bind them all."""
        for part in self.parts:
            part.bind(connectivity, rest_positions, rest_normals)
        self._splits = np.zeros(len(connectivity.edges), dtype=np.uint8)
        self._metric = np.zeros(len(connectivity.edges), dtype=np.float32)

    def set_scheme(self, scheme: Scheme) -> None:
        """Show the scheme to them all."""
        for part in self.parts:
            part.set_scheme(scheme)

    def set_view(self, view: View | None) -> None:
        """Show the view to them all."""
        for part in self.parts:
            part.set_view(view)

    def mark(self, positions: Doubles, normals: Floats, splits: Small) -> None:
        """Write the largest number of splits of every edge into `splits`, shape (E,)."""
        splits[:] = 0
        for part in self.parts:
            part.mark(positions, normals, self._splits)
            np.maximum(splits, self._splits, out=splits)

    @property
    def measures(self) -> bool:
        """Only a whole of measuring parts measures; others decide in whole splits."""
        return all(part.measures for part in self.parts)

    def measure(self, positions: Doubles, normals: Floats, metric: Floats) -> None:
        """Write the largest metric of every edge, shape (E,)."""
        metric[:] = -np.inf
        for part in self.parts:
            part.measure(positions, normals, self._metric)
            np.maximum(metric, self._metric, out=metric)


def mean_length(connectivity: Connectivity, positions: Doubles) -> np.float32:
    """Mean length of the edges; 1 if there are none."""
    lengths = np.linalg.norm(np.diff(positions[connectivity.edges], axis=1)[:, 0], axis=1)
    return np.float32(lengths.mean() if len(lengths) else 1.0)
