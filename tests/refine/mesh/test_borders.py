"""Border curves and their corners."""

import numpy as np
import pytest
from hypothesis import given, settings

from risorius import refine
from risorius.refine.mesh.borders import border_neighbours
from tests import meshes
from tests.refine.cases import as_lists, soups
from tests.refine.plain_schemes import is_corner
from tests.refine.plain_twin import Surroundings


@settings(max_examples=150, deadline=None)
@given(soups())
def test_soups(soup):
    """For random triangles, border neighbours equal those found with plain dictionaries."""
    positions, faces = soup
    found = border_neighbours(refine.connect(faces, len(positions)), positions)
    points, rows = as_lists(positions, faces)
    around = Surroundings(rows)
    for v, pair in enumerate(found.tolist()):
        ring = sorted(around.border_ring[v])
        if len(ring) == 2:
            before, after = (points[neighbour] for neighbour in ring)
            if is_corner(before, points[v], after):
                ring = []
        runs_on = len(ring) == 2
        assert sorted(pair) == (ring if runs_on else [v, v])


@pytest.mark.parametrize(("sides", "is_round"), [(4, False), (5, False), (6, True), (7, True)])
def test_corners(sides, is_round):
    """The border of a hexagon is round, a square's has corners; a slit has corners at its ends."""
    fan = meshes.fan(sides)
    found = border_neighbours(refine.connect(fan.faces, sides + 1), fan.vertices)
    assert (found[0] == 0).all()
    assert ((found[1:, 0] != found[1:, 1]) == is_round).all()
    slit = meshes.slit()
    found = border_neighbours(refine.connect(slit.faces, len(slit.vertices)), slit.vertices)
    x, y, _ = slit.vertices.T
    ends = np.flatnonzero((y == 0.0) & (abs(x) == 3.0))
    sides_of_slit = np.flatnonzero((y == 0.0) & (abs(x) < 3.0))
    assert (found[ends] == ends[:, None]).all()
    assert (abs(slit.vertices[found[sides_of_slit], 1]) == 0.0).all()
    assert (np.ptp(slit.vertices[found[sides_of_slit], 0], axis=1) == 2.0).all()
