"""Gradients of texture coordinates on surfaces with a known answer."""

import numpy as np
from numpy.testing import assert_allclose

from risorius.geometry.gradients import TextureGradients
from tests.meshes import open_grid


def test_stretched_and_turned_sheet():
    """On a sheet stretched to twice its length the gradient is half as large, for any rotation."""
    sheet = open_grid(4, 3)
    vertices = sheet.vertices
    faces = sheet.faces.astype(np.int32)
    uv = (vertices[:, :2] / 10.0).astype(np.float32)
    gradients = TextureGradients(faces, uv, faces)
    turn = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]])
    found = gradients.measure((vertices * [2.0, 1.0, 1.0]) @ turn.T)
    wanted = np.concatenate([turn @ [0.05, 0.0, 0.0], turn @ [0.0, 0.1, 0.0]])
    assert_allclose(found, np.tile(wanted, (len(uv), 1)), atol=1e-6)


def test_flat_triangles_have_none():
    """A sheet that is folded to a line has finite gradients."""
    sheet = open_grid(2, 2)
    vertices = sheet.vertices
    faces = sheet.faces.astype(np.int32)
    gradients = TextureGradients(faces, vertices[:, :2].astype(np.float32), faces)
    assert not gradients.measure(vertices * [1.0, 0.0, 0.0]).any()
