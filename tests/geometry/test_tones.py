"""Colours of skin with hair: the kernels have the same bits as numpy on whole arrays."""

import numpy as np
import pytest

from risorius.geometry.tones import Absorbed, Grown, Hairs, absorb, compose

IMAGE_SHAPE = 4, 37
LARGEST_TONE = np.float32(0.99)


def in_whole_arrays(absorbed, light, skin, former, hairs, grown, table):
    """The picture, computed by numpy on whole maps."""
    picture = np.empty((*IMAGE_SHAPE, 3), np.uint8)
    on_scalp = hairs.scalp > 0.01
    within = np.where(on_scalp, np.float32(1.0), hairs.beard)
    grey = hairs.grey[1] + within * (hairs.grey[0] - hairs.grey[1])
    haired = hairs.kept
    if len(grown.covered):
        haired = np.where(on_scalp, np.float32(0.0), haired)
        shaded = 1.0 - (1.0 - grown.root_light) * grown.covered
        covered = grown.covered + grown.hairs * grown.covered * (grown.most - grown.covered)
    amounts = absorbed.amounts
    maps = absorbed.maps
    for channel in range(3):
        lost = amounts[0][channel] * maps[0] + amounts[1][channel] * maps[1]
        lost -= absorbed.relief * absorbed.detail
        lost += amounts[2][channel] * maps[2]
        lost += amounts[3][channel] * maps[3]
        found = light[channel] * np.exp(-lost)
        found += skin[channel] * (former - haired)
        own = hairs.light[channel] + grey * (hairs.grey_light[channel] - hairs.light[channel])
        found += own * haired
        if len(grown.covered):
            found += covered * (own * shaded - found)
        steps = np.sqrt(np.clip(found, 0.0, 1.0)) * np.float32(len(table) - 1)
        picture[..., channel] = table[steps.astype(np.intp)]
    return picture


@pytest.mark.parametrize("is_grown", [False, True])
def test_same_bits_as_whole_arrays(is_grown):
    """Random maps, with light below 0 and above 1, give equal bytes.

    The kernels work in two bands.
    """
    random = np.random.default_rng(0)

    def drawn(*shape, low=0.0, high=1.0):
        return random.uniform(low, high, shape).astype(np.float32)

    amounts = tuple(drawn(3, low=-0.5, high=2.0) for _ in range(4))
    maps = tuple(drawn(*IMAGE_SHAPE) for _ in range(4))
    absorbed = Absorbed(amounts, maps, np.float32(0.7), drawn(*IMAGE_SHAPE, low=-0.3, high=0.3))
    scalp = drawn(*IMAGE_SHAPE) * (random.random(IMAGE_SHAPE) < 0.5).astype(np.float32)
    hairs = Hairs(drawn(3), drawn(2), drawn(3), drawn(*IMAGE_SHAPE), scalp, drawn(*IMAGE_SHAPE))
    covered = drawn(*IMAGE_SHAPE) if is_grown else np.zeros((0, IMAGE_SHAPE[1]), np.float32)
    grown = Grown(covered, drawn(*IMAGE_SHAPE, low=-1.4, high=1.4), LARGEST_TONE, np.float32(0.5))
    light = drawn(3, *IMAGE_SHAPE, low=-0.2, high=1.6)
    skin = drawn(3)
    former = drawn(*IMAGE_SHAPE)
    table = random.integers(0, 256, 4096, np.uint8)
    picture = np.zeros((*IMAGE_SHAPE, 3), np.uint8)
    left = np.empty((3, 2, IMAGE_SHAPE[1]), np.float32)
    for first in (0, 2):
        absorb(absorbed, first, left)
        np.exp(left, out=left)
        compose(left, first, light, skin, former, hairs, grown, table, picture)
    assert (picture == in_whole_arrays(absorbed, light, skin, former, hairs, grown, table)).all()
