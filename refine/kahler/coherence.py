r"""Time-coherent splitting: the 271 sequences of splits, and the transitions between them.

Kähler, Haber, Seidel 2003, section 4.4. The 27-entry table (table.py) takes only the number of
splits of each edge, not their order. So a new split may flip existing diagonals, and a flat shaded
triangle flickers. Here a triangle is split in the order in which its edges were split:

            2                   2                   2         the first split of an edge joins its
           / \                 /|\                 /|\        middle to the corner opposite; every
          /   \     edge 0    / | \     edge 1    / | 6       split after it halves the subtriangles
         /     \    ----->   /  |  \    ----->   /  |/ \      that lie on the halves of its edge
        0-------1           0---3---1           0---3---1

    sequence ()             (0,)                (0, 1)

A split only cuts subtriangles in two. So the triangulation of a sequence contains all inner lines
of every shorter sequence that it continues: no line ever flips.

Each edge can be split up to twice, which gives 271 sequences, from () to those of length six.
Between frames a triangle keeps only the number of its sequence. `transitions` lead from a sequence
and the wanted splits to the next sequence:

  - Splits that are taken back leave the sequence at its end. A split that is taken back while a
    later one stays is removed out of order: the sequence continues as if this split had never
    happened, and lines may flip. This cannot be avoided (see the paper); these removals are
    counted.
  - Splits that are added in the same frame have no order. They get the order with the shortest
    inner lines in an equilateral triangle; among equal orders, the first by edge numbers.

Differs from the paper: the paper keeps the history with the mesh, and we keep one number for each
triangle. Sequences with all edges split have no middle triangle, unlike entries of the table,
because no order of splits gives one. The tables are built in a tenth of a second, at their first
use.

Neighbours may have had their splits in different orders; they still share the points along their
edge, so no crack can open.
"""

import itertools
from dataclasses import dataclass
from functools import cache

import numpy as np
import numpy.typing as npt

from ...geometry.arrays import Unsigned8, Unsigned16
from ...geometry.read_only import read_only
from ...jit import njit
from ..mesh.connectivity import Connectivity
from .cutting import Cutting
from .frame import FrameBuffers
from .table import (
    CONFIGURATION_COUNT,
    MOST_SPLITS,
    POINT_COORDINATES,
    Patterns,
    Triangle,
    points_on,
    splits_of,
    table_of,
    verify,
)

SEQUENCE_COUNT = 271
"""Sequences of up to two splits on each of three edges (section 4.4)."""

Sequence = tuple[int, ...]


@dataclass(frozen=True)
class SequenceTables:
    """All data of the 271 sequences, as read-only arrays."""

    sequences: tuple[Sequence, ...]
    """The split edges of each sequence in order; number 0 is (), shorter sequences come first."""
    patterns: Patterns
    """Subtriangles of each sequence."""
    transitions: Unsigned16
    """Next sequence for each sequence and each wanted configuration, shape (271, 27)."""
    removals: Unsigned8
    """Number of splits that each such step takes back out of order, shape (271, 27)."""


@cache
def sequence_tables() -> SequenceTables:
    """Build all tables, once; every entry is verified as in the 27-entry table."""
    sequences = _all_sequences()
    assert len(sequences) == SEQUENCE_COUNT, f"{len(sequences)} sequences, not {SEQUENCE_COUNT}"
    number = {sequence: k for k, sequence in enumerate(sequences)}
    triangulations = [split_in_order(sequence) for sequence in sequences]
    for sequence, triangles in zip(sequences, triangulations, strict=True):
        verify(splits_in(sequence), triangles)

    transitions = np.zeros((SEQUENCE_COUNT, CONFIGURATION_COUNT), dtype=np.uint16)
    removals = np.zeros((SEQUENCE_COUNT, CONFIGURATION_COUNT), dtype=np.uint8)
    continued = _best_continuations(sequences)
    for k, sequence in enumerate(sequences):
        for configuration in range(CONFIGURATION_COUNT):
            wanted = splits_of(configuration)
            left, out_of_order = _taken_back(sequence, wanted)
            transitions[k, configuration] = number[continued[left, wanted]]
            removals[k, configuration] = out_of_order
    for array in (transitions, removals):
        array.flags.writeable = False
    return SequenceTables(sequences, table_of(triangulations), transitions, removals)


def split_in_order(sequence: Sequence) -> list[Triangle]:
    """Split the edges of a triangle one after the other, as often as `sequence` names them.

    Returns subtriangles of the 12 numbered points. Raises ValueError for a third split of an edge.
    """
    triangles: list[Triangle] = [(0, 1, 2)]
    for position, edge in enumerate(sequence):
        start = edge
        end = (edge + 1) % 3
        near_start, middle, near_end = points_on(edge)
        earlier = sequence[:position].count(edge)
        if earlier == 0:
            triangles = _cut_in_two(triangles, start, end, middle)
        elif earlier < MOST_SPLITS:
            triangles = _cut_in_two(triangles, start, middle, near_start)
            triangles = _cut_in_two(triangles, middle, end, near_end)
        else:
            raise ValueError(
                f"sequence {sequence} splits edge {edge} more than {MOST_SPLITS} times"
            )
    return triangles


def _cut_in_two(triangles: list[Triangle], start: int, end: int, point: int) -> list[Triangle]:
    """Cut the subtriangle with the side from start to end in two, at a point on this side."""
    result: list[Triangle] = []
    for triangle in triangles:
        if start in triangle and end in triangle:
            turn = triangle.index(start)
            a = triangle[turn]
            b = triangle[turn - 2]
            c = triangle[turn - 1]
            result += [(a, point, c), (point, b, c)]
        else:
            result.append(triangle)
    return result


def _all_sequences() -> tuple[Sequence, ...]:
    """Return all sequences with each edge up to twice, by length, then by edge numbers."""
    return tuple(
        sequence
        for length in range(3 * MOST_SPLITS + 1)
        for sequence in itertools.product(range(3), repeat=length)
        if max(splits_in(sequence)) <= MOST_SPLITS
    )


def splits_in(sequence: Sequence) -> tuple[int, int, int]:
    return sequence.count(0), sequence.count(1), sequence.count(2)


def _taken_back(sequence: Sequence, wanted: tuple[int, int, int]) -> tuple[Sequence, int]:
    """Remove the last splits of edges that are split too often.

    Returns the remaining sequence, and the number of removed splits that precede a remaining one.
    """
    surplus = [max(0, has - want) for has, want in zip(splits_in(sequence), wanted, strict=True)]
    left: list[int] = []
    out_of_order = 0
    for edge in reversed(sequence):
        if surplus[edge]:
            surplus[edge] -= 1
            out_of_order += bool(left)
        else:
            left.append(edge)
    return tuple(reversed(left)), out_of_order


def _best_continuations(
    sequences: tuple[Sequence, ...],
) -> dict[tuple[Sequence, tuple[int, int, int]], Sequence]:
    """Continue a sequence to a configuration with the shortest inner lines."""
    best: dict[tuple[Sequence, tuple[int, int, int]], tuple[float, Sequence]] = {}
    for sequence in sequences:
        candidate = (round(_length_of_inner_lines(sequence), 9), sequence)
        for length in range(len(sequence) + 1):
            key = sequence[:length], splits_in(sequence)
            best[key] = min(best.get(key, candidate), candidate)
    return {key: sequence for key, (_, sequence) in best.items()}


def _length_of_inner_lines(sequence: Sequence) -> float:
    """Return twice the length of lines inside an equilateral triangle, plus its constant border."""
    corners = POINT_COORDINATES[np.array(split_in_order(sequence))]
    u, v, w = np.moveaxis(corners - np.roll(corners, 1, axis=1), 2, 0)
    return float(np.sqrt(-(u * v + v * w + w * u)).sum())


class Coherent(Cutting):
    """Time-coherent cutting: looks up the triangles of one mesh by their sequences of splits."""

    has_memory = True

    def __init__(self) -> None:
        """Copy the tables; `bind` adds the triangles."""
        tables = sequence_tables()
        # Copies: compiled code takes writable arrays faster.
        self._steps = tables.transitions.copy(), tables.removals.copy()
        self.patterns = tables.patterns
        """A row for each sequence."""
        self.removals_out_of_order = 0
        """Splits taken back while a later one stayed, in all frames; each may flip lines."""

    def bind(self, connectivity: Connectivity, frame: FrameBuffers) -> Unsigned16:
        """Start with no split anywhere; return the sequence of each triangle, shape (F,)."""
        self._states: Unsigned16 = np.zeros(len(connectivity.faces), dtype=np.uint16)
        self._shown = read_only(self._states)
        return self._states

    @property
    def states(self) -> Unsigned16:
        """The sequence of each triangle, (F,), read only: the only state between frames.

        It may be set to the states of another refiner of the same mesh, to continue its sequences.
        Raises ValueError for other shapes and for numbers without a sequence.
        """
        return self._shown

    @states.setter
    def states(self, states: npt.ArrayLike) -> None:
        """Set the sequences to continue from; raises ValueError as above."""
        given = np.asarray(states)
        is_right = given.shape == self._states.shape and given.dtype.kind in "iu"
        if not is_right or ((given < 0) | (given >= SEQUENCE_COUNT)).any():
            raise ValueError(
                f"states must be integers from 0 to {SEQUENCE_COUNT - 1} of shape "
                f"{self._states.shape}, got {given.dtype} of shape {given.shape}"
            )
        self._states[:] = given

    def number(
        self, frame: FrameBuffers, vertex_count: int, triangle_count: int
    ) -> tuple[int, int]:
        """Move every triangle from its sequence to the next one; point numbers do not change."""
        removed = follow_splits(frame.configurations, *self._steps, self._states)
        self.removals_out_of_order += removed
        return vertex_count, triangle_count


@njit
def follow_splits(
    configurations: Unsigned16,
    transitions: Unsigned16,
    removals: Unsigned8,
    states: Unsigned16,
) -> int:
    """Replace every sequence in `states`, shape (F,), by the next one for its configuration.

    Returns how many splits were taken back out of order.
    """
    removed = 0
    for t in range(states.shape[0]):
        if configurations[t] == 0:  # most triangles: their sequence is ()
            states[t] = 0
            continue
        removed += int(removals[states[t], configurations[t]])
        states[t] = transitions[states[t], configurations[t]]
    return removed
