"""Edges, neighbourhoods, wedges and attribute edges."""

import numpy as np
import pytest
from hypothesis import given, settings

from risorius import refine
from tests import meshes
from tests.refine.cases import as_lists, soups
from tests.refine.plain_twin import Surroundings, edge_name, edge_names, is_proper


@settings(max_examples=150, deadline=None)
@given(soups())
def test_soups(soup):
    """For random triangles, edges and neighbourhoods equal those found with plain dictionaries."""
    positions, faces = soup
    connectivity = refine.connect(faces, len(positions))
    _, rows = as_lists(positions, faces)
    around = Surroundings(rows)
    names = [edge_name(a, b) for a, b in connectivity.edges]
    assert len(set(names)) == len(names)
    assert set(names) == set(around.opposite)
    inner = {
        name for name, is_in in zip(names, connectivity.around.is_interior, strict=True) if is_in
    }
    assert inner == around.inner
    for e in np.flatnonzero(connectivity.around.is_interior):
        a, b, c, d = (int(v) for v in connectivity.around.points[e])
        assert sorted((c, d)) == sorted(around.opposite[names[e]])
        wings = [names[w] for w in connectivity.around.wings[e]]
        assert wings == [edge_name(*ends) for ends in ((a, c), (b, c), (a, d), (b, d))]
    for face, edges in zip(rows, connectivity.triangle_edges, strict=True):
        if is_proper(face):
            assert [names[e] for e in edges] == edge_names(face)
        else:
            assert (edges == -1).all()


def test_wedges_of_tube():
    """A seam of five vertices and four edges duplicates exactly these vertices and edges."""
    tube = meshes.tube(segments=8, rings=4)
    connectivity = refine.connect(tube.faces, len(tube.vertices), tube.face_uv)
    assert len(connectivity.wedge_vertices) == len(tube.vertices) + 5
    assert len(connectivity.attribute_edges) == len(connectivity.edges) + 4
    assert connectivity.wedge_vertices[: len(tube.vertices)].tolist() == list(range(40))
    assert (connectivity.wedge_vertices[connectivity.corners] == tube.faces).all()
    assert (connectivity.wedge_uv[connectivity.corners] == tube.face_uv).all()


def test_weld():
    """A mesh with doubled vertices along its seam becomes closed; its texture coordinates stay."""
    tube = meshes.tube(segments=6, rings=2)
    assert tube.uv is not None
    assert tube.face_uv is not None
    vertex_of_uv = np.zeros(len(tube.uv), dtype=int)
    vertex_of_uv[tube.face_uv] = tube.faces
    doubled = tube.vertices[vertex_of_uv]
    doubled[1::2][doubled[1::2] == 0.0] = -0.0  # equal to 0.0, but with other bits
    kept, faces = refine.weld(doubled, tube.face_uv)
    assert len(kept) == len(tube.vertices)
    assert (doubled[kept][faces] == tube.vertices[tube.faces]).all()
    connectivity = refine.connect(faces, len(kept), tube.face_uv)
    assert (~connectivity.around.is_interior).sum() == 2 * 6


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (([[0, 1, 4]], 4), r"from 0 to 3 into the vertices, but triangle 0 is \[0, 1, 4\]"),
        (([[0, 1, 2]], 2**40), "vertex_count must be a whole number from 0 to 2147483647, got 10"),
        (([[0, 1, 2]], "x"), "vertex_count must be a whole number .* got 'x'"),
        (([[0, 1, -1]], 4), r"triangle 0 is \[0, 1, -1\]"),
        (([[0.0, 1.0, 2.0]], 4), "faces must be integers .* got float64"),
        (([0, 1, 2], 4), r"shape \(F, 3\), got int64 of shape \(3,\)"),
        (([[0, 1, 2]], 4, [[0, 1, 2]] * 2), r"face_uv must have one row per triangle \(1\), got 2"),
        (([[0, 1, 2]], 4, [[0, -1, 2]]), r"into the texture coordinates, but triangle 0 is"),
    ],
)
def test_bad_triangles(arguments, text):
    """Indices out of range are refused before compiled code uses them."""
    with pytest.raises(ValueError, match=text):
        refine.connect(*arguments)


@pytest.mark.parametrize(
    ("positions", "faces", "text"),
    [
        (np.zeros(9), [[0, 1, 2]], r"positions must be numbers of shape \(V, 3\)"),
        (np.full((3, 3), np.nan), [[0, 1, 2]], "positions must be finite"),
        (np.eye(3), [[0, 1, 3]], "from 0 to 2 into positions, but triangle 0 is"),
        (np.eye(3), [[0, 1, -1]], "triangle 0 is"),
    ],
)
def test_bad_welds(positions, faces, text):
    """Invalid welds are refused; an index of -1 does not mean the last vertex."""
    with pytest.raises(ValueError, match=text):
        refine.weld(positions, faces)
