"""The 27-entry table."""

import itertools

import pytest

from risorius.refine.kahler import table
from tests import meshes
from tests.refine.cases import (
    Forced,
    as_lists,
    assert_equals_twin,
    configuration_of,
    kahler,
    sound_frame,
)
from tests.refine.plain_twin import refine as refine_plainly

ALL_SPLITS = list(itertools.product(range(3), repeat=3))


@pytest.mark.parametrize("splits", ALL_SPLITS)
def test_rotation(splits):
    """A rotation of the corners' names rotates the subtriangles, and changes nothing else."""
    turned_splits = (splits[1], splits[2], splits[0])
    corner_names = [1, 2, 0]
    edge_point_names = [6, 7, 8, 9, 10, 11, 3, 4, 5]
    names = corner_names + edge_point_names
    renamed = [tuple(map(names.__getitem__, each)) for each in table.subdivide(turned_splits)]
    assert _as_set(renamed) == _as_set(table.subdivide(splits))


def _as_set(triangles):
    """The triangles, each from its least corner on."""
    return {min((a, b, c), (b, c, a), (c, a, b)) for a, b, c in triangles}


@pytest.mark.parametrize("splits", ALL_SPLITS)
def test_one_triangle(splits):
    """The refiner, given a single triangle, makes the pattern drawn by hand."""
    mesh = meshes.triangle()
    refiner = kahler(mesh, criterion=Forced(splits))
    refined = sound_frame(refiner, mesh.vertices)
    assert len(refined.triangles) == table.CONFIGURATION_TABLE.counts[configuration_of(splits)]
    named_splits = dict(zip([(0, 1), (1, 2), (0, 2)], splits, strict=True))
    twin = refine_plainly(*as_lists(mesh.vertices, mesh.faces), named_splits)
    assert_equals_twin(refiner, refined, twin)


def test_verification_can_fail():
    """The check at import detects a missing, a flipped and a wrong subtriangle."""
    good = table.subdivide((1, 1, 0))
    flipped = [(good[0][1], good[0][0], good[0][2]), *good[1:]]
    overlapping = [(0, 1, 2), *good[1:]]
    for wrong, text in (
        (good[:-1], "2 subtriangles, not 3"),
        (flipped, "without positive area"),
        (overlapping, "do not cover"),
    ):
        with pytest.raises(AssertionError, match=text):
            table.verify((1, 1, 0), wrong)
