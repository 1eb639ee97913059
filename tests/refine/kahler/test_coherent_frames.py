"""`coherent=True` through the whole refiner, frame after frame (section 4.4)."""

from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from risorius import refine
from tests import meshes
from tests.refine.cases import Forced, edge_count_of, kahler, sound_frame

Point = tuple[int, int, int]
"""A point of a refined mesh for life: ends of its edge, and quarters from the lower one."""
Line = tuple[int, Point, Point]
"""Input triangle and end points."""


def point_rows(refiner):
    """The row of each point on edges and corners in the last frame."""
    origins = refiner.origins()
    rows = {}
    for row, (vertices, weights) in enumerate(zip(origins.vertices, origins.weights, strict=True)):
        parts = sorted(
            (int(v), round(4.0 * float(w))) for v, w in zip(vertices, weights, strict=True) if w
        )
        first = parts[0][0]
        last = parts[-1][0]
        if len(parts) == 3:  # blending adds points in the middle of triangles
            rows[first, parts[1][0], -1 - last] = row
        else:
            rows.setdefault((first, last, parts[-1][1] if last != first else 0), row)
    return rows


def inner_lines(refiner, mesh):
    """The lines inside input triangles in the last frame."""
    names = {row: point for point, row in point_rows(refiner).items()}
    sides = Counter()
    for source, corners in zip(mesh.source.tolist(), mesh.triangles.tolist(), strict=True):
        for k in range(3):
            a, b = sorted((names[corners[k]], names[corners[(k + 1) % 3]]))
            sides[source, a, b] += 1
    return {line for line, count in sides.items() if count == 2}


def turned(before, now, rows):
    """Lines of the previous frame that are missing, although `rows` still has their ends."""
    missing = [
        (source, start, end) for source, start, end in before - now if start in rows and end in rows
    ]
    return sorted(missing)


def history_of(refiner):
    """The refiner's record of earlier splits."""
    assert isinstance(refiner, refine.Kahler)
    assert isinstance(refiner.cutting, refine.Coherent)
    return refiner.cutting


def turned_per_frame(refiner, frames):
    """The number of turned lines in each of `frames`, except the first."""
    counts = []
    before = None
    for positions in frames:
        now = inner_lines(refiner, refiner.refine(positions))
        if before is not None:
            counts.append(len(turned(before, now, point_rows(refiner))))
        before = now
    return counts


def growing(mesh, seed):
    """Positions of a deformation that grows from zero."""
    full = meshes.wrinkled(mesh, seed, 0.5) - mesh.vertices
    return [mesh.vertices + share * full for share in np.linspace(0.0, 1.0, 25)]


def splitting(mesh, seed):
    """A criterion that splits more and more edges at random, and the frames of this growth."""
    generator = np.random.default_rng(seed)
    edge_count = edge_count_of(mesh)
    criterion = Forced(np.zeros(edge_count))
    return criterion, [generator.random(edge_count) for _ in range(12)]


def played(mesh, criterion, chances):
    """Yield the unmoved mesh for each frame.

    Before each, a random fifth of the edges is split further.
    """
    for chance in chances:
        criterion.wanted = np.minimum(2, criterion.wanted + (chance < 0.2)).astype(np.uint8)
        yield mesh.vertices


@pytest.mark.parametrize("seed", range(4))
def test_geomorph_turns_no_line(seed):
    """While splits are only added, no line turns; with tables without history, many lines turn."""
    mesh = meshes.irregular(seed)
    counts = {}
    for is_coherent in (False, True):
        criterion, chances = splitting(mesh, seed)
        refiner = kahler(mesh, criterion=criterion, coherent=is_coherent)
        counts[is_coherent] = sum(turned_per_frame(refiner, played(mesh, criterion, chances)))
        if is_coherent:
            assert history_of(refiner).removals_out_of_order == 0
    assert counts[True] == 0
    assert counts[False] > 50


@settings(max_examples=25)
@given(seed=st.integers(0, 1000), history=st.lists(st.integers(0, 2**16), min_size=1, max_size=6))
def test_any_history_is_crack_free(seed, history):
    """After any splits, removed in any order, the mesh passes the checker."""
    mesh = meshes.irregular(seed % 20, 4, 4, 1)
    edge_count = edge_count_of(mesh)
    criterion = Forced(np.zeros(edge_count))
    refiner = kahler(mesh, criterion=criterion, coherent=True)
    for number in history:
        criterion.wanted = np.random.default_rng(number).integers(0, 3, edge_count, dtype=np.uint8)
        sound_frame(refiner, mesh.vertices)
        assert (refiner.splits == criterion.wanted).all()
    criterion.wanted = np.zeros(edge_count, dtype=np.uint8)
    assert len(refiner.refine(mesh.vertices).triangles) == len(mesh.faces)
    assert history_of(refiner).states.max() == 0


def test_states_contain_the_whole_history():
    """The states, one number per triangle, contain the whole history.

    A new refiner with these states makes the same frames.
    """
    mesh = meshes.irregular(3)
    frames = [*growing(mesh, 8), *growing(mesh, 9)[::-1]]
    old = kahler(mesh, coherent=True)
    for positions in frames[:30]:
        old.refine(positions)
    new = kahler(mesh, coherent=True)
    history_of(new).states = history_of(old).states
    for positions in frames[30:]:
        for ours, theirs in zip(old.refine(positions)[:4], new.refine(positions)[:4], strict=True):
            assert ours.tobytes() == theirs.tobytes()


def test_states_of_another_mesh_are_refused():
    """States of another mesh are refused, since compiled code indexes tables by them.

    They must be numbers of sequences, one per triangle.
    """
    history = history_of(kahler(meshes.irregular(3), coherent=True))
    count = len(history.states)
    for wrong in (np.zeros(count - 1, int), np.full(count, 271), np.full(count, -1), [0.5] * count):
        with pytest.raises(ValueError, match=r"integers from 0 to 270 of shape"):
            history.states = wrong
    with pytest.raises(ValueError, match="read-only"):
        history.states += 1
