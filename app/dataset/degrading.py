"""Degrade pictures as a camera does: by blur, noise and JPEG compression, in this order."""

from __future__ import annotations

import io
from dataclasses import dataclass

import numpy as np
import PIL.Image
import scipy

from risorius.geometry.colour import to_linear, to_screen

from ..pictures import Image


@dataclass(frozen=True)
class Degradation:
    """Amount of each effect; 0 and None change nothing.

    blur: standard deviation of a Gaussian on linear light [pixels].
    noise: standard deviation of the noise in each channel [grey levels of 255].
    jpeg: quality of Pillow's compression, 1 to 95.
    seed: seed of the noise.
    """

    blur: float
    noise: float
    jpeg: int | None
    seed: int


def degraded(image: Image, degradation: Degradation) -> Image:
    """Return a picture (H, W, 3), uint8, after degradation."""
    values = image.astype(np.float64)
    if degradation.blur > 0.0:
        light = to_linear(image / 255.0)
        blurred = scipy.ndimage.gaussian_filter(light, (degradation.blur, degradation.blur, 0.0))
        values = 255.0 * to_screen(blurred)
    if degradation.noise > 0.0:
        random = np.random.default_rng(degradation.seed)
        values = values + degradation.noise * random.standard_normal(image.shape)
    found: Image = np.rint(values).clip(0, 255).astype(np.uint8)
    if degradation.jpeg is None:
        return found
    file = io.BytesIO()
    PIL.Image.fromarray(found).save(file, "JPEG", quality=degradation.jpeg)
    return np.asarray(PIL.Image.open(file).convert("RGB"))
