"""The map of wrinkles over the texture, and the direction of each vertex that makes them show.

The map is painted where its texels lie on the face, like the picture of the skin. A texel holds
the slope of the skin's height along u and v, the depth of the furrow, and which of the two
amounts of wrinkling it follows.
"""

import numpy as np
import numpy.typing as npt

from ..model import Head, Wrinkles
from .creases import SLOTS, creases
from .fields import Points, Values, smooth_step
from .mouth_rows import OUTER_ROW
from .texels import corner_values, left_texels

SIZE = 1280  # texels, as of the picture of the skin
STEEPEST = 1.0  # slope [mm/mm] of a full byte
DEEPEST = 0.8  # [mm] of a full byte
SCALE = 400.0  # [mm] of the face on the unit of texture coordinates, about


def paint_wrinkles(head: Head, size: int = SIZE) -> Wrinkles:
    """Paint the map and find the directions of all vertices."""
    height, depth, slot = np.zeros((size, size)), np.zeros((size, size)), np.zeros((size, size))
    texels = left_texels(head, size)
    for side in (1, -1):
        columns = texels.columns if side > 0 else size - 1 - texels.columns
        place = texels.rows, columns
        covered = np.full(len(texels.rows), 1e-9)
        second = np.zeros(len(texels.rows))
        for crease in creases(texels.points * [side, 1.0, 1.0], texels.mouth_row):
            shown = crease.cover * _free(texels.eye_row, texels.ear_row, texels.nostril)
            height[place] += shown * crease.furrows.height
            depth[place] += shown * crease.furrows.depth
            covered += shown
            second += shown * crease.slot
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
    return Wrinkles(np.rint(texel).astype(np.uint8), STEEPEST * SCALE, across(head))


def _free(eye_row: Values, ear_row: Values, nostril: Values) -> Values:
    """Where skin may wrinkle: not on the lids' margins, not on ears, not in nostrils."""
    return smooth_step(3.0, 4.2, eye_row) * (ear_row < 0.5) * (nostril < 0.02)


def across(head: Head) -> npt.NDArray[np.float32]:
    """The direction in which each vertex' skin shortens when it wrinkles, shape (V, 2, 3).

    One for each slot; its length says how readily, 0: not at all.
    """
    values = corner_values(head)
    mouth_row = np.minimum(values[:, 2], values[head.mirror, 2])
    total: Points = np.zeros((SLOTS, len(head.vertices), 3))
    weight = np.zeros((SLOTS, len(head.vertices)))
    readiness = np.zeros((SLOTS, len(head.vertices)))
    for crease in creases(head.vertices, np.minimum(mouth_row, OUTER_ROW + 1.0)):
        total[crease.slot] += crease.near[:, None] * crease.across
        weight[crease.slot] += crease.near
        readiness[crease.slot] += crease.near * crease.readiness
    length = np.maximum(np.linalg.norm(total, axis=2), 1e-12)
    is_near = weight > 1e-3
    found = total * (is_near * readiness / np.maximum(weight, 1e-12) / length)[:, :, None]
    return np.ascontiguousarray(found.transpose(1, 0, 2), dtype=np.float32)
