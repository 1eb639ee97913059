"""The picture of the skin: red, dark and hairy places, in every tone, and how it is read."""

import numpy as np
import pytest
import scipy
from pytest import approx

from risorius.assets.fitting.painting import plain_picture
from risorius.assets.model import Segment
from risorius.geometry.directions import unit_vectors

LARGEST_IMAGE_FILE = 1_250_000  # [bytes]


def test_albedo_is_a_picture(head):
    """The picture is square, 8 bits, three channels, read-only, small on disk, and read once."""
    assert head.albedo.dtype == np.uint8
    assert head.albedo.ndim == 3
    assert head.albedo.shape[0] == head.albedo.shape[1] >= 1024
    assert head.albedo.shape[2] == 3
    assert head.albedo is head.albedo
    assert head.file.with_suffix(".png").stat().st_size < LARGEST_IMAGE_FILE
    with pytest.raises(ValueError, match="read-only"):
        head.albedo[0] = 0


def test_picture_is_mirrored_but_for_patches_and_grain(head):
    """Patches, pores and freckles differ from side to side; red and dark places do not."""
    image = head.albedo.astype(np.int64)
    difference = np.abs(image - image[:, ::-1])
    assert 0.5 < difference.mean() < 6.0
    size = len(image) // 40
    blocks = image[: 40 * size, : 40 * size].reshape(40, size, 40, size, 3).mean(axis=(1, 3))
    off = np.abs(blocks - blocks[:, ::-1])
    assert off.mean() < 3.0
    assert off.max() < 25.0


def test_picture_continues_outside_the_skin(head):
    """The picture continues outside the skin, so that filters across the rim find no border."""
    rim = head.rings["rim_left"][3:-3]
    size = len(head.albedo)
    inside = head.uv[rim] * [size, -size] + [0.0, size]
    outward = inside - size / 2
    beyond = inside + 4.0 * unit_vectors(outward)
    colours = []
    for places in (inside, beyond):
        columns, rows = places.astype(int).T
        colours.append(head.albedo[rows, columns].astype(int))
    assert np.abs(colours[0] - colours[1]).mean() < 12.0


def test_hair_on_other_heads_has_hardly_any_strands(head):
    """In the picture for other heads strands fade, and neither the hair's colour nor skin changes.

    The strands follow the facets of the built-in scalp, so they were waves on MakeHuman's head.
    """
    plain = plain_picture(head).astype(float)
    own = head.albedo.astype(float)
    is_hair = scipy.ndimage.binary_erosion(head.segments == Segment.HAIR, iterations=30)
    strands = [each - scipy.ndimage.gaussian_filter(each, (8, 8, 0)) for each in (plain, own)]
    plain_contrast, own_contrast = (np.abs(each[is_hair]).mean() for each in strands)
    assert plain_contrast < 0.4 * own_contrast
    assert plain[is_hair].mean(axis=0) == approx(own[is_hair].mean(axis=0), abs=1.0)
    face = np.isin(head.segments, [Segment.NOSE, Segment.TOP_LIP, Segment.BOTTOM_LIP])
    is_low = np.arange(len(own)) > 0.55 * len(own)
    is_same = (plain == own).all(axis=2)
    assert is_same[face & is_low[:, None]].mean() > 0.9
