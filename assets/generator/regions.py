"""Where on the face skin is redder, darker, hairy or wet: maps of amounts, each of shape (n,).

Everything is a function of the place on the left half; the right half is its mirror image.
"""

import numpy as np
import scipy

from . import lips
from .fields import Points, Values, bump, smooth_step
from .noise import noise
from .texels import Texels

Triple = tuple[float, float, float]
Spot = tuple[Triple, Triple, float]

# Lines around the head: angle about its axis [deg], height along the capsule [mm].
HAIRLINE = (
    (0, 66), (14, 67), (28, 70), (40, 68), (50, 57), (57, 44), (62, 34), (68, 28), (74, 23),
    (79, 10), (82, -8), (86, -18), (91, -21), (95, -19), (99, -4), (103, 10), (109, 18), (117, 16),
    (123, 2), (126, -20), (131, -52), (138, -78), (150, -90), (180, -94),
)  # fmt: skip
BEARD_LINE = (
    (0, -46), (9, -48), (16, -53), (24, -62), (34, -66), (46, -64), (58, -56), (70, -42),
    (79, -24), (86, -14), (95, -18), (104, -52), (112, -80),
)  # fmt: skip
BEARD_END = -133.0  # [mm] height on the throat
# Flushed places: centre (x, y, z) and radii [mm], amount of blood.
FLUSHED = (
    ((42, -25, 80), (21, 15, 28), 0.18),  # cheek
    ((28, -24, 90), (15, 12, 16), 0.14),
    ((0, -35, 121), (11, 9, 12), 0.28),  # tip of the nose
    ((15, -40, 103), (6.5, 8, 9), 0.40),  # its wing
    ((0, -17, 105), (8, 14, 9), 0.10),  # its ridge
    ((0, -103, 99), (12, 8, 14), 0.14),  # chin
    ((68, -14, 0), (12, 26, 14), 0.08),  # in front of the ear
    ((0, 20, 97), (13, 9, 10), 0.08),  # between the brows
)
PALER = (
    ((0, 50, 96), (48, 24, 40), -0.16),  # forehead
    ((30, -8.5, 84), (13, 5, 8), -0.06),  # below the eye
    ((12, -58, 100), (14, 8, 12), -0.07),  # around the mouth
    ((14, -86, 92), (16, 7, 14), -0.08),
    ((46, -78, 60), (22, 20, 30), -0.09),  # jaw
    ((0, -150, 50), (60, 25, 60), -0.05),  # neck
)
# Browner places, and less so
TANNED = (
    ((31, -9.5, 84), (14, 4.5, 8), 0.11),  # below the eye
    ((20, -4, 82), (6, 5, 6), 0.10),  # its inner corner
    ((31, 9.5, 85), (14, 6.5, 10), 0.07),  # upper lid
    ((50, 0, 70), (7, 5, 8), 0.05),  # outer corner
    ((0, 56, 92), (50, 26, 60), 0.055),
    ((60, 16, 55), (16, 20, 24), 0.03),  # temple
    ((0, -150, 50), (60, 25, 60), 0.05),
    ((25, -76, 92), (7, 6, 8), 0.05),  # below the corner of the mouth
    # Light breaks off at the chin's edge: less so if that is darker, and what follows lighter.
    ((0, -106.8, 97), (9, 2.2, 5), 0.18),
    ((0, -112.5, 91), (18, 4, 7), -0.22),
)

# From the foot of the wing around and over it: place [mm] and how deep the groove is there.
ALAR_GROOVE = (
    (12.4, -44.7, 100.3, 0.5), (15.3, -42.0, 99.1, 0.9), (15.8, -39.0, 97.7, 1.0),
    (15.2, -35.6, 97.1, 1.0), (13.6, -32.3, 98.5, 0.9), (11.6, -30.2, 102.4, 0.6),
    (9.4, -29.0, 107.4, 0.15),
)  # fmt: skip


def _spots(points: Points, table: tuple[Spot, ...]) -> Values:
    total = np.zeros(len(points))
    for centre, radii, amount in table:
        away = ((points - np.array(centre)) / np.array(radii)) ** 2
        total += amount * np.exp(-away.sum(axis=1))
    return total


def line_height(line: tuple[tuple[int, int], ...], angle: Values) -> Values:
    """Height of a line around the head at an angle [mm], its corners rounded."""
    table = np.array(line, dtype=np.float64)
    spread = np.linspace(-5.0, 5.0, 7)
    heights = [np.interp(np.abs(angle + turn), table[:, 0], table[:, 1]) for turn in spread]
    return np.asarray(np.mean(heights, axis=0), dtype=np.float64)


def red(texels: Texels) -> Values:
    """The red of the lips, 1 inside; its border is soft, on the lower lip more than above."""
    x, y = np.abs(texels.points[:, 0]), texels.points[:, 1]
    inside = np.minimum(x, lips.HALF_WIDTH - 0.05)
    past_corner = np.maximum(x - lips.HALF_WIDTH, 0.0)
    above = lips.upper_border(inside) - y
    below = y - lips.lower_border(inside)
    edge = 0.30 * noise(texels.points, 1.3, seed=21) + 0.2 * noise(texels.points, 0.6, seed=25)
    upper = smooth_step(-0.9, 1.5, above + edge - past_corner)
    lower = smooth_step(-1.5, 2.4, below + edge - past_corner)
    toward_corner = smooth_step(lips.HALF_WIDTH + 0.6, lips.HALF_WIDTH - 5.0, x)
    in_front = np.minimum(upper, lower) * toward_corner * (texels.mouth_row < 7.6)
    return np.where(texels.mouth_row < 2.0, 1.0, in_front)


def blood(texels: Texels) -> Values:
    """Blood in the skin, 0.3 on average; the lips are added by the painter."""
    points = texels.points
    lid = smooth_step(4.6, 2.6, texels.eye_row)
    rim = bump(texels.ear_row, 1.4, 0.9) * smooth_step(0.3, 0.9, texels.ear_row)
    ear = 0.15 * smooth_step(0.1, 0.8, texels.ear_row) + 0.26 * rim
    ear += 0.06 * smooth_step(-28.0, -38.0, points[:, 1]) * (texels.ear_row > 0.5)  # its lobe
    ear += 0.20 * smooth_step(4.2, 5.0, texels.ear_row)
    fold = bump(texels.points[:, 0] - np.interp(points[:, 1], (-46, -35), (15.2, 16.4)), 0.0, 2.2)
    fold *= bump(points[:, 1], -41.0, 5.5) * (points[:, 2] < 102.0)
    result: Values = (
        0.32 + _spots(points, FLUSHED) + _spots(points, PALER) + 0.16 * lid + 0.15 * fold
    )
    result += ear
    return np.maximum(result, 0.02)


def tan(texels: Texels) -> Values:
    """Melanin beside that of the tone."""
    points = texels.points
    hollow = 0.20 * bump(texels.ear_row, 3.0, 0.6) + 0.80 * smooth_step(4.05, 5.0, texels.ear_row)
    return np.asarray(_spots(points, TANNED) + hollow, dtype=np.float64)


def alar_groove(points: Points) -> Values:
    """How deep in the groove around the wing of the nose points lie, 0 to 1, shape (n,)."""
    ends = np.arange(len(ALAR_GROOVE))
    table = scipy.interpolate.CubicSpline(ends, np.array(ALAR_GROOVE))(
        np.linspace(0.0, ends[-1], 160)
    )
    away, nearest = scipy.spatial.cKDTree(table[:, :3]).query(
        np.abs(points) * [1, 0, 0] + points * [0, 1, 1]
    )
    return np.asarray(table[nearest, 3] * np.exp(-((away / 1.8) ** 2)), dtype=np.float64)


def behind_hairline(texels: Texels) -> Values:
    """How far behind the hairline texels lie [mm], which is frayed; below 0 in front of it."""
    frayed = 2.2 * noise(texels.points, 7.0, seed=5) + 0.7 * noise(texels.points, 1.6, seed=6)
    return texels.height - line_height(HAIRLINE, texels.angle) + frayed


def scalp(texels: Texels) -> Values:
    """How densely the scalp is haired, 0 to 1."""
    dense = smooth_step(-5.0, 30.0, behind_hairline(texels)) ** 0.8
    return dense * smooth_step(0.35, 0.0, texels.ear_row)


def beard(texels: Texels) -> Values:
    """How densely the shaved beard stands, 0 to 1: lip, cheek below its line, chin, throat."""
    x, y = np.abs(texels.points[:, 0]), texels.points[:, 1]
    frayed = 2.0 * noise(texels.points, 4.0, seed=7)
    below = line_height(BEARD_LINE, texels.angle) - texels.height + frayed
    growth = smooth_step(-2.0, 11.0, below) * smooth_step(BEARD_END - 12.0, BEARD_END + 24.0, y)
    inside = np.minimum(x, lips.HALF_WIDTH)
    from_lip = np.maximum(y - lips.upper_border(inside), lips.lower_border(inside) - y)
    from_lip = np.where(x > lips.HALF_WIDTH, np.hypot(x - lips.HALF_WIDTH, from_lip), from_lip)
    growth *= smooth_step(0.8, 4.5, from_lip)
    growth *= 1.0 - 0.45 * bump(x, 0.0, 2.5) * bump(y, -53.0, 6.0)  # philtrum
    growth *= 1.0 - 0.6 * bump(x, 14.0, 7.0) * bump(y, -84.0, 5.0)  # beside the tuft
    growth *= smooth_step(0.3, 0.0, texels.ear_row)
    return np.asarray(growth * (texels.mouth_row > 6.0), dtype=np.float64)
