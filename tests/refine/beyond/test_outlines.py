"""Outlines within a surface: rims that the scheme `cubic` rounds."""

from itertools import pairwise

import numpy as np
import pytest

from risorius import refine
from risorius.app.refining.presets import Refinement
from risorius.app.refining.refiners import refiner_for
from risorius.app.scenes import FaceScene
from risorius.assets.identities import person_called
from risorius.assets.loading import load

POINT_COUNT = 9


def pit():
    """Vertices and triangles of a tube with nine sides in a plane, whose rim is 0 to 8."""
    angles = np.linspace(0.0, 2.0 * np.pi, POINT_COUNT, endpoint=False)
    ring = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(POINT_COUNT)])
    vertices = np.vstack([ring, 2.0 * ring, 0.9 * ring - [0.0, 0.0, 1.0]])
    near = np.arange(POINT_COUNT)
    far = (np.arange(POINT_COUNT) + 1) % POINT_COUNT
    faces = [
        np.column_stack(each)
        for each in (
            (near, near + POINT_COUNT, far + POINT_COUNT),
            (near, far + POINT_COUNT, far),
            (near + 2 * POINT_COUNT, near, far),
            (near + 2 * POINT_COUNT, far, far + 2 * POINT_COUNT),
        )
    ]
    return vertices, np.vstack(faces).astype(np.int32)


def radii_between(refiner, positions, rim):
    """Distances from the rim's middle of the middles of its edges, of curves and of chords."""
    mesh = refiner.refine(positions)
    edges = np.sort(refiner.edges, axis=1).tolist()
    curves = []
    chords = []
    middle = positions[rim].mean(axis=0)
    for a, b in pairwise(rim[1:]):
        assert refiner.splits[edges.index(sorted((a, b)))] > 0
        chord = 0.5 * (positions[a] + positions[b])
        near = np.linalg.norm(mesh.positions - chord, axis=1)
        point = mesh.positions[near.argmin()]
        curves.append(np.linalg.norm(point - middle))
        chords.append(np.linalg.norm(chord - middle))
    return np.array(curves), np.array(chords)


def test_a_rim_is_nearly_a_circle():
    """Curves of a rim with nine sides stay within 1 % of its circle; their chords do not."""
    vertices, faces = pit()
    scheme = refine.CubicScheme(outlines=[[*range(POINT_COUNT), 0]])
    refiner = refine.create("kahler", faces, vertices, scheme=scheme, criterion="displacement")
    curves, chords = radii_between(refiner, vertices, [*range(POINT_COUNT)])
    assert np.abs(curves - 1.0).max() < 0.01
    assert chords.max() < 0.95


@pytest.mark.parametrize("person", [None, 19])
def test_nostrils_are_rounder_than_polygons(person):
    """Rims of nostrils are split, and lie at least 3 % outside their polygons."""
    scene = FaceScene(None if person is None else person_called(person))
    refiner = refiner_for(scene, Refinement())
    for side in ("left", "right"):
        rim = load("head").rings[f"nostril_{side}"].tolist()
        curves, chords = radii_between(refiner, scene.rest_positions, rim)
        assert (curves > 1.03 * chords).all()
