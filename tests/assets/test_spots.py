"""Moles, freckles and age spots of persons."""

import numpy as np
import pytest

from risorius.assets.identities.spots import FEATURES, Spot, add_spots, drawn_spots

LEVEL = 160  # of the skin in plain pictures


def plain(size):
    """A picture of even skin."""
    return np.full((size, size, 3), LEVEL, np.uint8)


def counts(age, angle):
    """Numbers of spots of 60 persons."""
    return np.array([len(drawn_spots(age, angle, np.random.default_rng(n))) for n in range(60)])


def test_spots_follow_tone_and_age():
    """Freckles are on fair skin only, age spots on old skin, papules on dark skin past 30."""
    many = 25
    assert 10 < (counts(25.0, 60.0) > many).sum() < 45
    assert (counts(25.0, 30.0) < many).all()
    assert counts(75.0, 30.0).mean() > counts(25.0, 30.0).mean() + 2.0
    assert counts(60.0, -40.0).mean() > counts(25.0, -40.0).mean() + 2.0
    assert 1.0 < counts(25.0, 30.0).mean() < 5.0


def test_a_number_always_gives_the_same_spots():
    """The same random numbers give the same spots, other ones give others."""
    first, again, other = (drawn_spots(40.0, 50.0, np.random.default_rng(n)) for n in (5, 5, 6))
    assert first == again != other


def test_no_spot_is_on_eyes_or_lips():
    """The middle of each spot is outside of the eyes, the lips and the nostrils."""
    for number in range(40):
        for spot in drawn_spots(70.0, 60.0, np.random.default_rng(number)):
            for u, v, wide, high in FEATURES:
                across = (abs(spot.u - 0.5) - u) / wide
                assert across**2 + ((spot.v - v) / high) ** 2 >= 1.0


def test_a_spot_darkens_its_own_place_only():
    """A spot is darkest and brown in its middle; other skin keeps its bytes."""
    picture = plain(1280)
    spot = Spot(0.6, 0.4, radius=2.0, stretch=0.8, turn=0.7, melanin=1.0, softness=0.4)
    add_spots(picture, (spot,))
    row = round(0.6 * 1280)
    column = round(0.6 * 1280)
    red, green, blue = picture[row, column]
    assert blue < green < red < LEVEL
    changed = np.argwhere((picture != LEVEL).any(axis=2))
    millimetres = np.linalg.norm(changed - [row, column], axis=1).max() * 350.0 / 1280
    assert 2.0 < millimetres < 3.2


@pytest.mark.parametrize("radius", [0.4, 1.0, 3.0])
def test_small_pictures_have_the_same_spots(radius):
    """A spot in a small picture is that of the large picture, averaged over its texels."""
    spot = Spot(0.603, 0.401, radius, stretch=0.8, turn=0.7, melanin=0.6, softness=0.5)
    lost = []
    for size in (1280, 320):
        picture = plain(size)
        add_spots(picture, (spot,))
        lost.append((LEVEL - picture[..., 1].astype(float)).sum() / size**2)
    assert lost[1] == pytest.approx(lost[0], rel=0.25)


def test_no_spots_leave_the_picture():
    """Without spots the picture keeps its bytes."""
    picture = plain(64)
    add_spots(picture, ())
    assert (picture == LEVEL).all()
