"""The weights of Figs. 3 and 4, worked out by hand."""

import numpy as np

from risorius import refine
from risorius.refine.mesh.rings import warren_weight
from tests import meshes
from tests.refine.cases import Forced, kahler


def test_warren_weights():
    """Valence three is special; six is Loop's regular case with 1/16."""
    assert warren_weight(np.array([3, 4, 6])).tolist() == [3 / 16, 3 / 32, 1 / 16]


def test_first_level_by_hand():
    """One inner edge split once: 3/8, 3/8, 1/8, 1/8, and its ends follow the border rule."""
    mesh = meshes.two_triangles()
    connectivity = refine.connect(mesh.faces, 4)
    refiner = kahler(mesh, criterion=Forced(connectivity.around.is_interior))
    lifted = mesh.vertices + np.array([[0, 0, 0], [0, 0, 8], [0, 0, 16], [0, 0, 32]])
    refined = refiner.refine(lifted)
    assert refined.positions[4].tolist() == [0.5, 0.5, 3 + 6 + 4]
    assert refined.positions[1].tolist() == [0.75 + 0.125, 0.125, 6 + 4]
    assert refined.positions[0].tolist() == [0, 0, 0]
    assert refined.positions[3].tolist() == [1, 1, 32]


def test_second_level_by_hand():
    """The same edge split twice: quarter points lean on midpoints of edges that are not split."""
    mesh = meshes.two_triangles()
    connectivity = refine.connect(mesh.faces, 4)
    refiner = kahler(mesh, criterion=Forced(2 * connectivity.around.is_interior))
    lifted = mesh.vertices + np.array([[0, 0, 0], [0, 0, 64], [0, 0, 128], [0, 0, 256]])
    height = refiner.refine(lifted).positions[:, 2]
    a = 64.0
    b = 128.0
    c = 0.0
    d = 256.0
    m = 3 / 8 * (a + b) + 1 / 8 * (c + d)
    moved_a = 3 / 4 * a + (c + d) / 8
    moved_b = 3 / 4 * b + (c + d) / 8
    p = (a + c) / 2
    q = (b + c) / 2
    r = (a + d) / 2
    s = (b + d) / 2
    assert height[4] == 3 / 8 * (moved_a + m) + (p + r) / 8
    assert height[5] == 5 / 8 * m + (moved_a + moved_b + p + q + r + s) / 16
    assert height[6] == 3 / 8 * (moved_b + m) + (q + s) / 8
