"""Ears of persons differ in size, in how far they stand off and lean, and in their lobes."""

import numpy as np
import pytest

from risorius.assets import load
from risorius.assets.identities.ears import USUAL_EARS, Ears, _ear, drawn_ears, with_ears


@pytest.fixture(scope="module")
def skin():
    """The skin of the built-in head."""
    return load("head").vertices


def left_ear(vertices):
    """The vertices of the left ear [mm]."""
    return vertices[_ear("left").vertices]


def test_usual_ears_stay(skin):
    """Ears that do not differ keep their vertices."""
    assert np.allclose(with_ears(skin, USUAL_EARS), skin)


@pytest.mark.parametrize("ears", [Ears(length=1.2), Ears(angle=0.2), Ears(lean=0.1, lobe=3.0)])
def test_only_ears_move_and_both_alike(skin, ears):
    """The head beside the ears stays, and the right ear is the mirror image of the left one."""
    moved = with_ears(skin, ears)
    both = np.concatenate([_ear(side).vertices for side in ("left", "right")])
    others = np.setdiff1d(np.arange(len(skin)), both)
    assert (moved[others] == skin[others]).all()
    mirrored = moved[load("head").mirror] * [-1.0, 1.0, 1.0]
    assert np.allclose(mirrored, moved, atol=1e-3)


def test_ears_get_longer_stand_off_and_lean(skin):
    """Each number does what its name says."""
    usual = left_ear(skin)
    longer = left_ear(with_ears(skin, Ears(length=1.2)))
    assert np.ptp(longer[:, 1]) == pytest.approx(1.2 * np.ptp(usual[:, 1]), rel=0.03)
    rim = usual[:, 2].argmin()
    assert left_ear(with_ears(skin, Ears(angle=0.2)))[rim, 0] > usual[rim, 0] + 3.0
    top = usual[:, 1].argmax()
    assert left_ear(with_ears(skin, Ears(lean=0.1)))[top, 2] < usual[top, 2] - 1.0
    lobe = usual[:, 1].argmin()
    assert left_ear(with_ears(skin, Ears(lobe=3.0)))[lobe, 1] < usual[lobe, 1] - 2.0


def test_ears_grow_with_age_and_are_longer_in_men():
    """Means of many ears differ as measured: by 0.22 mm a year, and by sex."""

    def mean_length(is_man, age):
        drawn = [drawn_ears(is_man, age, np.random.default_rng(n)).length for n in range(50)]
        return 59.0 * np.mean(drawn)

    assert mean_length(False, 70.0) - mean_length(False, 30.0) == pytest.approx(8.8, abs=0.5)
    assert mean_length(True, 30.0) > mean_length(False, 30.0) + 2.0
