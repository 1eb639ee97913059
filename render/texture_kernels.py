"""Kernels of `texture.py`: convert bytes to square roots of light, and make the first mipmap."""

import numpy as np

from ..geometry.arrays import Floats32, Unsigned8
from ..jit import njit


@njit
def write_roots(
    image: Unsigned8, occlusion: Unsigned8, roots: Unsigned8, texels: Unsigned8
) -> None:
    """Write square roots of light and of ambient occlusion into `texels`, (H, W, 4).

    image: sRGB, (H, W, 3). occlusion: (H, W), or (1, 1) for all texels. roots: square roots of
    light for the bytes of an image, then of occlusion for the bytes of `occlusion`, (512,).
    """
    height, width, _ = image.shape
    is_mapped = occlusion.size == height * width
    for y in range(height):
        row = texels[y]
        for x in range(width):
            for channel in range(3):
                row[x, channel] = roots[image[y, x, channel]]
        for x in range(width):
            row[x, 3] = roots[256 + (occlusion[y, x] if is_mapped else occlusion[0, 0])]


@njit
def write_halved(image: Unsigned8, occlusion: Unsigned8, values: Floats32, found: Floats32) -> None:
    """Write means of 2 x 2 texels' light and occlusion into `found`, (H // 2, W // 2, 4).

    image, occlusion: as in `write_roots`. values: light for the bytes of an image, then occlusion
    for the bytes of `occlusion`, (512,).
    """
    half = np.float32(0.5)
    is_mapped = occlusion.size > 1
    for y in range(found.shape[0]):
        for x in range(found.shape[1]):
            for channel in range(3):
                left = half * (
                    values[image[2 * y, 2 * x, channel]] + values[image[2 * y + 1, 2 * x, channel]]
                )
                right = half * (
                    values[image[2 * y, 2 * x + 1, channel]]
                    + values[image[2 * y + 1, 2 * x + 1, channel]]
                )
                found[y, x, channel] = half * (left + right)
            if not is_mapped:
                found[y, x, 3] = values[256 + occlusion[0, 0]]
                continue
            left = half * (
                values[256 + occlusion[2 * y, 2 * x]] + values[256 + occlusion[2 * y + 1, 2 * x]]
            )
            right = half * (
                values[256 + occlusion[2 * y, 2 * x + 1]]
                + values[256 + occlusion[2 * y + 1, 2 * x + 1]]
            )
            found[y, x, 3] = half * (left + right)
