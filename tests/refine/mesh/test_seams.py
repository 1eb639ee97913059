"""Texture seams: attributes differ on both sides, positions do not."""

import numpy as np
import pytest

from risorius import refine
from tests import meshes
from tests.refine.cases import sound_frame

REFINERS = [("none", {}), ("kahler", {}), ("loop", {"levels": 1}), ("loop", {"levels": 2})]


def bent_tube():
    """A tube and a deformation that creases it across the seam."""
    tube = meshes.tube(10, 6)
    deformed = tube.vertices.copy()
    deformed[:, 0] *= 1.0 + 0.4 * np.sin(4.0 * deformed[:, 2])
    deformed[:, 1] *= 1.0 + 0.5 * np.cos(3.0 * deformed[:, 2])
    return tube, deformed


@pytest.mark.parametrize(("name", "options"), REFINERS)
def test_same_geometry_as_without(name, options):
    """Texture coordinates change no position: the same unordered set of triangles results."""
    tube, deformed = bent_tube()
    with_uv = refine.create(
        name, tube.faces, tube.vertices, uv=tube.uv, face_uv=tube.face_uv, **options
    ).refine(deformed)
    without = refine.create(name, tube.faces, tube.vertices, **options).refine(deformed)
    assert without.uv is None
    for a, b in ((with_uv.positions, without.positions), (with_uv.normals, without.normals)):
        assert (a[with_uv.triangles] == b[without.triangles]).all()
    assert (with_uv.source == without.source).all()
    assert len(with_uv.positions) > len(without.positions)


def test_every_corner_its_own_coordinate():
    """If every corner has its own texture coordinate, all edges are seams and nothing cracks."""
    mesh = meshes.irregular(13)
    deformed = meshes.wrinkled(mesh, 14)
    face_uv = np.arange(mesh.faces.size).reshape(-1, 3)
    uv = np.random.default_rng(15).random((mesh.faces.size, 2))
    refiner = refine.create("kahler", mesh.faces, mesh.vertices, uv=uv, face_uv=face_uv)
    refined = sound_frame(refiner, deformed)
    assert (np.bincount(refined.triangles[refined.source == 0].ravel()) > 0).sum() >= 3
    owners = np.full(len(refined.positions), -1)
    owners[refined.triangles] = refined.source[:, None]
    assert (owners[refined.triangles] == refined.source[:, None]).all()


def test_unused_vertices_have_zero_coordinates():
    """Vertices without triangles have texture coordinates of zero."""
    mesh = meshes.with_debris()
    uv = np.ones((1, 2))
    for name, options in REFINERS:
        refined = refine.create(
            name, mesh.faces, mesh.vertices, uv=uv, face_uv=np.zeros_like(mesh.faces), **options
        ).refine(mesh.vertices)
        assert refined.uv[15].tolist() == [0, 0]
        assert refined.uv[0].tolist() == [1, 1]
