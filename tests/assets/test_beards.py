"""Hairs of stubble and beards: they stand on the skin, move with it, and turn grey."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree

from risorius.app.scenes import FaceScene
from risorius.assets.identities import (
    BEARD_NAME,
    coloured,
    colours_of_number,
    person_called,
    recoloured,
    sample_identity,
    wearing,
)
from risorius.assets.identities.complexion import GREY_LIGHT
from risorius.assets.identities.features import features_of
from risorius.assets.identities.locks import VERTEX_COUNT
from risorius.assets.identities.space import Sex
from risorius.assets.model import MASK_NAME, Segment
from risorius.geometry.closest import closest_points
from risorius.geometry.colour import to_screen
from tests.assets.checks import part_of
from tests.heads import person_of
from tests.sim.poses import advance

BEARDED = 91000180  # stubble of 0.8
FULLY_BEARDED = 91000162  # a beard of 12 mm


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
    advance(scene, 30, 1.0 / 30.0)
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


@pytest.fixture(scope="module")
def full():
    """A man with a full beard."""
    return person_called(FULLY_BEARDED)


def lengths_of(beard):
    """Distances from roots to tips [mm], (n,), and the roots [mm], (n, 3)."""
    hairs = beard.vertices.reshape(-1, VERTEX_COUNT, 3).astype(np.float64)
    return np.linalg.norm(hairs[:, -1] - hairs[:, 0], axis=1), hairs[:, 0]


def test_full_beards_are_long_at_the_chin_and_short_on_lip_and_neck(full):
    """Hairs of a full beard are as long as set at the chin, begin on the skin, and spare the neck.

    No beard was longer than 4 mm.
    """
    lengths, roots = lengths_of(beard_of(full))
    chin, mouth = (full.vertices[full.anatomy[name]] for name in ("menton", "stomion"))
    at_chin = np.linalg.norm(roots - chin, axis=1) < 15.0
    on_lip = (roots[:, 1] > mouth[1] + 3.0) & (np.abs(roots[:, 0]) < 20.0)
    assert at_chin.sum() > 100
    assert on_lip.sum() > 100
    assert np.median(lengths[at_chin]) == pytest.approx(12.0, abs=2.5)
    assert np.median(lengths[on_lip]) < 0.6 * np.median(lengths[at_chin])
    nearest = closest_points(roots, full.vertices, full.faces)
    off = np.linalg.norm(roots - nearest.interpolate(full.vertices), axis=1)
    assert np.percentile(off, 90.0) < 2.5
    assert roots[:, 1].min() > chin[1] - 30.0


def test_a_full_beard_follows_the_jaw(full):
    """Locks of the chin move with it, and keep their lengths."""
    scene = FaceScene(full)
    rest = beard_of(scene).vertices.copy()
    scene.pose({"jawOpen": 1.0})
    advance(scene, 30, 1.0 / 30.0)
    assert np.linalg.norm(beard_of(scene).vertices - rest, axis=1).max() > 15.0
    moved, _ = lengths_of(beard_of(scene))
    before, _ = lengths_of(beard_of(full))
    assert np.abs(moved / before - 1.0).max() < 0.5


def test_a_mask_presses_a_full_beard_flat(full):
    """Under a mask hairs are at most 3 mm long, and beside it they keep their lengths."""
    worn = wearing(full, shirt="red", cover="blue")
    cover = next(part for part in worn.parts if part.name == MASK_NAME).vertices
    lengths, roots = lengths_of(beard_of(worn))
    before, _ = lengths_of(beard_of(full))
    away = cKDTree(cover).query(roots)[0]
    assert lengths[away < 11.0].max() < 3.1
    # Stubble showed as dots on a mask that lies close to the chin.
    assert (lengths[away < 6.0] < 0.5 * away[away < 6.0] + 0.1).all()
    assert np.allclose(lengths[away > 13.0], before[away > 13.0], atol=1e-4)


def test_full_beards_have_their_class_also_in_small_pictures(full):
    """Chin and jaw below a full beard have its class; stubble is skin, as in FaceSynthetics."""
    count = (full.segments == Segment.FACIAL_HAIR).sum()
    assert 0.02 < count / full.segments.size < 0.2
    features = colours_of_number(sample_identity(FULLY_BEARDED), FULLY_BEARDED).features
    plain = person_of(FULLY_BEARDED)
    small = coloured(plain, angle=40.0, features=features, shrink=4)
    assert len(beard_of(small).vertices) == len(beard_of(full).vertices)
    assert (small.segments == Segment.FACIAL_HAIR).sum() == count
    assert not (person_called(BEARDED).segments == Segment.FACIAL_HAIR).any()


def test_a_fifth_of_men_wear_full_beards():
    """A quarter of men have stubble, a fifth full beards of 6 to 20 mm, and women neither."""
    identity = replace(sample_identity(FULLY_BEARDED), sex=Sex.MAN)
    drawn = [features_of(identity, 0.0, np.random.default_rng(seed)) for seed in range(400)]
    lengths = np.array([each.beard_length for each in drawn])
    is_full = lengths > 0.0
    assert is_full.mean() == pytest.approx(0.2, abs=0.06)
    assert 6.0 <= lengths[is_full].min() < 8.0 < 18.0 < lengths.max() <= 20.0
    has_stubble = np.array([each.stubble for each in drawn]) > 0.0
    assert (has_stubble & ~is_full).mean() == pytest.approx(0.25, abs=0.07)
    woman = replace(identity, sex=Sex.WOMAN)
    for seed in range(50):
        shaven = features_of(woman, 0.0, np.random.default_rng(seed))
        assert shaven.beard_length == shaven.stubble == 0.0
