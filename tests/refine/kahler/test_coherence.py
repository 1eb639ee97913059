"""Time-coherent splitting: the 271 sequences, their triangulations, and transitions."""

import itertools

import numpy as np
import pytest
from pytest import approx

from risorius import refine
from risorius.geometry.sides import side_lengths, sides_of
from risorius.refine.kahler import coherence, table
from risorius.refine.kahler.frame import buffers_for
from tests.refine.cases import configuration_of

TABLES = coherence.sequence_tables()
NUMBER_OF_SEQUENCE = {sequence: k for k, sequence in enumerate(TABLES.sequences)}
ALL_SPLITS = list(itertools.product(range(3), repeat=3))


def states_of(length):
    """Numbers of the sequences with this number of splits."""
    return [k for k, sequence in enumerate(TABLES.sequences) if len(sequence) == length]


def subtriangles_of(state):
    """Subtriangles of a sequence, shape (M, 3)."""
    return TABLES.patterns.subtriangles[state, : TABLES.patterns.counts[state]]


def inner_lines(state):
    """Sides of subtriangles inside the triangle, as pairs of points."""
    sides = {tuple(side) for side in sides_of(subtriangles_of(state)).tolist()}
    return {(a, b) for a, b in sides if a < b and (b, a) in sides}


def test_271_sequences():
    """There are 271 sequences (section 4.4); the test counts them by multinomials."""
    factorial = np.array([1, 1, 2, 6, 24, 120, 720])
    expected = sum(
        factorial[sum(splits)] // np.prod(factorial[list(splits)]) for splits in ALL_SPLITS
    )
    assert len(set(TABLES.sequences)) == coherence.SEQUENCE_COUNT == expected == 271
    assert TABLES.sequences[0] == ()
    assert max(map(len, TABLES.sequences)) == 6


@pytest.mark.parametrize("length", range(7))
def test_entries(length):
    """Every entry is a valid tessellation with as many subtriangles as in the 27-entry table."""
    for state in states_of(length):
        splits = coherence.splits_in(TABLES.sequences[state])
        triangles = subtriangles_of(state)
        table.verify(splits, [tuple(t) for t in triangles.tolist()])
        configuration = configuration_of(splits)
        assert len(triangles) == table.CONFIGURATION_TABLE.counts[configuration]
        areas = np.linalg.det(table.POINT_COORDINATES[triangles] / 4.0)
        assert (areas > 0.01).all()
        assert areas.sum() == approx(1.0, abs=1e-12)


@pytest.mark.parametrize("length", range(7))
def test_splitting_turns_no_line(length):
    """After any further split, every inner line stays, and no removal out of order is counted."""
    for state in states_of(length):
        has = coherence.splits_in(TABLES.sequences[state])
        for splits in ALL_SPLITS:
            if all(want >= had for want, had in zip(splits, has, strict=True)):
                configuration = configuration_of(splits)
                following = int(TABLES.transitions[state, configuration])
                assert TABLES.sequences[following][: sum(has)] == TABLES.sequences[state]
                assert coherence.splits_in(TABLES.sequences[following]) == splits
                assert inner_lines(state) <= inner_lines(following)
                assert TABLES.removals[state, configuration] == 0


@pytest.mark.parametrize("length", range(7))
def test_taking_back_in_reverse(length):
    """Removing the last splits of a sequence leads to its beginning.

    No removal out of order is counted.
    """
    for state in states_of(length):
        sequence = TABLES.sequences[state]
        for left in range(length):
            splits = coherence.splits_in(sequence[:left])
            configuration = configuration_of(splits)
            back = TABLES.transitions[state, configuration]
            assert TABLES.sequences[back] == sequence[:left]
            assert TABLES.removals[state, configuration] == 0


@pytest.mark.parametrize(
    ("sequence", "splits", "following", "removed"),
    [
        ((0, 1), (0, 1, 0), (1,), 1),
        ((0, 1), (1, 0, 0), (0,), 0),
        ((0, 1, 0), (1, 1, 0), (0, 1), 0),
        ((0, 1, 0), (0, 1, 0), (1,), 1),
        ((0, 0, 1, 1), (1, 1, 0), (0, 1), 1),
        ((0, 0, 1, 1), (0, 0, 1), (2,), 0),
        ((0, 1, 2), (0, 1, 2), (1, 2, 2), 1),
    ],
)
def test_transitions_by_hand(sequence, splits, following, removed):
    """Removals in order and out of order, alone and together with new splits."""
    state = NUMBER_OF_SEQUENCE[sequence]
    configuration = configuration_of(splits)
    assert TABLES.sequences[TABLES.transitions[state, configuration]] == following
    assert TABLES.removals[state, configuration] == removed


CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, np.sqrt(0.75)]])
"""Of an equilateral triangle."""


def length_of_lines(state):
    """Total length of the inner lines of a sequence."""
    places = table.POINT_COORDINATES / 4.0 @ CORNERS
    lines = np.array([*inner_lines(state)], int).reshape(-1, 2)
    return side_lengths(places, lines).sum()


@pytest.mark.parametrize("length", range(4))
def test_new_splits_make_the_shortest_lines(length):
    """New splits of one frame get the order with the shortest inner lines."""
    lengths = [length_of_lines(state) for state in range(len(TABLES.sequences))]
    for state in states_of(length):
        begun = TABLES.sequences[state]
        best = {}
        for other, sequence in enumerate(TABLES.sequences):
            if sequence[:length] == begun:
                key = configuration_of(coherence.splits_in(sequence))
                best[key] = min(best.get(key, np.inf), lengths[other])
        for configuration, shortest in best.items():
            taken = int(TABLES.transitions[state, configuration])
            assert lengths[taken] == approx(shortest, abs=1e-9)


def test_states_follow_the_tables():
    """The kernel changes all states by the tables, counts removals, and keeps its array."""
    generator = np.random.default_rng(1)
    face_count = 500
    points = np.zeros((3, 3))
    mesh = refine.connect(np.tile([0, 1, 2], (face_count, 1)), len(points))
    frame = buffers_for(mesh, points, points, points)
    coherent = refine.Coherent()
    rows = coherent.bind(mesh, frame)
    states = np.zeros(face_count, dtype=int)
    removed = 0
    for _ in range(12):
        wanted = generator.integers(0, 27, face_count)
        frame.configurations[:-1] = wanted
        assert coherent.number(frame, 4, 5) == (4, 5)
        removed += int(TABLES.removals[states, wanted].sum())
        states = TABLES.transitions[states, wanted]
        assert np.shares_memory(rows, coherent.states)
        assert (rows == states).all()
        assert (coherent.patterns.counts[rows] == table.CONFIGURATION_TABLE.counts[wanted]).all()
    assert coherent.removals_out_of_order == removed > 0
