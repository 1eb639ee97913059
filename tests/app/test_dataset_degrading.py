"""`risorius dataset --degrade`: blur, noise and JPEG compression, with their labels."""

import json

import numpy as np
import PIL.Image
import pytest

from risorius.app.dataset.degrading import Degradation, degraded

from .command_line import succeeded
from .without_workers import in_this_process

CLEAN_PICTURE = Degradation(0.0, 0.0, None, 5)
GREY_PICTURE = np.full((120, 120, 3), 128, np.uint8)


def test_none_of_it_changes_nothing():
    """Without degradation every byte stays the same."""
    image = np.random.default_rng(1).integers(0, 256, (30, 40, 3)).astype(np.uint8)
    assert np.array_equal(degraded(image, CLEAN_PICTURE), image)


def test_noise_deviates_by_as_many_levels():
    """Noise has the given deviation in grey levels in each channel, and follows the seed."""
    noisy = degraded(GREY_PICTURE, Degradation(0.0, 6.0, None, 5))
    assert noisy.std(axis=(0, 1)) == pytest.approx(6.0, rel=0.05)
    channels = noisy.reshape(-1, 3).astype(float)
    assert abs(np.corrcoef(channels.T)[0, 1]) < 0.05
    assert np.array_equal(noisy, degraded(GREY_PICTURE, Degradation(0.0, 6.0, None, 5)))
    assert not np.array_equal(noisy, degraded(GREY_PICTURE, Degradation(0.0, 6.0, None, 6)))


def test_blur_is_that_of_light():
    """Blur is applied to linear light: the middle of an edge has half of the light.

    Two deviations away hardly any light remains.
    """
    image = np.zeros((9, 80, 3), np.uint8)
    image[:, 40:] = 255
    row = degraded(image, Degradation(3.0, 0.0, None, 5))[4, :, 0]
    assert row[39:41].mean() == pytest.approx(188.0, abs=6.0)  # sRGB value of half the light
    assert row[40 - 10] < 10
    assert row[40 + 10] > 250


def test_jpeg_is_unpacked_again():
    """JPEG compression is decoded again; a lower quality differs more from the picture."""
    image = np.kron(np.random.default_rng(1).integers(0, 256, (16, 16, 3)), np.ones((4, 4, 1)))
    image = image.astype(np.uint8)
    errors = []
    for quality in (95, 60, 20):
        compressed = degraded(image, Degradation(0.0, 0.0, quality, 5))
        errors.append(np.abs(compressed - image.astype(float)).mean())
    assert 0.0 < errors[0] < errors[1] < errors[2]


@pytest.mark.slow
def test_only_pictures_and_one_label_differ(tmp_path):
    """Only pictures and one label change; rows of a table choose the degradations.

    The data set's card names the option.
    """
    table = tmp_path / "my.toml"
    table.write_text("[degradations]\nblurred = 1\nnoisy = 1\nnoise = [4, 4]\ncompressed = 0\n")
    options = ("--count", 1, "--size", "80x64", "--sample", table, "--quiet")
    with in_this_process():
        for name, more in (("clean", ()), ("degraded", ("--degrade",))):
            succeeded("dataset", *options, "-o", tmp_path / name, *more)
    clean, other = (tmp_path / name for name in ("clean", "degraded"))
    pictures = [np.asarray(PIL.Image.open(each / "000000.png")) for each in (clean, other)]
    assert not np.array_equal(*pictures)
    name = "000000_seg.png"
    assert (clean / name).read_bytes() == (other / name).read_bytes()
    labels = json.loads((other / "000000.json").read_text())
    added = labels.pop("degradation")
    assert added["noise"] == 4.0
    assert 0.3 <= added["blur"] <= 1.5
    assert added["jpeg"] is None
    labels.pop("files")
    expected = json.loads((clean / "000000.json").read_text())
    expected.pop("files")
    assert labels == expected
    assert "--degrade" in (other / "README.md").read_text()
