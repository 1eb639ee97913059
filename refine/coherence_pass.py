"""What a triangle remembers: one number, moved on in every frame.

Kähler, Haber, Seidel 2003, section 4.4; the sequences and their tables are in coherence.py.
Neighbours may have come to their splits in different orders: they share the points along their
edge, so no crack can open.
"""

import numpy as np
import numpy.typing as npt

from .coherence import sequence_tables
from .native import Call, native
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
        self._removed = np.zeros(1, dtype=np.int64)

    @property
    def removals_out_of_order(self) -> int:
        """Splits taken back while a later one stayed, in all frames; each may turn lines."""
        return int(self._removed[0])

    def following(self, configurations: Numbers) -> Call:
        """Return the call that moves every triangle from its sequence to the next one.

        `configurations`: s0 + 3 s1 + 9 s2 of each triangle in the frame, shape (F,).
        """
        return follow_splits.bind(
            configurations,
            self._tables.transitions,
            self._tables.removals,
            self.states,
            self._removed,
        )

    def forget(self) -> None:
        """Take up the next frame as if it were the first: after a cut, or a jump in time."""
        self.states[:] = 0
        self._removed[:] = 0


@native
def follow_splits(
    configurations: Numbers,
    transitions: Numbers,
    removals: npt.NDArray[np.uint8],
    states: Numbers,
    removed: npt.NDArray[np.int64],
) -> None:
    """Replace every sequence in `states`, shape (F,), by the next one for its configuration.

    `removed`, shape (1,): goes up by the splits that were taken back out of order.
    """
    for t in range(states.shape[0]):
        if configurations[t] == 0:  # most triangles: nothing is left of what they remember
            states[t] = 0
            continue
        removed[0] += removals[states[t], configurations[t]]
        states[t] = transitions[states[t], configurations[t]]
