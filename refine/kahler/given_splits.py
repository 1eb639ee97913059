"""Given splits of edges, the same in all frames: one connectivity for a clip.

Kähler, Haber, Seidel 2003, section 4.1, determine splits in every frame, so vertices and triangles
of the output change. Many file formats, and programs that keep data at vertices, need the same
vertices and triangles in every frame. `splits_of_clip` finds, for each edge, the most splits that
any frame of a clip needs. The result is still adaptive, and never coarser than a frame that is
refined separately.

With a criterion that never changes, `Criterion.is_constant`, a refiner decides, numbers points and
looks triangles up once (`Kahler`). A frame only places points.
"""

from collections.abc import Iterable
from typing import Protocol

import numpy as np
import numpy.typing as npt

from ...geometry.arrays import Floats32, Floats64, Integers32, Unsigned8
from ..border.plugin import View
from ..mesh.connectivity import Connectivity
from ..mesh.validation import as_array
from .criterion import Criterion
from .table import MOST_SPLITS


class GivenSplits(Criterion):
    """A criterion with the same splits in every frame; all points are at their final positions."""

    uses_normals = False
    is_constant = True

    def __init__(self, splits: npt.ArrayLike) -> None:
        """`splits`: 0, 1 or 2 for every edge, shape (E,), in the order of `Refiner.edges`.

        Raises ValueError for anything else.
        """
        wanted = "0, 1 or 2 for every edge, shape (E,)"
        given = as_array("splits", splits, wanted)
        if given.ndim != 1 or given.dtype.kind not in "iu":
            raise ValueError(f"splits must be {wanted}, got {given.dtype} of shape {given.shape}")
        bad = np.flatnonzero((given < 0) | (given > MOST_SPLITS))
        if len(bad) > 0:
            raise ValueError(f"splits must be {wanted}, but edge {bad[0]} has {given[bad[0]]}")
        self._splits = given.astype(np.uint8)

    def bind(
        self, connectivity: Connectivity, rest_positions: Floats64, rest_normals: Floats32
    ) -> None:
        """Raise ValueError unless there is a number for every edge."""
        edge_count = len(connectivity.edges)
        if len(self._splits) != edge_count:
            raise ValueError(
                f"splits must have a number for each of the {edge_count} edges of this mesh "
                f"(refiner.edges), got {len(self._splits)}"
            )

    def measure(self, positions: Floats64, normals: Floats32, metric: Floats32) -> None:
        """Write the metric of every edge, shape (E,), so high that blending is complete."""
        np.copyto(metric, self._splits)
        metric[self._splits == 0] = -np.inf


class SplitsEdges(Protocol):
    """A `Refiner`, or a `WeldedRefiner`."""

    @property
    def edges(self) -> Integers32:
        """End points of each edge, shape (E, 2)."""

    @property
    def splits(self) -> Unsigned8:
        """How often each edge was split in the last frame, shape (E,)."""

    def refine(self, positions: npt.NDArray[np.floating], /, *, view: View | None = None) -> object:
        """Refine a frame."""


def splits_of_clip(
    refiner: SplitsEdges, frames: Iterable[npt.NDArray[np.floating]], view: View | None = None
) -> Unsigned8:
    """Refine all frames; return the largest number of splits of each edge, shape (E,).

        changing = refine.create("kahler", faces, rest)
        splits = refine.splits_of_clip(changing, frames)
        fixed = refine.create("kahler", faces, rest, splits=splits)

    `frames`: positions of one frame each, shape (V, 3). `view`: as `Refiner.refine` takes it.
    Without frames no edge is split. Raises ValueError as `refine` does.
    """
    most = np.zeros(len(refiner.edges), dtype=np.uint8)
    for positions in frames:
        refiner.refine(positions, view=view)
        np.maximum(most, refiner.splits, out=most)
    return most
