"""The texture of a coarse head: red lips and brows lie where they lie on the dense head."""

import numpy as np
import pytest
import scipy

from risorius.assets.fitting import FittedHead, fit
from risorius.assets.fitting.landmark_file import nearest_vertices
from risorius.assets.fitting.painting import plain_picture, sampled
from risorius.assets.meshes import Mesh
from risorius.assets.pictures import MeshPictures
from risorius.bench.subjects import decimated
from risorius.geometry.closest import closest_points
from risorius.geometry.normals import cross_products

TRIANGLES = 900
BROWS = slice(17, 27)
LIPS = slice(48, 60)


def coarse(head, has_points) -> FittedHead:
    """Fit the built-in head with few triangles, and landmarks at exact points or on vertices."""
    vertices, faces = decimated(head.vertices, head.faces, TRIANGLES)
    true = head.vertices[head.landmarks]
    landmarks = nearest_vertices(true, vertices, faces)
    return fit(Mesh(vertices, faces), landmarks, points=true if has_points else None)


def differences(head, fitted, numbers):
    """Compare a coarse head with the dense one at points near some landmarks.

    Returns the mean difference in colour [0 to 255], and the share of points with another segment.
    """
    corners = fitted.vertices[fitted.faces]
    is_forward = cross_products(fitted.vertices, fitted.faces)[:, 2] > 0.0
    triangles = np.repeat(np.flatnonzero(is_forward), 60)
    weights = np.random.default_rng(0).dirichlet((1.0, 1.0, 1.0), len(triangles))
    points = np.einsum("nc,nci->ni", weights, corners[triangles])
    true = fitted.to_millimetres.points(head.vertices)
    is_near = scipy.spatial.cKDTree(true[head.landmarks[numbers]]).query(points)[0] < 9.0
    true_uv = closest_points(points[is_near], true, head.faces).interpolate(head.uv)
    corner_uv = fitted.uv[fitted.face_uv[triangles[is_near]]]
    uv = np.einsum("nc,nci->ni", weights[is_near], corner_uv)
    colours = sampled(plain_picture(head), true_uv).astype(float)
    off = np.abs(sampled(fitted.albedo, uv) - colours).mean()
    return off, (sampled(fitted.segments, uv) != sampled(head.segments, true_uv)).mean()


@pytest.mark.parametrize(
    ("has_points", "most_at_brows", "most_at_lips"),
    [pytest.param(False, 17.0, 7.0, marks=pytest.mark.slow), (True, 7.0, 5.0)],
)
def test_brows_and_lips_lie_at_their_places(head, has_points, most_at_brows, most_at_lips):
    """Brows and lips of a coarse head nearly have the colours and segments of the dense head."""
    fitted = coarse(head, has_points)
    at_brows, other_brows = differences(head, fitted, BROWS)
    at_lips, other_lips = differences(head, fitted, LIPS)
    assert at_brows < most_at_brows
    assert at_lips < most_at_lips
    assert other_brows < 0.15
    assert other_lips < 0.10


def test_maps_of_an_own_texture_are_as_exact(head):
    """A coarse head with a texture keeps it; red lips have their places in its maps."""
    vertices, faces = decimated(head.vertices, head.faces, TRIANGLES)
    true = head.vertices[head.landmarks]
    landmarks = nearest_vertices(true, vertices, faces)
    flat = fit(Mesh(vertices, faces), landmarks, points=true)
    assert np.array_equal(np.sort(flat.file_vertices), np.arange(len(vertices)))
    uv = np.empty((len(vertices), 2), np.float32)
    uv[flat.file_vertices] = flat.uv
    picture = np.full((64, 64, 3), 120, np.uint8)
    texture = MeshPictures(uv, faces, np.zeros(len(faces), np.int32), (lambda: picture,))
    fitted = fit(Mesh(vertices, faces, texture=texture), landmarks, points=true)
    assert np.array_equal(fitted.albedo, picture)
    assert differences(head, fitted, LIPS)[1] < 0.06
