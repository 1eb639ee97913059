r"""Base class of all criteria except the paper's: each compares a measure with two thresholds.

Kähler, Haber, Seidel 2003, section 4.1 ("More complex criteria can be used as well, such as
measuring discrete curvature on the mesh [19]") and section 6 ("refining the mesh along silhouette
edges. To achieve this, appropriate splitting criteria have to be developed").

Each has two thresholds, above which an edge is split once and twice. Its measure is continuous, so
all criteria can be blended (blending.py) and combined. The criterion `silhouette` is defined here.
It measures how far the surface turns along an edge near the outline:

    (1 - n_a . n_b) x facing      facing is 1 where the line of sight grazes the edge, 0 at
                                  SILHOUETTE_BAND; the turn is limited (see `Silhouette`)
"""

import reprlib
from collections.abc import Sequence
from typing import Annotated

import numpy as np

from ...geometry.arrays import Floats32, Floats64, Unsigned8, Unsigned32
from ...geometry.vectors import ONE
from ...jit import njit
from ..border.option import Option
from ..border.plugin import View
from ..kahler.criterion import Criterion, Levels, Thresholds
from ..kahler.scheme import Scheme
from ..mesh.connectivity import Connectivity
from .blending import RAMP_WIDTH

SILHOUETTE_BAND = 0.3
"""Cosine between normal and line of sight where the silhouette ends, 17 degrees away."""


Once = Annotated[float, Option("an edge splits once where its measure is above this", least=0.0)]
Twice = Annotated[float, Option("the same for splitting twice", least=0.0)]


class Measuring(Criterion):
    """A criterion that compares a measure of each edge with two thresholds."""

    def __init__(self, once: float, twice: float, meaning: str, levels: int = 2) -> None:
        self.thresholds = Thresholds(once, twice, meaning, levels=levels)

    def bind(
        self, connectivity: Connectivity, rest_positions: Floats64, rest_normals: Floats32
    ) -> None:
        """Take the edges."""
        self._edges = connectivity.edges.view(np.uint32)


class Maximum(Criterion):
    """A combination of several criteria: an edge is split as often as any of them requires."""

    def __init__(self, criteria: Sequence[Criterion]) -> None:
        if not criteria:
            raise ValueError("criterion: an empty list decides nothing; name at least one")
        self.parts = tuple(criteria)
        self.uses_normals = any(part.uses_normals for part in criteria)
        self.is_constant = all(part.is_constant for part in criteria)

    def bind(
        self, connectivity: Connectivity, rest_positions: Floats64, rest_normals: Floats32
    ) -> None:
        """Bind all criteria."""
        for part in self.parts:
            part.bind(connectivity, rest_positions, rest_normals)
        self._splits = np.zeros(len(connectivity.edges), dtype=np.uint8)
        self._metric = np.zeros(len(connectivity.edges), dtype=np.float32)

    def set_scheme(self, scheme: Scheme) -> None:
        """Pass the scheme to all criteria."""
        for part in self.parts:
            part.set_scheme(scheme)

    def set_view(self, view: View | None) -> None:
        """Pass the view to all criteria."""
        for part in self.parts:
            part.set_view(view)

    def mark(self, positions: Floats64, normals: Floats32, splits: Unsigned8) -> None:
        """Write the largest number of splits of every edge into `splits`, shape (E,)."""
        splits[:] = 0
        for part in self.parts:
            part.mark(positions, normals, self._splits)
            np.maximum(splits, self._splits, out=splits)

    def measure(self, positions: Floats64, normals: Floats32, metric: Floats32) -> None:
        """Write the largest metric of every edge, shape (E,)."""
        self.parts[0].measure(positions, normals, metric)
        for part in self.parts[1:]:
            part.measure(positions, normals, self._metric)
            np.maximum(metric, self._metric, out=metric)


class Silhouette(Measuring):
    """The criterion `silhouette`: it splits edges along which the surface turns away from the eye.

    The angle between the normals of an edge is limited to the angle that splits an edge on the
    outline twice. Otherwise points on coarse meshes would jump outward after a small motion of the
    eye.
    """

    def __init__(self, once: Once = 0.005, twice: Twice = 0.03, levels: Levels = 2) -> None:
        """`once`, `twice`: 1 - the cosine between the normals at both ends.

        `levels`: the most splits of an edge.
        """
        super().__init__(once, twice, "1 - the cosine between two normals", levels)

    def set_view(self, view: View | None) -> None:
        """Set the view of this frame; raises ValueError without a view with a finite eye."""
        if view is None:
            raise ValueError(
                f"{type(self).__name__} needs the place of the eye; pass "
                "view=refine.View(eye) to refine()"
            )
        eye = np.asarray(view.eye, dtype=np.float64)
        if eye.shape != (3,) or not np.isfinite(eye).all():
            raise ValueError(
                f"view must have a finite eye of shape (3,), got {reprlib.repr(view.eye)}"
            )
        self._eye = eye

    def measure(self, positions: Floats64, normals: Floats32, metric: Floats32) -> None:
        """Write the refinement metric of every edge, shape (E,)."""
        limits = self.thresholds
        most = limits.once + (ONE + RAMP_WIDTH) * limits.width
        turns_at_silhouette(positions, normals, self._edges, self._eye, most, metric)
        limits.scale(metric)


@njit
def turns_at_silhouette(
    positions: Floats64,
    normals: Floats32,
    edges: Unsigned32,
    eye: Floats64,
    most: np.float32,
    turns: Floats32,
) -> None:
    """Write 1 - the cosine of the end normals of every edge, faded out off the silhouette.

    Values above `most` count as `most`.
    """
    for e in range(edges.shape[0]):
        a = edges[e, 0]
        b = edges[e, 1]
        cosine = seen_a = seen_b = length_a = length_b = 0.0
        for i in range(3):
            to_a = eye[i] - positions[a, i]
            to_b = eye[i] - positions[b, i]
            cosine += normals[a, i] * normals[b, i]
            seen_a += to_a * normals[a, i]
            seen_b += to_b * normals[b, i]
            length_a += to_a * to_a
            length_b += to_b * to_b
        seen_a /= np.sqrt(max(length_a, 1e-30))
        seen_b /= np.sqrt(max(length_b, 1e-30))
        away = 0.0 if seen_a * seen_b <= 0.0 else min(abs(seen_a), abs(seen_b))
        turn = min(np.float32(1.0 - cosine), most)
        turns[e] = turn * max(0.0, 1.0 - away / SILHOUETTE_BAND)


def mean_length(connectivity: Connectivity, positions: Floats64) -> np.float32:
    """Mean length of the edges; 1 if there are none."""
    ends = positions[connectivity.edges]
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    return np.float32(lengths.mean() if len(lengths) else 1.0)
