"""Normals have length one or exactly zero, on any mesh."""

import numpy as np
import pytest

from risorius import refine
from tests import meshes
from tests.refine.cases import kahler

OPTIONS_OF_REFINERS = {
    "paper": {},
    "blended": {"blend": True},
    "cubic": {"scheme": "cubic"},
    "cubic, not blended": {"scheme": "cubic", "blend": False},
    "detail": {"scheme": "detail"},
    "detail, not blended": {"scheme": "detail", "blend": False},
}
SCALES = (1e-300, 1e-44, 1e-38, 1e-22, 1e-12, 3e-10, 1e-6, 1.0, 5e9, 5e13)
HEIGHT_FACTORS = (1.0, 1e-7, 1e-20, 0.0)


def lengths(normals):
    """Lengths of normals, shape (N,)."""
    return np.linalg.norm(normals.astype(np.float64), axis=1)


@pytest.mark.parametrize("name", OPTIONS_OF_REFINERS)
def test_unit_or_zero(name):
    """In tiny, huge and flattened meshes each normal has length one or zero, and all are finite."""
    mesh = meshes.irregular(3)
    options = dict(OPTIONS_OF_REFINERS[name])
    if options.get("scheme") == "detail":
        finer = refine.create("loop", mesh.faces, mesh.vertices).refine(mesh.vertices)
        options["scheme"] = refine.DetailScheme((finer.positions, finer.triangles))
    refiner = kahler(mesh, threshold_once=0.0, threshold_twice=0.01, **options)
    for scale in SCALES:
        for flattened in HEIGHT_FACTORS:
            deformed = scale * meshes.wrinkled(mesh, 2, 0.3) * [1.0, 1.0, flattened]
            refined = refiner.refine(deformed)
            found = lengths(refined.normals)
            assert np.isfinite(refined.positions).all()
            assert ((found == 0.0) | (abs(found - 1.0) < 2e-6)).all(), (scale, flattened)


@pytest.mark.parametrize("edge", [3e-10, 1e-6, 1.0, 5e9, 1e14])
def test_small_and_large_triangles_have_normals(edge):
    """A square's normals have the same direction for any length of edges."""
    square = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    refiner = refine.create("kahler", [[0, 1, 2], [2, 1, 3]], square)
    normals = refiner.refine(edge * square).normals
    np.testing.assert_allclose(normals, [[0, 0, 1]] * 4, rtol=0, atol=1e-6)
