"""The map of classes over the texture: which texel is nose, which lip, which neck.

Painted where texels lie on the face, like the picture of the skin and by the same functions, so
that borders are lines of the form and not edges of triangles: the nose ends where its solid comes
out of the head, lips where their red does, brows where their hairs thin out. The neck begins at the
lower edge of the jaw, as outlines in photographs have it, and behind the ears at the hairline.
"""

import numpy as np
import scipy

from ..data_files import Image
from ..model import Head, Segment
from . import nose
from .brows import tint
from .form import head_distance
from .regions import line_height, red, scalp
from .texels import Texels, left_texels

# The line around the head above which the neck ends: angle about its axis [deg], height [mm].
NECK_LINE = (
    (0, -118), (22, -115), (43, -111), (61, -103), (74, -94), (84, -84), (90, -70), (96, -54),
    (102, -43), (112, -42), (124, -56), (136, -72), (150, -82), (180, -88),
)  # fmt: skip
EAR = 0.15  # rows from the root of the ear, where it begins
MOUTH = 1.5  # row behind the line where the lips meet, where the mouth's inside begins
EYE = 1.0  # row of the lid's inner edge
HALF = 0.5  # of the red of the lips, of the hair's density
SOME_HAIR = 0.25  # of the tint under the brows


def paint_segments(head: Head, size: int) -> Image:
    """Paint the map, numbers of `Segment`, shape (size, size), uint8; row 0 is v = 1."""
    texels = left_texels(head, size)
    left, right = (_classes(texels, is_left=is_left) for is_left in (True, False))
    image = np.zeros((size, size), dtype=np.uint8)
    image[texels.rows, texels.columns] = left
    image[texels.rows, size - 1 - texels.columns] = right
    # Outside the skin its border goes on: whoever looks up the nearest texel finds skin.
    _, nearest = scipy.ndimage.distance_transform_edt(image == 0, return_indices=True)
    painted: Image = image[nearest[0], nearest[1]]
    return painted


def _classes(texels: Texels, *, is_left: bool) -> Image:
    """The class of each texel, on the subject's left or, mirrored, on the right; shape (n,)."""
    points = texels.points
    is_lip = red(texels) > HALF
    is_upper = texels.is_upper_lip > HALF
    regions = (  # what comes later lies on what comes before
        (Segment.NECK, texels.height < line_height(NECK_LINE, texels.angle)),
        (Segment.HAIR, scalp(texels) > HALF),
        (Segment.LEFT_EAR if is_left else Segment.RIGHT_EAR, texels.ear_row > EAR),
        (Segment.NOSE, (nose.distance(points) < head_distance(points)) | (texels.nostril > 0.0)),
        (Segment.LEFT_BROW if is_left else Segment.RIGHT_BROW, tint(points) > SOME_HAIR),
        (Segment.TOP_LIP, is_lip & is_upper),
        (Segment.BOTTOM_LIP, is_lip & ~is_upper),
        (Segment.MOUTH_INTERIOR, texels.mouth_row < MOUTH),
        (Segment.LEFT_EYE if is_left else Segment.RIGHT_EYE, texels.eye_row < EYE),
    )
    classes = np.full(len(points), Segment.SKIN, dtype=np.uint8)
    for segment, is_there in regions:
        classes[is_there] = segment
    return classes
