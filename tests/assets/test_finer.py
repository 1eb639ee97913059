"""The finer meshes: the same head with more triangles, and the map from coarse to fine."""

from itertools import pairwise

import numpy as np
import pytest
from numpy.linalg import norm

from risorius.assets.model import FineMesh, Head
from risorius.assets.topology import boundary_loops, quarter
from risorius.geometry.directions import unit_vectors
from risorius.geometry.intersections import self_intersections
from risorius.geometry.normals import cross_products
from tests.assets import checks


@pytest.fixture(scope="module", params=[1, 2])
def fine(request: pytest.FixtureRequest, head: Head) -> FineMesh:
    """The finer meshes of the head, in order."""
    return head.finer(request.param)


def test_triangle_counts_are_powers_of_four(head):
    """Finer meshes have about 8 and 32 thousand triangles; each edge gives one new vertex."""
    assert [len(head.finer(level).faces) for level in (1, 2)] == [8120, 32480]
    edges = quarter(head.faces, len(head.vertices)).edges
    assert len(head.finer(1).vertices) == len(head.vertices) + len(edges)


def test_coarse_vertices_are_fine_vertices(head, fine):
    """Coarse vertices keep bits and numbers in the fine mesh; landmarks and rows stay valid."""
    count = len(head.vertices)
    assert np.array_equal(fine.vertices[:count], head.vertices)
    assert np.array_equal(np.unique(fine.faces), np.arange(len(fine.vertices)))


def test_map_reproduces_the_coarse_mesh(head, fine):
    """The map reproduces the coarse vertices exactly."""
    mapped = fine.interpolate(head.vertices)
    assert np.array_equal(mapped[: len(head.vertices)], head.vertices)
    number = fine.interpolate(np.arange(len(head.vertices), dtype=np.float64))
    assert np.array_equal(number[: len(head.vertices)], np.arange(len(head.vertices)))
    assert fine.interpolate(head.bone_depth).shape == (len(fine.vertices),)


def test_children_stand_in_the_place_of_their_parent(head, fine):
    """Face k of the fine mesh lies in face k / 4^level of the coarse mesh.

    It covers its part of the area.
    """
    share = len(fine.faces) // len(head.faces)
    flat = fine.interpolate(head.vertices)
    parent = np.repeat(cross_products(head.vertices, head.faces), share, axis=0) / share
    assert np.allclose(cross_products(flat, fine.faces), parent, atol=1e-9)


def test_each_level_comes_nearer_to_the_form(head):
    """With each level, the distance of new vertices from old triangles falls to about a quarter."""
    meshes = [(head.vertices, head.faces)]
    meshes += [(mesh.vertices, mesh.faces) for mesh in (head.finer(1), head.finer(2))]
    ways = []
    for (vertices, faces), (finer, _) in pairwise(meshes):
        middle = vertices[quarter(faces, len(vertices)).edges].mean(axis=1)
        way = norm(finer[len(vertices) :] - middle, axis=1)
        ways.append(float(np.sqrt((way**2).mean())))
    assert 0.1 < ways[0] < 1.5
    assert ways[1] < 0.4 * ways[0]


def test_finer_mesh_is_its_own_mirror_image(fine):
    """Mirrored vertices equal the vertices to the last bit."""
    mirrored = fine.vertices * [-1.0, 1.0, 1.0] + 0.0  # + 0.0: no negative zero
    assert np.array_equal(np.unique(mirrored, axis=0), np.unique(fine.vertices + 0.0, axis=0))


def test_finer_mesh_is_one_manifold_piece(head, fine):
    """A finer mesh has the topology of the coarse mesh, with the same holes."""
    assert checks.is_manifold(fine.faces)
    assert checks.component_count(fine.faces) == 1
    assert checks.euler_characteristic(fine.vertices, fine.faces) == (
        checks.euler_characteristic(head.vertices, head.faces)
    )


def test_no_triangle_is_turned_over(head, fine):
    """Every subtriangle faces nearly the same way as its parent."""
    cross = cross_products(fine.vertices, fine.faces)
    parent = np.repeat(
        cross_products(head.vertices, head.faces), len(fine.faces) // len(head.faces), axis=0
    )
    cosine = (cross * parent).sum(axis=1)
    cosine /= norm(cross, axis=1) * norm(parent, axis=1)
    assert cosine.min() > 0.1


def test_finer_mesh_does_not_cut_itself(fine):
    """A finer mesh does not intersect itself, although the lips nearly touch."""
    assert len(self_intersections(fine.vertices, fine.faces)) == 0


def test_boundaries_become_smooth(head):
    """With edges half as long, a boundary turns half as much from edge to edge."""

    def turns(vertices, faces):
        found = []
        for loop in boundary_loops(faces):
            along = np.diff(vertices[[*loop, loop[0]]], axis=0)
            along = unit_vectors(along)
            cosine = (along * np.roll(along, 1, axis=0)).sum(axis=1)
            angles = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
            found.append(float(np.median(angles)))
        return found

    coarse = turns(head.vertices, head.faces)
    fine = turns(head.finer(2).vertices, head.finer(2).faces)
    for before, after in zip(coarse, fine, strict=True):
        assert after < 0.5 * before


def test_normals_are_unit_and_agree_with_the_faces(fine):
    """Normals are those of the head's smooth form, or of the mesh where both differ."""
    assert np.allclose(norm(fine.normals, axis=1), 1.0)
    cross = cross_products(fine.vertices, fine.faces)
    total = np.zeros_like(fine.vertices)
    for corner in range(3):
        np.add.at(total, fine.faces[:, corner], cross)
    cosine = (total * fine.normals).sum(axis=1) / norm(total, axis=1)
    assert np.percentile(cosine, 1) > 0.8
    assert cosine.min() > 0.0


def test_other_levels_are_refused(head):
    """An invalid level is refused, and the message has the available levels."""
    for level in (0, 3):
        with pytest.raises(ValueError, match=rf"level was {level}; allowed are 1 .* and 2"):
            head.finer(level)
