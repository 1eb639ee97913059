"""Where skin takes on another tone, and how much: maps with which its picture is recoloured.

The light that skin throws back falls off exponentially with its pigments (pigments.py), so another
tone is the shipped picture times exp(- pigments times weight), with other hair laid on it. Weights
are read off the painter itself: a step of melanin, a step of blood, hair of black and of white.
"""

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from ..model import Head
from .brows import across_brow
from .painting import covers, laid_over, pigments, texel_size
from .pigments import BLOOD, MELANIN, OWN, Complexion, reflectance
from .regions import beard, behind_hairline, red
from .texels import Texels, left_texels

MOST = 2.55  # of a weight; a byte holds hundredths
COARSER = 4  # texels of the picture in one of the maps of melanin and blood, which are soft
BEHIND, IN_FRONT = 30.0, 10.0  # [mm]
FACE = 60.0  # [mm] z in front of which a texel belongs to the face


def paint_tints(head: Head, size: int) -> dict[str, npt.NDArray[np.generic]]:
    """Maps over a picture of `size` x `size`, in hundredths, uint8; row 0 is v = 1.

    Of shape (size / 4, size / 4) are melanin, blood: weight of a step of each; lips, beard: how
    much of either there is; brow: place across it, 1 at its edge, 2 far from it; scalp: how far
    behind a line `IN_FRONT` of the hairline, 1 for `BEHIND`.
    hair: how much of its colour lies on each texel, linear light, shape (size, size). skin: linear
    light 0..1 of the bare skin of the face, and its two weights, shape (5,).
    """
    texels = left_texels(head, size)
    own = replace(OWN, hair=(0.0, 0.0, 0.0))
    fine = texel_size(texels)
    base = _light(texels, own, fine)
    darker = _light(texels, replace(own, melanin=own.melanin + 1.0), fine)
    redder = _light(texels, replace(own, blood=own.blood + 0.2), fine)
    white = replace(own, hair=(1.0, 1.0, 1.0))
    both = [_light(texels, white, fine, side) - _light(texels, own, fine, side) for side in (1, -1)]
    left, right = (light.mean(axis=1) for light in both)
    base, darker, redder = (np.maximum(light, 1e-4) for light in (base, darker, redder))
    melanin = (np.log(base / darker) / MELANIN).mean(axis=1)
    # Red light hardly meets blood: its share would be noise.
    blood = (np.log(base / redder) / (0.2 * BLOOD))[:, 1:].mean(axis=1)
    is_skin = (texels.points[:, 2] > FACE) & (left < 0.01) & (melanin > 0.9)
    skin = [
        *np.median(base[is_skin], axis=0),
        np.median(melanin[is_skin]),
        np.median(blood[is_skin]),
    ]
    return {
        "melanin": _coarse(_image(texels, melanin, size)),
        "blood": _coarse(_image(texels, blood, size)),
        "lips": _coarse(_image(texels, red(texels), size), 0.0),
        "beard": _coarse(_image(texels, beard(texels), size), 0.0),
        "brow": _coarse(_image(texels, np.minimum(across_brow(texels.points), 2.0), size), 2.0),
        "scalp": _coarse(_image(texels, (behind_hairline(texels) + IN_FRONT) / BEHIND, size), 0.0),
        "hair": _bytes(np.nan_to_num(_image(texels, left, size, right))),
        "skin": np.array(skin),
        "made_from": np.array(head.fingerprint, dtype=np.uint32),
    }


def _light(
    texels: Texels, complexion: Complexion, fine: float, side: int = 1
) -> npt.NDArray[np.float64]:
    """What the painter paints, without what differs on both sides of the skin; linear, (n, 3)."""
    skin = reflectance(*pigments(texels, complexion))
    return laid_over(skin, covers(texels, complexion, fine, side))


def _image(
    texels: Texels,
    left: npt.NDArray[np.float64],
    size: int,
    right: npt.NDArray[np.float64] | None = None,
) -> npt.NDArray[np.float64]:
    """Values on both halves of a picture, the same unless told; NaN beside the skin."""
    image = np.full((size, size), np.nan)
    image[texels.rows, texels.columns] = left
    image[texels.rows, size - 1 - texels.columns] = left if right is None else right
    return image


def _coarse(
    image: npt.NDArray[np.float64], elsewhere: float | None = None
) -> npt.NDArray[np.uint8]:
    """Means of blocks; the median where there is no skin, which the picture's edge goes over to."""
    beside = np.nanmedian(image) if elsewhere is None else elsewhere
    filled = np.where(np.isnan(image), beside, image)
    count = len(image) // COARSER
    blocks = filled[: count * COARSER, : count * COARSER]
    return _bytes(blocks.reshape(count, COARSER, count, COARSER).mean(axis=(1, 3)))


def _bytes(values: npt.NDArray[np.float64]) -> npt.NDArray[np.uint8]:
    return np.asarray(np.rint(100.0 * np.clip(values, 0.0, MOST)), dtype=np.uint8)
