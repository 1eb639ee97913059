"""The picture of the skin: pigments by region, lips, lids, brows, stubble, freckles, pores.

Where skin is redder or browner is the same on both sides; patches, pores, freckles and the hairs of
the brows are not.
"""

import numpy as np
import numpy.typing as npt
import scipy

from risorius.geometry.colour import to_linear, to_screen

from ..data_files import Image
from ..model import Head
from . import lips
from .brows import brow_cover
from .fields import Points, Values, bump, smooth_step
from .form import fold_side
from .grain import SEED, blotches, crop, freckles, pores
from .noise import noise
from .pigments import MELANIN, OWN, Complexion, reflectance
from .regions import alar_groove, beard, blood, red, scalp, tan
from .texels import Texels, left_texels

Cover = tuple[Points, Values]  # a colour in linear light and how much of it lies on each texel

SIZE = 1280  # texels; chosen: more than three lie on a millimetre of the brow, the file 1 MB
SCALP_SHADOW, BEARD_SHADOW = 0.5, 0.12  # density of shaved hair
CROP = 0.85  # of the scalp's hair is seen: it is cropped short
LIP_BLOOD, LIP_MELANIN = 0.61, 0.22  # beside those of the skin
MUCOSA, MUCOSA_DEEP = (0.60, 0.27, 0.25), (0.30, 0.09, 0.09)  # sRGB
WATERLINE = (0.80, 0.57, 0.52)
LINE_OF_LIPS = (0.34, 0.125, 0.115)
NOSTRIL = (0.20, 0.085, 0.075)
PADDING = 24.0  # texels


def paint_skin(head: Head, *, complexion: Complexion = OWN, size: int = SIZE) -> Image:
    """Paint the skin of a head, shape (size, size, 3), uint8, sRGB; row 0 is v = 1."""
    texels = left_texels(head, size)
    melanin, redness, shadow = pigments(texels, complexion)
    grain = texel_size(texels)
    image = np.zeros((size, size, 3))
    is_painted = np.zeros((size, size), dtype=bool)
    for side in (1, -1):
        points = texels.points * [side, 1.0, 1.0]
        brown, red_patches = blotches(points)
        spots = complexion.freckles * freckles(texels, points, SEED + side)
        fine = (0.6 + complexion.melanin) * brown + pores(points) + spots
        bare = reflectance(melanin + fine, redness + complexion.blood * red_patches, shadow)
        colours = laid_over(bare, covers(texels, complexion, grain, side))
        columns = texels.columns if side > 0 else size - 1 - texels.columns
        image[texels.rows, columns] = to_screen(colours)
        is_painted[texels.rows, columns] = True
    return np.asarray(np.rint(255.0 * _padded(image, is_painted)), dtype=np.uint8)


def laid_over(colours: Points, covers: list[Cover]) -> Points:
    """Colours of the skin with all that lies on it, shape (n, 3)."""
    for colour, cover in covers:
        colours = colours + cover[:, None] * (colour - colours)
    return colours


def _padded(image: Points, is_painted: npt.NDArray[np.bool_]) -> Points:
    """The edge of the skin goes on outside: filters and small mipmaps must find no border."""
    away, nearest = scipy.ndimage.distance_transform_edt(~is_painted, return_indices=True)
    around = image[is_painted].mean(axis=0)
    share = smooth_step(PADDING, 0.5 * PADDING, away)[:, :, None]
    return np.asarray(around + (image[nearest[0], nearest[1]] - around) * share)


def texel_size(texels: Texels) -> float:
    """Size of a texel in the middle of the face [mm]."""
    is_next = (np.diff(texels.columns) == 1) & (np.diff(texels.rows) == 0)
    length = np.linalg.norm(np.diff(texels.points, axis=0), axis=1)
    return float(np.median(length[is_next & (texels.points[1:, 2] > 80.0)]))


def pigments(texels: Texels, complexion: Complexion) -> tuple[Values, Values, Values]:
    """Melanin, blood and the shadow of shaved hair."""
    points = texels.points
    lip = red(texels)
    melanin = complexion.melanin + tan(texels) * (0.7 + complexion.melanin)
    redness = complexion.blood * blood(texels)

    # The red: fine lines run across the lips; toward the line between them it is darker.
    lines = noise(points * [1.0, 0.13, 0.3], 0.62, seed=22) + 0.8 * noise(
        points * [1.0, 0.16, 0.3], 1.5, seed=24
    )
    x = np.minimum(np.abs(points[:, 0]), lips.HALF_WIDTH)
    from_line = np.abs(points[:, 1] - lips.seam_height(x))
    deep = smooth_step(6.0, 0.5, from_line)
    lip_blood = LIP_BLOOD + 0.16 * deep + 0.085 * lines - 0.10 * bump(x, 0.0, 9.0)
    melanin = melanin + lip * (LIP_MELANIN + 0.12 * deep + 0.06 * lines - 0.14 * complexion.melanin)
    redness = redness + lip * complexion.blood * lip_blood
    melanin = melanin + 0.06 * lip * (1.0 - texels.is_upper_lip)  # it faces the light
    # The skin just outside the red of the upper lip catches the light.
    roll = smooth_step(0.0, 0.5, lip) * smooth_step(1.0, 0.5, lip)
    melanin = melanin - 0.05 * roll * texels.is_upper_lip

    melanin = melanin + 0.20 * _corner_of_mouth(points) + 0.05 * _fold_beside_mouth(points)
    groove = alar_groove(points)
    melanin, redness = melanin + 0.36 * groove, redness + 0.24 * groove
    fold_of_lid = bump(texels.eye_row, 4.0, 0.35) * texels.is_upper_lid
    melanin = melanin + 0.10 * fold_of_lid
    redness = redness * (1.0 - 0.45 * scalp(texels))
    shadow = SCALP_SHADOW * scalp(texels) + BEARD_SHADOW * beard(texels)
    return melanin, redness, shadow


def _corner_of_mouth(points: Points) -> Values:
    """The small hollow in which the line of the lips ends, shape (n,)."""
    x, y = np.abs(points[:, 0]), points[:, 1]
    end = lips.seam_height(np.array([lips.HALF_WIDTH]))[0] - 0.6
    return bump(x, lips.HALF_WIDTH + 1.2, 3.2) * bump(y, end, 2.6)


def _fold_beside_mouth(points: Points) -> Values:
    """A hint of the nasolabial fold, strongest beside the wing of the nose, shape (n,)."""
    beside = np.abs(points[:, 0]) - fold_side(points[:, 1])[0]
    in_front = smooth_step(50.0, 60.0, points[:, 2])
    along = smooth_step(-74.0, -46.0, points[:, 1]) * smooth_step(-33.0, -39.0, points[:, 1])
    return bump(beside, -0.5, 2.6) * along * in_front


def covers(texels: Texels, complexion: Complexion, grain: float, side: int) -> list[Cover]:
    """What lies on the skin or is no skin, from below to above; side: 1 the left one, else -1."""
    hair = to_linear(complexion.hair)
    wet = to_linear(WATERLINE) * np.exp(-0.45 * complexion.melanin * MELANIN)
    return [
        *_eye(texels, hair, wet),
        *_mouth(texels),
        *_nostril(texels),
        *_brow(texels, hair, grain, side),
        (hair, CROP * crop(texels, texels.points * [side, 1.0, 1.0])),
    ]


def _eye(texels: Texels, hair: Points, waterline: Points) -> list[Cover]:
    """The moist margins of the lids, and a thin shade where the lashes stand."""
    row, upper = texels.eye_row, texels.is_upper_lid
    inner = smooth_step(18.5, 23.0, texels.points[:, 0])  # lashes begin beside the inner corner
    wet = smooth_step(2.1, 1.7, row)
    roots = bump(row, 2.0, 0.16) * inner * (0.15 + 0.45 * upper)
    return [(waterline, 0.75 * wet), (hair, roots)]


def _mouth(texels: Texels) -> list[Cover]:
    """Behind the lips, and the line where they meet."""
    row = texels.mouth_row
    # Toward the corner the groove between the lips grows flat, and light would fall into it.
    x = np.abs(texels.points[:, 0])
    flat = smooth_step(lips.HALF_WIDTH - 9.0, lips.HALF_WIDTH - 2.0, x)
    shade = 0.75 * flat * smooth_step(2.5, 1.5, row)
    line = np.clip((2.6 + 0.9 * flat - row) / (0.6 + 0.9 * flat), 0.0, 1.0)
    return [
        (to_linear(LINE_OF_LIPS), (0.46 + 0.24 * flat) * line * smooth_step(1.3, 1.9, row)),
        (to_linear(MUCOSA), smooth_step(2.0, 1.4, row)),
        (to_linear(MUCOSA_DEEP), np.maximum(smooth_step(1.3, 0.1, row), shade)),
    ]


def _nostril(texels: Texels) -> list[Cover]:
    return [(to_linear(NOSTRIL), 0.92 * smooth_step(0.02, 0.45, texels.nostril))]


def _brow(texels: Texels, hair: Points, grain: float, side: int) -> list[Cover]:
    cover, lightness, tint = brow_cover(texels.points, grain, side)
    strands = hair * (0.75 + 0.95 * lightness[:, None])
    return [(1.25 * hair, 0.20 * tint), (strands, cover)]
