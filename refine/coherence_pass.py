"""Subtriangles of a frame that remember: the look-up of output.py, by sequence of splits.

Kähler, Haber, Seidel 2003, section 4.4; the tables and what they mean are in coherence.py. Each
triangle keeps the number of its sequence in `states` and nothing else. Neighbours may have come to
their splits in different orders: they share points along their edge, so no crack can open.
"""

import numpy as np
import numpy.typing as npt

from .coherence import sequence_tables
from .kernels import kernel

Unsigned = npt.NDArray[np.uint32]
Small = npt.NDArray[np.uint8]


class SplitHistory:
    """The sequences that the triangles of one mesh are in, and how orderly they got there."""

    def __init__(self, triangle_count: int) -> None:
        """Start with no split anywhere."""
        self.tables = sequence_tables()
        self.states = np.zeros(triangle_count, dtype=np.uint16)
        self.removed_out_of_order = 0
        """Splits taken back while a later one stayed, since the start; each may turn lines."""

    def forget(self) -> None:
        """Take up the next frame as if it were the first: after a cut, or a jump in time."""
        self.states[:] = 0
        self.removed_out_of_order = 0

    def look_up_triangles(
        self,
        corners: Unsigned,
        triangle_rims: Unsigned,
        rim_splits: Small,
        first_points: Unsigned,
        triangles: Unsigned,
        source: npt.NDArray[np.int32],
    ) -> int:
        """Move every triangle to its next sequence and write its subtriangles; return how many."""
        tables = self.tables
        count, removed = follow_splits(
            corners,
            triangle_rims,
            rim_splits,
            first_points,
            tables.transitions,
            tables.removals,
            tables.subtriangle_counts,
            tables.subtriangles,
            self.states,
            triangles,
            source,
        )
        self.removed_out_of_order += removed
        return count


@kernel
def follow_splits(
    corners: Unsigned,
    triangle_rims: Unsigned,
    rim_splits: Small,
    first_points: Unsigned,
    transitions: npt.NDArray[np.uint16],
    removals: Small,
    subtriangle_counts: Small,
    subtriangles: Small,
    states: npt.NDArray[np.uint16],
    triangles: Unsigned,
    source: npt.NDArray[np.int32],
) -> tuple[int, int]:
    """Move every triangle to its next sequence and write its subtriangles.

    Returns how many subtriangles there are, and how many splits were taken back out of order.
    """
    points = np.empty(12, np.uint32)
    count = removed = 0
    for t in range(corners.shape[0]):
        configuration, place_value = 0, 1
        for i in range(3):
            configuration += place_value * rim_splits[triangle_rims[t, i] >> 1]
            place_value *= 3
        # Most triangles are not split: nothing is left of what they remember.
        if configuration == 0:
            for i in range(3):
                triangles[count, i] = corners[t, i]
            source[count] = t
            states[t] = 0
            count += 1
            continue
        removed += removals[states[t], configuration]
        state = transitions[states[t], configuration]
        states[t] = state
        # The 12 numbered points; those of edges that are not split are never looked up.
        for i in range(3):
            rim, against = triangle_rims[t, i] >> 1, triangle_rims[t, i] & 1
            first = first_points[rim]
            points[i] = corners[t, i]
            points[3 + 3 * i] = first + (rim_splits[rim] >> 1)  # the only point, or the second
            points[4 + 3 * i] = first + 2 * against
            points[5 + 3 * i] = first + 2 - 2 * against
        for k in range(subtriangle_counts[state]):
            for i in range(3):
                triangles[count, i] = points[subtriangles[state, k, i]]
            source[count] = t
            count += 1
    return count, removed
