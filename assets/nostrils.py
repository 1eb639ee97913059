"""Brightens the nostrils in the map of ambient light, because flesh scatters light."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..geometry.arrays import Floats32
from .data_files import Image


def lit_nostrils(occlusion: Image, rims: Iterable[Floats32]) -> Image:
    """Openness of the skin to light, (H, W), uint8, with light in the nostrils.

    rims: texture coordinates around each nostril, shape (n, 2). The amount of light is chosen by
    eye.
    """
    height, width = occlusion.shape
    lit = occlusion.astype(np.float64)
    inner_light = 66.0  # of 255, where no direct light arrives
    for rim in rims:
        middle = rim.mean(axis=0)
        reach = 1.25 * float(np.linalg.norm(rim - middle, axis=1).max())
        across = (np.arange(width) + 0.5) / width - middle[0]
        down = 1.0 - (np.arange(height) + 0.5) / height - middle[1]
        squared_distance = across**2 + down[:, None] ** 2
        near = np.exp(-((squared_distance / reach**2) ** 3))
        darkness = 1.0 - lit / 255.0
        lit += near * inner_light * darkness**2
    found = np.rint(np.minimum(lit, 255.0)).astype(np.uint8)
    found.flags.writeable = False
    return found
