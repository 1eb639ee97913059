"""The weights of Figs. 3 and 4, compared with values computed by hand."""

import numpy as np

from risorius import refine
from risorius.refine.mesh.rings import warren_weight
from tests import meshes
from tests.refine.cases import Forced, kahler


def test_warren_weights():
    """Valence three has its own weight; valence six has Loop's regular weight of 1/16."""
    assert warren_weight(np.array([3, 4, 6])).tolist() == [3 / 16, 3 / 32, 1 / 16]


def refined_points(splits, heights):
    """Refined points of two triangles with vertices at these heights, whose inner edge is split."""
    mesh = meshes.two_triangles()
    is_interior = refine.connect(mesh.faces, 4).around.is_interior
    lifted = np.column_stack([mesh.vertices[:, :2], heights])
    return kahler(mesh, criterion=Forced(splits * is_interior)).refine(lifted).positions


def test_first_level_by_hand():
    """One inner edge is split once: weights 3/8, 3/8, 1/8, 1/8; its ends follow the border rule."""
    points = refined_points(1, [0, 8, 16, 32])
    assert points[4].tolist() == [0.5, 0.5, 3 + 6 + 4]
    assert points[1].tolist() == [0.75 + 0.125, 0.125, 6 + 4]
    assert points[0].tolist() == [0, 0, 0]
    assert points[3].tolist() == [1, 1, 32]


def test_second_level_by_hand():
    """The same edge is split twice: quarter points use midpoints of edges that are not split."""
    height = refined_points(2, [0, 64, 128, 256])[:, 2]
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
    ring = [moved_a, moved_b, p, q, r, s]
    assert height[5] == 5 / 8 * m + sum(ring) / 16
    assert height[6] == 3 / 8 * (moved_b + m) + (q + s) / 8
