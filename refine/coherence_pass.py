"""What a triangle remembers: one number, moved on in every frame.

Kähler, Haber, Seidel 2003, section 4.4; the sequences and their tables are in coherence.py.
Neighbours may have come to their splits in different orders: they share the points along their
edge, so no crack can open.
"""

import numpy as np
import numpy.typing as npt

from ..jit import njit
from .coherence import sequence_tables
from .patterns import Patterns

Numbers = npt.NDArray[np.uint16]


class Coherent:
    """Table rows by sequence of splits, for the triangles of one mesh."""

    def __init__(self, face_count: int) -> None:
        """Start with no split anywhere in `face_count` triangles."""
        self._tables = sequence_tables()
        self.patterns = Patterns(self._tables.subtriangle_counts, self._tables.subtriangles)
        """A row for each sequence."""
        self.states: Numbers = np.zeros(face_count, dtype=np.uint16)
        """The sequence of each triangle, shape (F,): all that lives from frame to frame."""
        self.removals_out_of_order = 0
        """Splits taken back while a later one stayed, in all frames; each may turn lines."""

    def follow(self, configurations: Numbers) -> Numbers:
        """Move every triangle from its sequence to the next one; return these, shape (F,).

        `configurations`: s0 + 3 s1 + 9 s2 of each triangle in the frame, shape (F + 1,).
        """
        tables = self._tables
        self.removals_out_of_order += follow_splits(
            configurations, tables.transitions, tables.removals, self.states
        )
        return self.states

    def forget(self) -> None:
        """Take up the next frame as if it were the first: after a cut, or a jump in time."""
        self.states[:] = 0
        self.removals_out_of_order = 0


@njit
def follow_splits(
    configurations: Numbers,
    transitions: Numbers,
    removals: npt.NDArray[np.uint8],
    states: Numbers,
) -> int:
    """Replace every sequence in `states`, shape (F,), by the next one for its configuration.

    Returns how many splits were taken back out of order.
    """
    removed = 0
    for t in range(states.shape[0]):
        if configurations[t] == 0:  # most triangles: nothing is left of what they remember
            states[t] = 0
            continue
        removed += int(removals[states[t], configurations[t]])
        states[t] = transitions[states[t], configurations[t]]
    return removed
