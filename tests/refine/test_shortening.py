"""Shortening along given directions: known strains, rigid motion, bends, invalid input."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from risorius import refine
from tests import meshes

ALONG_AXIS = (1.0, 0.0, 0.0)
ACROSS_AXIS = (0.0, 1.0, 0.0)


def grid(count=9):
    """Triangles and vertices of a flat square grid with sides of 10."""
    mesh = meshes.open_grid(count - 1, count - 1)
    return mesh.faces, mesh.vertices * (10.0 / (count - 1)) - [5.0, 5.0, 0.0]


def both_ways(count):
    """Directions along x and along y, at every vertex."""
    return np.tile([ALONG_AXIS, ACROSS_AXIS], (count, 1, 1))


def test_at_rest_there_is_none():
    """At rest the shortening is exactly zero, on an irregular mesh."""
    mesh = meshes.irregular(3)
    directions = np.random.default_rng(3).normal(size=(len(mesh.vertices), 2, 3))
    measured = refine.Shortening(mesh.faces, mesh.vertices, directions).measure(mesh.vertices)
    assert (measured == 0.0).all()


def test_a_squeeze_is_found_along_its_direction_alone():
    """A grid a fifth shorter along x and a tenth longer along y gives 0.2 and -0.1."""
    faces, rest = grid()
    shortening = refine.Shortening(faces, rest, both_ways(len(rest)))
    measured = shortening.measure(rest * [0.8, 1.1, 1.0])
    assert_allclose(measured[:, 0], 0.2, atol=1e-5)
    assert_allclose(measured[:, 1], -0.1, atol=1e-5)


def test_rigid_motions_and_bends_shorten_nothing():
    """A turned grid does not shorten.

    A rolled grid shortens by less than the chords of its finest triangles.
    """
    faces, rest = grid(41)
    shortening = refine.Shortening(faces, rest, both_ways(len(rest)))
    turned = Rotation.from_euler("xyz", [0.3, -1.2, 2.0]).apply(rest + 300.0)
    assert np.abs(shortening.measure(turned)).max() < 1e-5
    radius = 4.0
    angle = rest[:, 0] / radius
    rolled = np.stack([radius * np.sin(angle), rest[:, 1], radius * np.cos(angle)], axis=1)
    assert np.abs(shortening.measure(rolled)).max() < 1e-3


def test_finds_the_largest_compression():
    """Along its direction of smallest stretch, a flat deformation shortens by 1 - this stretch."""
    faces, rest = grid()
    gradient = np.array([[0.9, 0.15, 0.0], [-0.05, 0.75, 0.0], [0.0, 0.0, 1.0]])
    stretches, ways = np.linalg.svd(gradient[:2, :2])[1:]
    directions = np.tile([[*ways[1], 0.0]], (len(rest), 1, 1))
    now = rest @ gradient.T
    measured = refine.Shortening(faces, rest, directions).measure(now)[:, 0]
    assert_allclose(measured, 1.0 - stretches[1], atol=1e-5)


def test_what_does_not_fit_is_refused():
    """Directions or positions of a wrong shape, and directions with NaN, are refused."""
    faces, rest = grid(3)
    for directions in (np.zeros((len(rest), 3)), np.full((len(rest), 1, 3), np.nan)):
        with pytest.raises(ValueError, match="directions must be finite"):
            refine.Shortening(faces, rest, directions)
    with pytest.raises(ValueError, match="positions must be floats of shape"):
        refine.Shortening(faces, rest, both_ways(len(rest))).measure(rest[:-1])
