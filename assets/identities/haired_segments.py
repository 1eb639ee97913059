"""Segments of the texture for a person: where brows, hair and beard are on this person's skin."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import scipy

from ...geometry.arrays import Floats32, Integers64
from ..data_files import Image
from ..loading import load
from ..model import Segment
from .brows import painted, trimmed_area
from .features import Features
from .painted_hair import grown_over


def haired_segments(features: Features, behind: Floats32, beard: Floats32) -> Image:
    """Change the built-in head's segments, (H, W), to a person's brows, hairline and full beard.

    behind: distances behind the hairline [mm], (H, W). beard: where beards grow, 0 to 1, (H, W).
    """
    found = load("head").segments.copy()
    texels = found.reshape(-1)
    haired = _texels_of(Segment.HAIR)
    is_bald = grown_over(behind.reshape(-1)[haired]) < 0.5
    texels[haired[is_bald]] = Segment.SKIN
    if features.hairline.tied:  # other hair begins behind the built-in hairline
        ahead = np.flatnonzero((found == Segment.SKIN) & (behind > 0.0))
        texels[ahead[grown_over(behind.reshape(-1)[ahead]) >= 0.5]] = Segment.HAIR
    if features.brows is not None:
        texels[_texels_of(Segment.RIGHT_BROW, Segment.LEFT_BROW)] = Segment.SKIN
        hairs = painted(features.brows, len(found))
        blur = 2.0  # [texels]
        wide = round(5.0 * blur)
        rows = np.flatnonzero(hairs.any(axis=1))
        near = slice(max(rows[0] - wide, 0), rows[-1] + wide)  # rows of texels around brows
        covered = scipy.ndimage.gaussian_filter(hairs[near], blur)
        left = np.arange(found.shape[1]) > found.shape[1] / 2
        sides = np.where(left, np.uint8(Segment.LEFT_BROW), np.uint8(Segment.RIGHT_BROW))
        # A texel is brow if its cover is at least a third of the greatest cover in its column. So a
        # dense brow loses the free ends of its hairs, and a thin tail is kept to its end.
        least_cover = np.maximum(0.1, covered.max(axis=0) / 3.0)
        is_brow = (covered > least_cover) & (found[near] == Segment.SKIN)
        found[near] = np.where(is_brow, sides, found[near])
    if features.beard_length:
        least_density = 0.3  # of hairs that cover half of the skin, which are longer than apart
        is_skin = (found == Segment.SKIN) | (found == Segment.NECK)
        found[is_skin & (beard * trimmed_area(len(beard)) >= least_density)] = Segment.FACIAL_HAIR
    return found


@lru_cache(maxsize=2)
def _texels_of(*segments: Segment) -> Integers64:
    """Return flat indices of the texels in some segments of the built-in head, (n,)."""
    texels = np.flatnonzero(np.isin(load("head").segments, segments))
    texels.flags.writeable = False
    return texels
