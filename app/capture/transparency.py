"""Pictures with an alpha channel: straight colours, and colours around what is seen."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..files import Image

AROUND = 6  # halvings: colours reach 64 pixels, the largest block of a coder, beyond an edge


def straight(premultiplied: Image) -> Image:
    """From premultiplied colours to those that files hold, (H, W, 4); black where nothing is."""
    image = premultiplied.copy()
    partly = (image[..., 3] > 0) & (image[..., 3] < 255)
    colours = image[partly].astype(np.float32)
    image[partly, :3] = np.minimum(colours[:, :3] * (255.0 / colours[:, 3:]) + 0.5, 255.0)
    image[image[..., 3] == 0] = 0
    return image


def with_colours_around(image: Image) -> Image:
    """The same picture, (H, W, 4), with colours of its edges where it is fully transparent.

    What codes blocks of pixels, or colours at half the size, mixes edges with what is around them;
    black there would be seen as a dark fringe.
    """
    weight: npt.NDArray[np.float32] = (image[..., 3:] > 0).astype(np.float32)
    filled = image.copy()
    seen: npt.NDArray[np.float32] = image[..., :3].astype(np.float32) * weight
    around = _filled(seen, weight, AROUND)
    filled[..., :3] = np.where(weight > 0.0, image[..., :3], around + 0.5)
    return filled


def _filled(
    colours: npt.NDArray[np.float32], weight: npt.NDArray[np.float32], halvings: int
) -> npt.NDArray[np.float32]:
    """Colours (H, W, 3), 0 where the weight (H, W, 1) is, with means of those around there."""
    if not halvings:
        return colours
    height, width = weight.shape[:2]
    padding = ((0, height % 2), (0, width % 2), (0, 0))

    def halved(values: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
        """Sums of two by two."""
        even = np.pad(values, padding)
        rows = even[::2] + even[1::2]
        summed: npt.NDArray[np.float32] = rows[:, ::2] + rows[:, 1::2]
        return summed

    count = halved(weight)
    means = halved(colours) / np.maximum(count, 1.0)
    coarse = _filled(means, np.minimum(count, 1.0), halvings - 1)
    fine = coarse.repeat(2, axis=0).repeat(2, axis=1)[:height, :width]
    return np.where(weight > 0.0, colours, fine)
