"""Criteria, which decide how often each edge is split in a frame.

Kähler, Haber, Seidel 2003, section 4.1: compare the dot product of the vertex normals at both ends
of an edge with its value in the undeformed mesh. Where it has dropped, the surface bends more than
at rest, for which its triangles were made.

    drop = rest dot product - current dot product;  one split above `threshold_once`,
                                                    two splits above `threshold_twice`

Rounding. Rest and current values come from the same kernel, so an undeformed mesh drops by exactly
0. Edge vectors are taken in double precision (normals.py), so a mesh far from the origin loses
nothing. A rigid motion leaves rounding only, and drops up to `DROP_ROUNDING` never split an edge.
Measured on two heads of 2030 triangles in millimetres: 8e-7 for float64 positions at any place.
float32 positions lose bits before they arrive here: 8e-6 around the origin, 9e-5 one metre away,
which is still far below the default thresholds.
"""

import reprlib
from numbers import Real
from typing import Annotated

import numpy as np

from ...geometry.arrays import Flags, Floats32, Floats64, Unsigned8, Unsigned32
from ...geometry.vectors import ONE, ROW_WIDTH, add_to_row, cross, difference, dot, row_of
from ...jit import njit
from ..border.option import Option
from ..border.plugin import View
from ..border.registry import Registry
from ..mesh.connectivity import Connectivity
from .scheme import Scheme

THRESHOLD_ONCE = 0.02
"""Default drop above which an edge is split once: on a plane, a bend of 11 degrees along the edge.

Chosen with `THRESHOLD_TWICE` to get the 1.5 times of Table 1: scanned full expressions (smile with
open jaw; sneer with smile and lowered brows) on a face of 2029 triangles gave 1.56 and 1.57 times.
"""
THRESHOLD_TWICE = 0.08
"""Default drop above which an edge is split twice: on a plane, a bend of 23 degrees."""
DROP_ROUNDING = 1e-5
"""Drops up to this size are rounding (measured, see above)."""
LEAST_WIDTH = 1e-6
"""Least difference of the two thresholds: equal thresholds leave no range to blend over."""
LARGEST_LIMIT = 1e30
"""Largest finite threshold: single precision holds all measures."""
UNDEFINED_NORMAL = 1e-6
"""Least length of a sum of normals, relative to the sum of lengths: a shorter sum is only
rounding.
"""


INFINITE_THRESHOLD = np.float32(np.inf)
Levels = Annotated[int, Option("most splits of an edge; 0: this criterion splits none", 0, 2)]
DropOnce = Annotated[
    float,
    Option(
        "an edge splits once if the dot product of the normals at its ends has dropped by more "
        "than this since rest",
        least=0.0,
    ),
]
DropTwice = Annotated[float, Option("the same for splitting twice", least=0.0)]


class Criterion:
    """Base class of all criteria, the paper's and your own: a criterion determines splits.

    A subclass defines `measure`, which `mark` calls; it may override `mark` with a faster version.
    All other methods do nothing by default. A refiner calls `set_scheme` and `bind` once, then in
    every frame `set_view`, and `mark` or, if it blends, `measure`.
    """

    parts: tuple["Criterion", ...] = ()
    """Criteria that this criterion uses; each of them also serves only one refiner."""
    uses_normals = True
    """Whether the criterion reads normals; they are computed only if a part of the refiner reads
    them.
    """
    is_constant = False
    """Whether every frame gets the same splits. A refiner then calls the criterion once, at its
    first frame; number and order of its vertices and triangles never change.
    """
    _metric: Floats32 = np.zeros(0, dtype=np.float32)
    """Metric of each edge for `mark`, shape (E,)."""

    def set_scheme(self, scheme: Scheme) -> None:
        """Take the scheme, which places the new points."""

    def bind(
        self, connectivity: Connectivity, rest_positions: Floats64, rest_normals: Floats32
    ) -> None:
        """Take the undeformed mesh: `rest_positions` and `rest_normals`, shape (V, 3)."""

    def set_view(self, view: View | None) -> None:
        """Take the view of this frame; None if the caller gave none."""

    def mark(self, positions: Floats64, normals: Floats32, splits: Unsigned8) -> None:
        """Write 0, 1 or 2 for every edge into `splits`, shape (E,)."""
        if len(self._metric) != len(splits):
            self._metric = np.zeros(len(splits), dtype=np.float32)
        self.measure(positions, normals, self._metric)
        if splits_of_metric(self._metric, splits) > 0:
            raise ValueError(self.complaint(self._metric))

    def measure(self, positions: Floats64, normals: Floats32, metric: Floats32) -> None:
        """Write the refinement metric of every edge, shape (E,): above 0 one split, above 1 two.

        Blending is continuous only if the metric is a continuous function of the positions.
        """
        raise NotImplementedError(f"{type(self).__name__} must have a method measure")

    def complaint(self, metric: Floats32) -> str:
        """Return a message on edges whose metric is NaN; `metric`: one value per edge, (E,)."""
        bad = np.flatnonzero(np.isnan(metric))
        return (
            f"the criterion {type(self).__name__} measures NaN for {len(bad)} of {len(metric)} "
            f"edges, first for edge {bad[0]}; measure must write a number for every edge"
        )

    def find_complaint(self, positions: Floats64, normals: Floats32, edge_count: int) -> str | None:
        """Measure a frame again with each part of the criterion; return the first complaint."""
        for part in self.parts:
            complaint = part.find_complaint(positions, normals, edge_count)
            if complaint is not None:
                return complaint
        metric = np.zeros(edge_count, dtype=np.float32)
        self.measure(positions, normals, metric)
        return self.complaint(metric) if np.isnan(metric).any() else None


criteria: Registry[Criterion] = Registry("criterion", "risorius.criteria")
"""Criteria by name; a factory is called without arguments, once for each refiner."""


class Thresholds:
    """Two values of a measure: above the first an edge is split once, above the second twice."""

    def __init__(
        self, once: float, twice: float, meaning: str, *, least: float = 0.0, levels: int = 2
    ) -> None:
        """`meaning`: the measured quantity, for errors; `least`: smaller thresholds count as this.

        `levels`: the most splits of an edge, 0 to 2. Raises ValueError if the thresholds are out of
        order, and for other levels.
        """
        if levels not in (0, 1, 2):
            raise ValueError(f"levels must be 0, 1 or 2 splits of an edge, got {levels!r}")
        self.levels = levels
        """The most splits of an edge; it may be set at any time."""
        are_numbers = all(isinstance(n, Real) and not isinstance(n, bool) for n in (once, twice))
        is_right = are_numbers and 0.0 <= once <= twice
        if not is_right or any(LARGEST_LIMIT < limit < np.inf for limit in (once, twice)):
            raise ValueError(
                f"threshold_once and threshold_twice are {meaning} with "
                f"0 <= threshold_once <= threshold_twice <= {LARGEST_LIMIT:g} (or inf, which "
                f"switches a level off), got {reprlib.repr(once)} and {reprlib.repr(twice)}"
            )
        self.once = np.float32(max(float(once), least))
        """The measure above which an edge is split once; it may be set at any time."""
        self.twice = np.float32(max(float(twice), least))
        """The measure above which an edge is split twice; it may be set at any time."""

    @property
    def limits(self) -> tuple[np.float32, np.float32]:
        """Both thresholds; a threshold is infinite if `levels` excludes its split."""
        once = self.once if self.levels > 0 else INFINITE_THRESHOLD
        return once, self.twice if self.levels > 1 else INFINITE_THRESHOLD

    @property
    def width(self) -> np.float32:
        """The difference of the thresholds: the unit of the metric."""
        if np.isinf(self.twice):
            return self.once if 0.0 < self.once < np.inf else ONE
        return np.float32(max(float(self.twice - self.once), LEAST_WIDTH))

    @property
    def most(self) -> np.float32:
        """The greatest metric of an edge: 1 if the second level is switched off, else infinite."""
        return np.float32(1.0 if np.isinf(self.limits[1]) else np.inf)

    def scale(self, measures: Floats32, unit: np.float32 = ONE) -> None:
        """Turn measures of edges, shape (E,), into metrics; `unit`: the thresholds' unit."""
        scale_metric(measures, self.limits[0] * unit, self.width * unit, self.most)


class NormalDrop(Criterion):
    """The paper's criterion: the drop of the dot product of the normals at both ends of an edge."""

    def __init__(
        self,
        threshold_once: DropOnce = THRESHOLD_ONCE,
        threshold_twice: DropTwice = THRESHOLD_TWICE,
        levels: Levels = 2,
    ) -> None:
        meaning = "drops of a dot product"
        self.thresholds = Thresholds(
            threshold_once, threshold_twice, meaning, least=DROP_ROUNDING, levels=levels
        )
        """Drops above which an edge is split once and twice; they may be replaced at any time."""

    def bind(
        self, connectivity: Connectivity, rest_positions: Floats64, rest_normals: Floats32
    ) -> None:
        """Store the dot product of every edge of the undeformed mesh."""
        self._edges = connectivity.edges.astype(np.uint32)  # numba takes writable arrays faster
        self._rest_dots = np.empty(len(self._edges), dtype=np.float32)
        edge_dots(rest_normals, self._edges, self._rest_dots)
        self._dots = np.empty_like(self._rest_dots)
        # If all triangles around are slivers at rest, there is no direction to compare with: no
        # split.
        undefined = np.empty(len(rest_positions), dtype=np.bool_)
        find_undefined_normals(connectivity.faces, rest_positions, undefined)
        if undefined.any():
            self._rest_dots[undefined[connectivity.edges].any(axis=1)] = -np.inf

    def mark(self, positions: Floats64, normals: Floats32, splits: Unsigned8) -> None:
        """Write the number of splits of every edge into `splits`, shape (E,)."""
        once, twice = self.thresholds.limits
        mark_drops(normals, self._edges, self._rest_dots, once, twice, self._dots, splits)

    def measure(self, positions: Floats64, normals: Floats32, metric: Floats32) -> None:
        """Write the refinement metric of every edge, shape (E,)."""
        edge_dots(normals, self._edges, metric)
        np.subtract(self._rest_dots, metric, out=metric)
        self.thresholds.scale(metric)


@njit
def edge_dots(normals: Floats32, edges: Unsigned32, dots: Floats32) -> None:
    """Write the dot product of the normals at both ends of every edge into `dots`, shape (E,)."""
    assert normals.shape[1] == ROW_WIDTH and edges.shape[1] == 2
    for e in range(edges.shape[0]):
        start = row_of(normals, edges[e, 0])
        end = row_of(normals, edges[e, 1])
        dots[e] = dot(start, end)


@njit
def mark_drops(
    normals: Floats32,
    edges: Unsigned32,
    rest_dots: Floats32,
    once: np.float32,
    twice: np.float32,
    dots: Floats32,
    splits: Unsigned8,
) -> None:
    """Write 0, 1 or 2 into `splits`, shape (E,), by the drop of the dot product (as above).

    `edges`: end points, shape (E, 2); `once`, `twice`: the thresholds; `dots`: scratch, shape (E,).
    The compared numbers are consecutive in memory, so that the compiler vectorises the comparison.
    """
    edge_dots(normals, edges, dots)
    for e in range(edges.shape[0]):
        drop = rest_dots[e] - dots[e]
        splits[e] = np.uint8(drop > once) + np.uint8(drop > twice)


@njit
def splits_of_metric(metric: Floats32, splits: Unsigned8) -> int:
    """Write 0, 1 or 2 into `splits`, shape (E,): above 0 once, above 1 twice; count NaN."""
    undefined = 0
    for e in range(metric.shape[0]):
        splits[e] = np.uint8(metric[e] > np.float32(0.0)) + np.uint8(metric[e] > np.float32(1.0))
        undefined += metric[e] != metric[e]
    return undefined


@njit
def scale_metric(metric: Floats32, once: np.float32, width: np.float32, most: np.float32) -> None:
    """Turn the measures in `metric`, shape (E,), into metrics (see `Thresholds`)."""
    for e in range(metric.shape[0]):
        metric[e] = min((metric[e] - once) / width, most)


@njit
def find_undefined_normals(faces: Unsigned32, positions: Floats64, undefined: Flags) -> None:
    """Flag the vertices, shape (V,), whose normal is only a rounding error."""
    sums = np.zeros((positions.shape[0], 4))
    for t in range(faces.shape[0]):
        a = faces[t, 0]
        b = faces[t, 1]
        c = faces[t, 2]
        u = difference(positions, a, b)
        v = difference(positions, a, c)
        size = np.sqrt(dot(u, u) * dot(v, v))
        normal = cross(u, v)
        for i in range(3):
            add_to_row(sums, faces[t, i], normal)
            sums[faces[t, i], 3] += size
    for k in range(positions.shape[0]):
        normal = row_of(sums, k)
        undefined[k] = np.sqrt(dot(normal, normal)) <= UNDEFINED_NORMAL * sums[k, 3]
