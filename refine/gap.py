r"""A criterion for meshes that have a finer one: how far an edge is from where it should be.

Kähler, Haber, Seidel 2003, section 6: "If the input geometry has been produced from a finer mesh,
one could do even better than smoothing". The paper's criterion asks where a mesh bends more than at
rest; but a mesh that was made of a finer one is wrong at rest already, most where the finer one has
its detail. In a frame, how far the middle of an edge stands off is

    gap at rest, to the finer mesh  +  | height of the arc over the edge - height at rest |

in mean edge lengths of the mesh at rest. The first is known at binding; the second is what Taubin's
curvature (criteria.py) says has been added since. It spends triangles where the scheme `detail` has
something to show. Without history, and continuous, so it can be blended.
"""

import numpy as np
import numpy.typing as npt

from .arguments import checked_indices, checked_positions
from .closest import Surface
from .connectivity import Connectivity
from .criteria import arc_heights, scale_needs, splits_of_needs
from .criterion import Thresholds
from .detail import FinerMesh
from .kernels import kernel

Floats = npt.NDArray[np.float32]
Doubles = npt.NDArray[np.float64]
Unsigned = npt.NDArray[np.uint32]


class Gap:
    """Splits edges whose middle is far from a finer mesh (a Criterion that measures)."""

    def __init__(self, finer: FinerMesh, once: float = 0.035, twice: float = 0.105) -> None:
        """`finer`: positions at rest, in the place of the coarse mesh, and triangles.

        `once`, `twice`: distances in mean edge lengths of the mesh at rest. The defaults make about
        twice the triangles of faces of 2000.
        """
        positions = checked_positions(finer[0], "finer[0]")
        faces = checked_indices("finer[1]", finer[1], len(positions), "finer[0]")
        self._finer = (positions, faces.astype(np.uint32))
        self.thresholds = Thresholds(once, twice, "distances in mean edge lengths")

    def bind(
        self, connectivity: Connectivity, rest_positions: Doubles, rest_normals: Floats
    ) -> None:
        """Find how far the middle of every edge is from the finer mesh."""
        a, b = connectivity.edges.T
        edge_count = len(a)
        self._edges: Unsigned = connectivity.edges.view(np.uint32)
        self._need = np.zeros(edge_count, dtype=np.float32)
        self._rest = np.zeros(edge_count, dtype=np.float32)
        heights = np.zeros_like(self._rest)
        arc_heights(rest_positions, rest_normals, self._edges, self._rest, heights)
        self._rest = heights
        middles = 0.5 * (rest_positions[a] + rest_positions[b])
        surface = Surface(*self._finer)
        looks = (rest_normals[a] + rest_normals[b]).astype(np.float64)
        there = surface.at(surface.positions, *surface.closest(middles, looks))
        self._gaps = np.linalg.norm(there - middles, axis=1).astype(np.float32)
        lengths = np.linalg.norm(rest_positions[b] - rest_positions[a], axis=1)
        self._unit = np.float32(lengths.mean()) if edge_count else np.float32(1.0)

    def measure(self, positions: Doubles, normals: Floats, need: Floats) -> None:
        """Write the need of every edge, shape (E,): above 0 one split, above 1 two."""
        arc_heights(positions, normals, self._edges, self._rest, need)
        add_gaps(self._gaps, need)
        limits = self.thresholds
        scale_needs(need, limits.once * self._unit, limits.width * self._unit, limits.most)

    def mark(self, positions: Doubles, normals: Floats, splits: npt.NDArray[np.uint8]) -> None:
        """Write the number of splits of every edge into `splits`, shape (E,)."""
        self.measure(positions, normals, self._need)
        splits_of_needs(self._need, splits)


@kernel
def add_gaps(gaps: Floats, need: Floats) -> None:
    """Turn changes of height in `need`, shape (E,), into distances from the finer surface."""
    for e in range(need.shape[0]):
        need[e] = gaps[e] + abs(need[e])
