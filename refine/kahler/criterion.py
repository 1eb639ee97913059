"""How often each edge is split in this frame.

Kähler, Haber, Seidel 2003, section 4.1: compare the dot product of the vertex normals at both ends
of an edge with its value in the undeformed mesh. Where it has dropped, the surface bends more than
its triangles were made for.

    drop = rest dot product - current dot product;  one split above `threshold_once`,
                                                    two splits above `threshold_twice`

Rounding. Rest and current values come from the same kernel, so an undeformed mesh drops by exactly
0. Edge vectors are taken in double precision (normals.py), so a mesh far from the origin loses
nothing. What a rigid motion leaves is rounding, and drops up to `ROUNDING` never
split an edge. Measured on two heads of 2030 triangles in millimetres: 8e-7 for float64 positions
wherever they are; float32 positions lose bits before they arrive here, 8e-6 around the origin, 9e-5
one metre away, still far below the default thresholds.
"""

import reprlib
from numbers import Real
from typing import Protocol, runtime_checkable

import numpy as np
import numpy.typing as npt

from ...jit import njit
from ..border.registry import Registry
from ..mesh.connectivity import Connectivity

Floats = npt.NDArray[np.float32]
Doubles = npt.NDArray[np.float64]
Small = npt.NDArray[np.uint8]
Unsigned = npt.NDArray[np.uint32]

THRESHOLD_ONCE = 0.02
"""Default drop above which an edge is split once: a flat place bent by 11 degrees along an edge.

Chosen with `THRESHOLD_TWICE` to get the 1.5 times of Table 1: scanned full expressions (smile with
open jaw; sneer with smile and lowered brows) on a face of 2029 triangles gave 1.56 and 1.57 times.
"""
THRESHOLD_TWICE = 0.08
"""Default drop above which an edge is split twice: a flat place bent by 23 degrees."""
ROUNDING = 1e-5
"""Drops up to this size are rounding (measured, see above)."""
NARROWEST = 1e-6
"""Least distance of two thresholds; where they are equal there is nothing to blend over."""
LARGEST_LIMIT = 1e30
"""Largest threshold but infinity: single precision holds what is measured."""
ZERO, ONE, INFINITE = np.float32(0.0), np.float32(1.0), np.float32(np.inf)
UNDEFINED_NORMAL = 1e-6
"""A normal shorter than this fraction of the lengths that made it is rounding, not a direction."""


class Criterion(Protocol):
    """Decides on splits; anything with these two methods can take the place of the paper's rule.

    More methods are used where they are there: `measure(positions, normals, need)`, which blending
    asks for (see `Measured`); `look(view)`, which gets the `view` of every frame; `use(scheme)`,
    which gets the smoothing scheme, once, before anything else.
    """

    def bind(
        self,
        connectivity: Connectivity,
        rest_positions: Doubles,
        rest_normals: Floats,
    ) -> None:
        """Learn the undeformed mesh: `rest_positions` and `rest_normals`, shape (V, 3)."""

    def mark(self, positions: Doubles, normals: Floats, splits: Small) -> None:
        """Write 0, 1 or 2 for every edge into `splits`, shape (E,)."""


@runtime_checkable
class Measured(Criterion, Protocol):
    """A criterion that says how much an edge needs splits, and not only how many."""

    def measure(self, positions: Doubles, normals: Floats, need: Floats) -> None:
        """Write the need of every edge, shape (E,): above 0 one split, above 1 two.

        It has to be a continuous function of the positions for blending to be one.
        """


criteria: Registry[Criterion] = Registry("criterion")
"""Criteria by name."""
register_criterion = criteria.register


def _is_number(limit: object) -> bool:
    return isinstance(limit, Real) and not isinstance(limit, bool)


class Thresholds:
    """Two values of a measure: above the first an edge is split once, above the second twice."""

    def __init__(self, once: float, twice: float, meaning: str, *, least: float = 0.0) -> None:
        """`meaning`: what is measured, for the error; `least`: values up to this never count.

        Raises ValueError if the two are out of order.
        """
        is_right = _is_number(once) and _is_number(twice) and 0.0 <= once <= twice
        if not is_right or any(LARGEST_LIMIT < limit < np.inf for limit in (once, twice)):
            raise ValueError(
                f"threshold_once and threshold_twice are {meaning} with "
                f"0 <= threshold_once <= threshold_twice <= {LARGEST_LIMIT:g} (or inf, which "
                f"switches a level off), got {reprlib.repr(once)} and {reprlib.repr(twice)}"
            )
        self.limits = np.array([max(float(once), least), max(float(twice), least)], np.float32)

    @property
    def once(self) -> np.float32:
        """Above this an edge is split; may be set at any time."""
        return np.float32(self.limits[0])

    @once.setter
    def once(self, limit: float) -> None:
        self.limits[0] = limit

    @property
    def twice(self) -> np.float32:
        """Above this an edge is split twice; may be set at any time."""
        return np.float32(self.limits[1])

    @twice.setter
    def twice(self, limit: float) -> None:
        self.limits[1] = limit

    @property
    def width(self) -> np.float32:
        """What lies between the two: the unit of need."""
        if np.isinf(self.twice):
            return self.once if 0.0 < self.once < np.inf else np.float32(1.0)
        return np.float32(max(float(self.twice - self.once), NARROWEST))

    @property
    def most(self) -> np.float32:
        """The need that cannot be exceeded: 1 where the second level is switched off."""
        return np.float32(1.0 if np.isinf(self.twice) else np.inf)


class NormalDrop:
    """The paper's criterion: drop of the dot product of the vertex normals along each edge."""

    def __init__(
        self, threshold_once: float = THRESHOLD_ONCE, threshold_twice: float = THRESHOLD_TWICE
    ) -> None:
        self.thresholds = Thresholds(
            threshold_once, threshold_twice, "drops of a dot product", least=ROUNDING
        )
        """Drops above which an edge is split once and twice; may be replaced at any time."""

    def bind(
        self,
        connectivity: Connectivity,
        rest_positions: Doubles,
        rest_normals: Floats,
    ) -> None:
        """Store the dot product of every edge of the undeformed mesh."""
        self._edges = connectivity.edges.view(np.uint32)
        self._rest_dots = np.empty(len(self._edges), dtype=np.float32)
        edge_dots(rest_normals, self._edges, self._rest_dots)
        # No direction to compare with at rest (all triangles around are slivers): never split.
        undefined = np.empty(len(rest_positions), dtype=np.bool_)
        find_undefined_normals(connectivity.faces, rest_positions, undefined)
        if undefined.any():
            self._rest_dots[undefined[connectivity.edges].any(axis=1)] = -np.inf

    def mark(self, positions: Doubles, normals: Floats, splits: Small) -> None:
        """Write the number of splits of every edge into `splits`, shape (E,)."""
        mark_drops(normals, self._edges, self._rest_dots, self.thresholds.limits, splits)

    def measure(self, positions: Doubles, normals: Floats, need: Floats) -> None:
        """Write the need of every edge, shape (E,)."""
        measure_drops(normals, self._edges, self._rest_dots, self.thresholds.limits, need)


@njit
def dot_along(normals: Floats, edges: Unsigned, e: int) -> np.float32:
    """The dot product of the normals at both ends of an edge."""
    a, b = edges[e, 0], edges[e, 1]
    return np.float32(
        normals[a, 0] * normals[b, 0]
        + normals[a, 1] * normals[b, 1]
        + normals[a, 2] * normals[b, 2]
    )


@njit
def edge_dots(normals: Floats, edges: Unsigned, dots: Floats) -> None:
    """Write the dot product of the normals at both ends of every edge into `dots`, shape (E,)."""
    for e in range(edges.shape[0]):
        dots[e] = dot_along(normals, edges, e)


@njit
def mark_drops(
    normals: Floats, edges: Unsigned, rest_dots: Floats, limits: Floats, splits: Small
) -> None:
    """Write 0, 1 or 2 into `splits`, shape (E,), by the drop of the dot product (as above).

    `edges`: end points, shape (E, 2); `limits`: the two thresholds, shape (2,).
    """
    once, twice = limits[0], limits[1]
    for e in range(edges.shape[0]):
        drop = rest_dots[e] - dot_along(normals, edges, e)
        splits[e] = np.uint8(drop > once) + np.uint8(drop > twice)


@njit
def measure_drops(
    normals: Floats, edges: Unsigned, rest_dots: Floats, limits: Floats, need: Floats
) -> None:
    """Write needs of edges, shape (E,), by the drop of the dot product (as above).

    `limits`: the two thresholds, shape (2,); need is 0 at the first, and 1 at the second (see
    `Thresholds`).
    """
    once, most = limits[0], INFINITE
    width = np.float32(max(np.float64(limits[1] - once), NARROWEST))
    if limits[1] == INFINITE:
        most = ONE
        width = once if ZERO < once < INFINITE else ONE
    for e in range(edges.shape[0]):
        drop = rest_dots[e] - dot_along(normals, edges, e)
        need[e] = min((drop - once) / width, most)


@njit
def find_undefined_normals(
    faces: Unsigned, positions: Doubles, undefined: npt.NDArray[np.bool_]
) -> None:
    """Flag the vertices, shape (V,), whose normal is nothing but rounding."""
    sums = np.zeros((positions.shape[0], 4))
    for t in range(faces.shape[0]):
        a, b, c = faces[t, 0], faces[t, 1], faces[t, 2]
        ux, vx = positions[b, 0] - positions[a, 0], positions[c, 0] - positions[a, 0]
        uy, vy = positions[b, 1] - positions[a, 1], positions[c, 1] - positions[a, 1]
        uz, vz = positions[b, 2] - positions[a, 2], positions[c, 2] - positions[a, 2]
        size = np.sqrt((ux * ux + uy * uy + uz * uz) * (vx * vx + vy * vy + vz * vz))
        for i in range(3):
            v = faces[t, i]
            sums[v, 0] += uy * vz - uz * vy
            sums[v, 1] += uz * vx - ux * vz
            sums[v, 2] += ux * vy - uy * vx
            sums[v, 3] += size
    for v in range(positions.shape[0]):
        length = np.sqrt(sums[v, 0] ** 2 + sums[v, 1] ** 2 + sums[v, 2] ** 2)
        undefined[v] = length <= UNDEFINED_NORMAL * sums[v, 3]
