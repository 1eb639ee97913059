"""The coarse head: one clean, symmetric piece made from vertices of the built-in head."""

import numpy as np
import pytest
import scipy
import trimesh

from risorius.assets.coarse import coarse_head
from risorius.assets.data_files import read_image
from risorius.assets.model import Segment
from risorius.assets.topology import boundary_loops
from risorius.geometry.intersections import self_intersections
from risorius.geometry.normals import cross_products
from tests.assets import checks


@pytest.fixture(scope="module")
def coarse():
    """The coarse head."""
    return coarse_head()


def test_coarse_head_has_a_quarter_of_the_triangles(coarse):
    """The coarse head has about 500 triangles, and every vertex is used."""
    assert 480 <= len(coarse.faces) <= 540
    assert np.array_equal(np.unique(coarse.faces), np.arange(len(coarse.vertices)))


def test_coarse_head_is_one_manifold_piece(coarse):
    """The coarse head has four holes: the rim of the neck, the mouth, and both eyes."""
    assert checks.is_manifold(coarse.faces)
    assert checks.component_count(coarse.faces) == 1
    assert checks.euler_characteristic(coarse.vertices, coarse.faces) == 2 - 4
    assert len(boundary_loops(coarse.faces)) == 4


def test_coarse_head_is_its_own_mirror_image(coarse):
    """Vertices and faces equal their mirror images to the last bit."""
    assert checks.mirror_error(coarse.vertices, coarse.mirror) == 0.0
    assert checks.is_mirrored(coarse.faces, coarse.mirror)


def test_coarse_triangles_are_sound(coarse):
    """No triangle is a sliver or crosses another.

    Every vertex has three to ten neighbours.
    """
    angles = np.degrees(trimesh.triangles.angles(coarse.vertices[coarse.faces]))
    assert angles.min() > 8.0
    assert np.percentile(angles.min(axis=1), 5) > 15.0
    edges = np.array(list(checks.edge_faces(coarse.faces)))
    neighbours = np.bincount(edges.ravel())
    assert neighbours.min() >= 3
    assert neighbours.max() <= 10
    assert len(self_intersections(coarse.vertices, coarse.faces)) == 0


def test_coarse_head_lies_on_the_built_in_one(coarse, head):
    """Vertices and landmarks are those of the built-in head, and faces lie near its surface."""
    assert np.array_equal(coarse.vertices, head.vertices[coarse.file_vertices])
    marked = coarse.vertices[coarse.landmarks]
    assert np.array_equal(marked, head.vertices[head.landmarks])
    middles = coarse.vertices[coarse.faces].mean(axis=1)
    fine = head.finer(1).vertices
    distance = scipy.spatial.cKDTree(fine).query(middles)[0]
    assert distance.max() < 15.0
    assert np.median(distance) < 3.0


def test_roots_of_lashes_lie_below_the_edge_of_the_lid(coarse, head):
    """The dark line of the roots lies on the margin of the upper lid, not on its front.

    Otherwise a shut lid would have a dark hook at its outer corner.
    """
    roots = read_image(head.file_beside("_lids.png"), mode="L") / 255.0
    in_front = (384, int(head.mirror[384]))  # on the front of each lid, above its outer corner
    is_front = np.isin(coarse.file_vertices[coarse.faces], in_front).any(axis=1)
    first, second = np.meshgrid(*[np.linspace(0.0, 1.0, 30)] * 2)
    shares = np.stack([first, second, 1.0 - first - second], axis=-1)[first + second <= 1.0]
    u, v = np.moveaxis(shares @ coarse.uv[coarse.faces[is_front]], -1, 0)
    rows = ((1.0 - v) * len(roots)).astype(int)
    columns = (u * len(roots)).astype(int)
    dark = roots[rows, columns]
    assert len(dark) >= 12
    assert dark.mean(axis=1).max() < 0.06


def test_coarse_triangles_look_outward(coarse, head):
    """Each face has the direction of the built-in head's normals at its corners.

    The ears are left out, because they are sheets.
    """
    corners = coarse.file_vertices[coarse.faces]
    fine = np.zeros_like(head.vertices)
    for corner in range(3):
        np.add.at(fine, head.faces[:, corner], cross_products(head.vertices, head.faces))
    facing = cross_products(coarse.vertices, coarse.faces)
    agreeing = (facing * fine[corners].sum(axis=1)).sum(axis=1)
    is_before_ears = coarse.vertices[coarse.faces][:, :, 2].min(axis=1) > 10.0
    assert is_before_ears.sum() > 300
    assert agreeing[is_before_ears].min() > 0.0


def test_no_triangle_of_the_neck_shows_hair(coarse):
    """A triangle whose corners are skin of the neck shows no hair between them."""
    is_nape = (coarse.vertices[:, 1] < -80.0) & (coarse.vertices[:, 2] < 0.0)
    height, width = coarse.segments.shape
    weights = np.random.default_rng(0).dirichlet([1.0, 1.0, 1.0], 40)
    rows = np.flatnonzero(is_nape[coarse.faces].all(axis=1))
    assert len(rows) >= 4
    for corners in coarse.uv[coarse.face_uv[rows]]:
        u, v = (weights @ corners).T
        texels = ((1.0 - v) * height).astype(int), (u * width).astype(int)
        assert not (coarse.segments[texels] == Segment.HAIR).any()
