"""`risorius bench coarse`: the refined coarse head compared with the form of the built-in head."""

import numpy as np
import pytest

from risorius.assets.coarse import coarse_head
from risorius.bench import coarse
from tests.app.command_line import succeeded


@pytest.fixture(scope="module")
def comparison():
    """The comparison with the built-in head in all poses."""
    return coarse.Comparison()


def numbers(*of_file):
    """Vertex indices of the coarse head for vertex indices of the built-in head."""
    return np.searchsorted(coarse_head().file_vertices, of_file).tolist()


def test_smooth_surface_is_nearer_than_triangles(comparison):
    """In each part of the face, cubic edges bring normals nearer to the built-in head's."""
    layout = coarse.layout()
    smooth = comparison.angles(layout)
    static = comparison.angles(layout, "static")
    for group in (*coarse.FREE_GROUPS, "chin", "nose", "lips"):
        assert smooth[group] < 0.85 * static[group], group
    assert smooth["eyelids"] < 18.5  # 20.5 with a bright wedge above the lid and dents below it
    assert smooth["face"] < 9.0  # 9.4 with a lump at the upper lip


@pytest.mark.parametrize("ends", [(24, 130), (333, 356), (19, 373), (162, 193)])
def test_edges_that_made_lumps_stay_flipped(comparison, ends):
    """Undoing a flip beside the upper lip, at the lids or at the jaw makes the normals worse."""
    layout = coarse.layout()
    back = coarse.with_flipped_edge(layout, *numbers(*ends))
    assert back is not None
    assert comparison.angles(back)["face"] > comparison.angles(layout)["face"] + 0.005


def test_flip_and_its_reverse():
    """An edge flipped twice gives the first triangles.

    Edges of lips and missing edges have no flip.
    """
    layout = coarse.layout()
    once = coarse.with_flipped_edge(layout, *numbers(24, 130))
    back = coarse.with_flipped_edge(once, *numbers(133, 136))
    sorted_rows = [np.unique(np.sort(each.triangles), axis=0) for each in (layout, once, back)]
    assert np.array_equal(sorted_rows[0], sorted_rows[2])
    assert not np.array_equal(sorted_rows[0], sorted_rows[1])
    assert coarse.with_flipped_edge(layout, *numbers(433, 465)) is None
    assert coarse.with_flipped_edge(layout, *numbers(133, 136)) is None


def test_command_prints_all_groups():
    """Each part of the layout has a line with the angles of the triangles and of two schemes."""
    printed = succeeded("bench", "coarse")
    for group in ("lips", "above the mouth", "eyelids", "nose", "face"):
        assert f"\n{group} " in printed
