"""Take traces of older brows from the skin around brows: light streaks, and relief.

`python .ci/brows_mending.py` writes head.png and head_fine_shape.npz anew: there the skin's light
and relief are smoothed, and get the pores of the forehead above. Hairs stay as they are.
"""

from pathlib import Path

import numpy as np
import numpy.typing as npt
import PIL.Image
import scipy

from risorius.assets.loading import load
from risorius.assets.model import FloatArray
from risorius.assets.pigments import OWN
from risorius.geometry.colour import to_linear, to_screen

DATA = Path("assets/data")
NEAR, SOFT = 22, 5.0  # [texels] around hairs that are mended, and over which it fades
SMOOTH, ABOVE = 12.0, 120  # [texels] of light and relief that stay, and from where pores come


def mended(values: FloatArray, mask: FloatArray, known: npt.NDArray[np.bool_]) -> FloatArray:
    """Smooth values in the mask, from those that are known, with the detail above it."""
    scale = len(values) / 1280
    layers = np.moveaxis(values, -1, 0)
    weights = scipy.ndimage.gaussian_filter(known.astype(float), SMOOTH * scale)
    around = [scipy.ndimage.gaussian_filter(layer * known, SMOOTH * scale) for layer in layers]
    smooth = np.stack(around, axis=-1) / np.maximum(weights, 1e-6)[..., None]
    blurred = scipy.ndimage.gaussian_filter(values, (3.0 * scale, 3.0 * scale, 0.0))
    pores = np.roll(values - blurred, round(ABOVE * scale), axis=0)
    return np.asarray(values + mask[..., None] * (smooth + pores - values))


def main() -> None:
    """Write both files anew."""
    head, tints = load("head"), np.load(DATA / "head_tints.npz")
    hair = tints["hair"] / 100.0
    size = len(hair)
    own = to_linear(np.array(OWN.hair))
    light = to_linear(np.arange(256) / 255.0)[head.albedo]
    skin = tints["skin"][:3]
    bare = light + hair[..., None] * (skin - own)
    brow = PIL.Image.fromarray(tints["brow"]).resize((size, size), PIL.Image.Resampling.BILINEAR)
    at_brow = np.asarray(brow) < 199
    old = at_brow & (hair > 0.02)
    tails = scipy.ndimage.binary_dilation(old, iterations=NEAR)
    for column, up in (size * head.uv[head.landmarks[17:27]]).astype(int):
        row = size - up
        tails[row - 12 : row + 18, column - 24 : column + 24] = True
    mask, known = scipy.ndimage.gaussian_filter(tails.astype(float), SOFT), ~tails
    bare = mended(bare, mask, known)
    bald = np.maximum(bare - hair[..., None] * skin, 0.0)
    picture = to_screen(np.clip(bald + hair[..., None] * own, 0.0, 1.0))
    levels = np.rint(255.0 * picture).astype(np.uint8)
    PIL.Image.fromarray(levels).save(DATA / "head.png", optimize=True)
    fine = dict(np.load(DATA / "head_fine_shape.npz"))
    slopes = np.cumsum(fine["steps"], axis=0, dtype=np.uint8).astype(float)
    small = scipy.ndimage.zoom(mask, len(slopes) / size, order=1)
    known = scipy.ndimage.zoom(known.astype(float), len(slopes) / size, order=1) > 0.5
    slopes = np.rint(np.clip(mended(slopes, small, known), 0, 255)).astype(np.uint8)
    fine["steps"] = np.diff(slopes, axis=0, prepend=np.zeros_like(slopes[:1]))
    np.savez_compressed(DATA / "head_fine_shape.npz", **fine)


if __name__ == "__main__":
    main()
