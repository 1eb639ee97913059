"""The map of wrinkles over the texture, and the direction of each vertex that makes them show.

What is broad enough for triangles is kept as heights besides, which move the skin itself. The
slopes are those of both together, so shading takes them from the map alone.

The map is painted where its texels lie on the face, like the picture of the skin. A texel holds
the slope of the skin's height along u and v, the depth of the furrow, and which of the two
amounts of wrinkling it follows.
"""

import numpy as np
import numpy.typing as npt
import scipy

from ..model import HIGHEST_FOLD, Head, Wrinkles
from .creases import SLOTS, creases
from .fields import Values, smooth_step
from .mouth_rows import OUTER_ROW
from .texels import corner_values, left_texels

STEEPEST = 1.0  # slope [mm/mm] of a full byte
DEEPEST = 0.8  # [mm] of a full byte
NEAR = 1e-3  # of a region, below which a vertex has no direction
FINEST = 1.1  # [mm] standard deviation of what smooths the map for triangles of about this size
COARSER = 2  # of so many texels of the map, each way, the relief has one
SCALE = 400.0  # [mm] of the face on the unit of texture coordinates, about


def paint_wrinkles(head: Head, size: int) -> Wrinkles:
    """Paint the map and find the directions of all vertices."""
    height, depth, slot = np.zeros((size, size)), np.zeros((size, size)), np.zeros((size, size))
    texels = left_texels(head, size)
    for side in (1, -1):
        columns = texels.columns if side > 0 else size - 1 - texels.columns
        place = texels.rows, columns
        covered = np.full(len(texels.rows), 1e-9)
        second = np.zeros(len(texels.rows))
        for crease in creases(texels.points * [side, 1.0, 1.0], texels.mouth_row):
            visible = crease.cover * _free(texels.eye_row, texels.ear_row, texels.nostril)
            height[place] += visible * (crease.furrows.height + crease.furrows.roll)
            depth[place] += visible * crease.furrows.depth
            covered += visible
            second += visible * crease.slot
        slot[place] = second / covered
    down, right = np.gradient(height * (size / SCALE))
    texel = np.stack(
        [
            128.0 + 127.0 * np.clip(right / STEEPEST, -1.0, 1.0),
            128.0 - 127.0 * np.clip(down / STEEPEST, -1.0, 1.0),
            255.0 * np.clip(depth / DEEPEST, 0.0, 1.0),
            255.0 * slot,
        ],
        axis=-1,
    )
    image = np.rint(texel).astype(np.uint8)
    directions = across(head) * _shows(head, image)[:, None, None]
    return Wrinkles(image, STEEPEST * SCALE, directions, _relief(height, slot, size))


def _relief(height: Values, slot: Values, size: int) -> npt.NDArray[np.int8]:
    """What triangles can show of the height [mm] that follows either slot, (size, size) each."""
    smooth = np.clip(
        scipy.ndimage.gaussian_filter(height, FINEST * size / SCALE) / HIGHEST_FOLD, -1.0, 1.0
    )
    both = np.stack([smooth * (1.0 - slot), smooth * slot], axis=-1)
    return np.rint(127.0 * both[::COARSER, ::COARSER]).astype(np.int8)


def _free(eye_row: Values, ear_row: Values, nostril: Values) -> Values:
    """Where skin may wrinkle: not on the lids' margins, not on ears, not in nostrils."""
    return smooth_step(3.0, 4.2, eye_row) * (ear_row < 0.5) * (nostril < 0.02)


def _shows(head: Head, image: npt.NDArray[np.uint8]) -> npt.NDArray[np.bool_]:
    """The vertices with a triangle around in which the map is not plain, shape (V,).

    Only those are measured, and triangles between others are drawn without wrinkles.
    """
    is_plain = (image[..., :2] == 128).all(axis=2) & (image[..., 2] == 0)
    size = len(image)
    places = head.uv[head.face_uv] * [size, -size] + [0.0, size]
    low = np.floor(places.min(axis=1)).astype(int) - 1
    high = np.ceil(places.max(axis=1)).astype(int) + 1
    shows = np.zeros(len(head.vertices), dtype=bool)
    for face, (left, top), (right, bottom) in zip(head.faces, low, high, strict=True):
        shows[face] |= not is_plain[max(top, 0) : bottom, max(left, 0) : right].all()
    return shows | shows[head.mirror]


def across(head: Head) -> npt.NDArray[np.float32]:
    """The direction in which each vertex' skin shortens when it wrinkles, shape (V, 2, 3).

    One for each slot; its length says how readily, 0: not at all.
    """
    values = corner_values(head)
    mouth_row = np.minimum(values[:, 2], values[head.mirror, 2])
    found = np.zeros((len(head.vertices), SLOTS, 3))
    nearest = np.full((len(head.vertices), SLOTS), NEAR)
    for crease in creases(head.vertices, np.minimum(mouth_row, OUTER_ROW + 1.0)):
        is_nearest = crease.near > nearest[:, crease.slot]
        found[is_nearest, crease.slot] = crease.readiness * crease.across[is_nearest]
        nearest[is_nearest, crease.slot] = crease.near[is_nearest]
    # Mirrored, or the sides would differ where two regions are equally near.
    is_right = head.vertices[:, 0] < 0.0
    found[is_right] = found[head.mirror[is_right]] * [-1.0, 1.0, 1.0]
    return found.astype(np.float32)
