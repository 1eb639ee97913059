"""What differs from side to side of a face: pores, blotches, freckles; and hair on the scalp.

A face has no even skin: blood and pigment come in patches of all sizes, which overlap. Pores are
too small for the picture of a whole head to hold all of them. They are painted as the light that
falls from above shows them, a dark rim over a light one. Nothing here lies along the axes: a
lattice of noise that does shows as a weave on a brow that faces forward.
"""

import numpy as np
import scipy

from .fields import Points, Values, bump, smooth_step, unit
from .noise import noise
from .regions import scalp
from .texels import Texels

PORES, LINES = 0.15, 0.05  # density
PORE_COUNT = 26000  # on each side, behind the ears too
PORE_RADII = (0.28, 0.62)  # [mm]; smaller ones are no texel wide
# Of a lattice of noise, out of all planes of the face; again and again it never comes back.
TURN = np.linalg.qr(np.array([[0.62, -0.55, 0.56], [0.71, 0.69, -0.11], [-0.33, 0.47, 0.82]]))[0]
LIFT = np.array([0.05, 0.42, 0.12])  # [mm] between a pore's dark side and its light one
# Size of patches [mm], and how much melanin and blood they have.
PATCHES = ((34.0, 0.020, 0.050), (15.0, 0.022, 0.065), (6.5, 0.022, 0.060), (2.9, 0.018, 0.045))
FRECKLES, SEED = 300, 11
FRECKLE_RADII = (0.3, 0.8)  # [mm]
CENTRE, WHORL = np.array([0.0, 30.0, -5.0]), np.array([5.0, 118.0, -48.0])  # of the hair
# Widths of strands and of tufts [mm], how much each shows in front, and behind: texels are coarse
# there, and what is finer than they are would be seen as dabs.
STRANDS = ((0.45, 0.75, 0.0), (0.85, 0.50, 0.15), (1.8, 0.20, 0.45))
LONGER = 0.075  # how much slower strands change along themselves
FRAYED = 0.07  # how far they stand out of the line of hair, in shares of its width


def pores(points: Points) -> Values:
    """Melanin of pores and of the fine lines between them, shape (n,)."""
    x, y, z = np.abs(points[:, 0]), points[:, 1], points[:, 2]
    seen = smooth_step(-25.0, 45.0, z)  # behind, texels are coarser than pores
    # Coarsest on the nose and beside it, fine on the lids and toward the jaw.
    oily = bump(x, 0.0, 26.0) * bump(y, -32.0, 26.0) + 0.5 * bump(y, 48.0, 26.0) * bump(
        x, 0.0, 40.0
    )
    lid = bump(y, 3.0, 11.0) * smooth_step(13.0, 17.0, x)
    strength = (0.55 + 0.75 * oily) * (1.0 - 0.6 * lid)
    holes = _holes(points)
    turned = points @ TURN
    lines = noise(turned + LIFT @ TURN, 2.3, seed=43) - noise(turned, 2.3, seed=43)
    fine = noise(turned @ TURN, 0.8, seed=42)
    relief = PORES * (1.25 * holes[0] - 0.9 * holes[1]) + LINES * (lines + 0.4 * fine)
    return np.asarray(seen * strength * relief, dtype=np.float64)


def _holes(points: Points) -> list[Values]:
    """How deep in a round pore lie points, and points `LIFT` from them, 0 to 1, shape (n,) each."""
    random = np.random.default_rng(SEED + int(points[0, 0] < 0.0))
    count = min(PORE_COUNT, len(points))  # a small picture has fewer texels
    centres = points[random.choice(len(points), count, replace=False)]
    radii = PORE_RADII[0] + np.ptp(PORE_RADII) * random.uniform(0.0, 1.0, count) ** 2
    depths = random.uniform(0.35, 1.0, count)
    tree = scipy.spatial.cKDTree(centres)
    found = []
    for way in (0.0 * LIFT, LIFT):
        away, nearest = tree.query(points + way, distance_upper_bound=2.0 * PORE_RADII[1])
        is_near = nearest < count
        nearest = np.where(is_near, nearest, 0)
        found.append(depths[nearest] * np.exp(-((away / radii[nearest]) ** 2)) * is_near)
    return found


def blotches(points: Points) -> tuple[Values, Values]:
    """Melanin and blood of the patches, each of shape (n,)."""
    melanin, blood = np.zeros((2, len(points)))
    flushed = bump(np.abs(points[:, 0]), 42.0, 26.0) * bump(points[:, 1], -26.0, 20.0)
    veined = smooth_step(0.1, 0.9, noise(points @ TURN, 4.2, seed=81)) * smooth_step(
        20.0, 60.0, points[:, 2]
    )
    in_front = smooth_step(-40.0, 30.0, points[:, 2])
    seen = np.ones(len(points))
    for number, (size, brown, red) in enumerate(PATCHES):
        points = points @ TURN
        melanin += seen * brown * noise(points, size, seed=61 + number)
        blood += seen * red * noise(points, size, seed=171 + number)
        seen = in_front  # of all but the largest
    return melanin, blood * (1.0 + 0.8 * flushed) + 0.07 * flushed * veined


def freckles(texels: Texels, points: Points, seed: int) -> Values:
    """Small brown spots on cheeks, nose and forehead, other ones on either side."""
    random = np.random.default_rng(seed)
    x, y, z = np.abs(points[:, 0]), points[:, 1], points[:, 2]
    likely = bump(y, -20.0, 20.0) * bump(x, 26.0, 26.0) + 0.25 * bump(y, 45.0, 25.0)
    likely = likely * (z > 50.0) * (texels.eye_row > 4.5) * (texels.mouth_row > 7.0)
    centres = points[random.choice(len(points), FRECKLES, replace=False, p=likely / likely.sum())]
    radii = random.uniform(*FRECKLE_RADII, FRECKLES)
    strengths = 0.03 + 0.2 * random.uniform(0.0, 1.0, FRECKLES) ** 2
    tree = scipy.spatial.cKDTree(points)
    total = np.zeros(len(points))
    for centre, radius, strength in zip(centres, radii, strengths, strict=True):
        near = np.array(tree.query_ball_point(centre, 2.0 * radius), dtype=np.int64)
        away = np.linalg.norm(points[near] - centre, axis=1)
        total[near] += strength * smooth_step(1.5 * radius, 0.3 * radius, away)
    return total


def crop(texels: Texels, points: Points) -> Values:
    """How much of the scalp short hair covers, 0 to 1: strands that leave a whorl on the crown."""
    axis = unit((WHORL - CENTRE)[None])[0]
    side = unit(np.cross(axis, [0.0, 0.0, 1.0])[None])[0]
    away = unit(points - CENTRE)
    along = np.arccos(np.clip(away @ axis, -1.0, 1.0))
    turn = np.arctan2(away @ np.cross(axis, side), away @ side) + 0.25 * along
    place = np.stack([62.0 * np.cos(turn), 62.0 * np.sin(turn), LONGER * 90.0 * along], axis=1)
    in_front = smooth_step(10.0, 50.0, points[:, 2])
    strand = np.zeros(len(points))
    for number, (width, front, behind) in enumerate(STRANDS):
        share = behind + (front - behind) * in_front
        strand += share * noise(place, width, seed=91 + number)
    strand *= smooth_step(0.0, 0.6, along)  # at the whorl they would be rays
    dense = scalp(texels)
    # Toward the line there are fewer hairs, not shorter ones: more and more skin between them.
    grown = smooth_step(0.02, 0.55, dense + FRAYED * strand * smooth_step(0.0, 0.05, dense))
    sparse = smooth_step(0.95, 0.25, dense)
    between = 0.91 - 0.31 * sparse + (0.17 + 0.38 * sparse) * strand
    return np.asarray(grown * np.clip(between, 0.0, 1.0), dtype=np.float64)
