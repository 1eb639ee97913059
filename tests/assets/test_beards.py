"""Hairs of stubble and beards: they stand on the skin, move with it, and turn grey."""

from dataclasses import replace

import numpy as np
import pytest

from risorius.app.scenes import FaceScene
from risorius.assets.identities import (
    BEARD_NAME,
    coloured,
    colours_of_number,
    person_called,
    recoloured,
    sample_identity,
)
from risorius.assets.identities.complexion import GREY_LIGHT
from risorius.assets.identities.locks import VERTEX_COUNT
from risorius.geometry.closest import closest_points
from risorius.geometry.colour import to_screen
from tests.assets.checks import part_of
from tests.heads import person_of

BEARDED = 91000162  # stubble of 0.7


def beard_of(head):
    """The part of a person's beard."""
    return part_of(head, BEARD_NAME)


@pytest.fixture(scope="module")
def person():
    """A man with a beard."""
    return person_called(BEARDED)


def test_hairs_of_a_beard_begin_on_the_skin(person):
    """Roots lie on the skin below the nose, and tips stand off it; stubble was only painted.

    The triangles are flatter than the refined skin that is drawn. One hair in six once stood at the
    nape.
    """
    beard = beard_of(person)
    hairs = beard.vertices.reshape(-1, VERTEX_COUNT, 3).astype(np.float64)
    assert len(hairs) > 800
    assert hairs[..., 1].max() < person.vertices[person.anatomy["subnasale"], 1] + 45.0
    assert hairs[..., 2].min() > person.vertices[person.landmarks[[0, 16]], 2].min() - 25.0
    ends = []
    for points in (hairs[:, 0], hairs[:, -1]):
        nearest = closest_points(points, person.vertices, person.faces)
        ends.append(np.linalg.norm(points - nearest.interpolate(person.vertices), axis=1))
    assert np.median(ends[0]) < 0.8
    assert np.percentile(ends[0], 90.0) < 2.5
    assert np.median(ends[1]) > np.median(ends[0]) + 0.3
    assert ends[1].max() < 6.0


def test_a_beard_follows_the_jaw(person):
    """Hairs of the chin move with it, and no hair changes its length by half."""
    scene = FaceScene(person)
    rest = beard_of(scene).vertices.copy()
    scene.pose({"jawOpen": 1.0})
    for _ in range(30):
        scene.step(1.0 / 30.0)
    moved = beard_of(scene).vertices
    assert np.linalg.norm(moved - rest, axis=1).max() > 15.0
    lengths = []
    for vertices in (rest, moved):
        hairs = vertices.reshape(-1, VERTEX_COUNT, 3)
        lengths.append(np.linalg.norm(hairs[:, -1] - hairs[:, 0], axis=1))
    assert np.abs(lengths[1] / lengths[0] - 1.0).max() < 0.5


def test_exports_have_no_hairs_of_beards(person):
    """Files of morph targets would be twice as large; the texture shows stubble, too."""
    scene = FaceScene(person)
    assert len(scene.exported_parts) == len(scene.parts) - 1
    assert BEARD_NAME not in {part.name for part in scene.exported_parts}


def test_women_and_small_pictures_have_no_hairs_of_beards():
    """Pictures with small textures do not show hairs."""
    assert all(part.name != BEARD_NAME for part in person_called(11).parts)
    features = colours_of_number(sample_identity(BEARDED), BEARDED).features
    small = coloured(person_of(BEARDED), angle=40.0, features=features, shrink=4)
    assert all(part.name != BEARD_NAME for part in small.parts)


def test_beards_turn_grey_like_hair():
    """Painted stubble of a man with grey hair is grey; it was as dark as his brows.

    Hairs are either grey or have the colour of young hair.
    """
    features = colours_of_number(sample_identity(BEARDED), BEARDED).features
    pictures = [
        recoloured(0.0, features=replace(features, grey=grey, stubble=1.0)).astype(np.float64)
        for grey in (0.0, 0.95)
    ]
    chin = np.s_[1000:1060, 560:720]
    young, old = (each[chin].mean() for each in pictures)
    assert old > young + 8.0
    person = person_of(BEARDED)
    beard = beard_of(coloured(person, angle=40.0, features=replace(features, grey=0.5)))
    tones = beard.colours[VERTEX_COUNT - 1 :: VERTEX_COUNT].mean(axis=1)
    middle = 0.5 * (tones.min() + tones.max())
    assert 0.3 < (tones > middle).mean() < 0.7
    assert tones[tones > middle].mean() == pytest.approx(to_screen(GREY_LIGHT).mean(), abs=0.15)
