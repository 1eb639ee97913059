"""Where skin wrinkles, which way, and how its furrows lie: the lines of expression by region.

Wrinkles lie across the muscle that makes them, where its contraction shortens the skin: level on
the forehead above the upright frontalis, upright between the brows beside the level corrugator, a
fan at the outer corner of the eye around its ring muscle. So a region says two things of a place on
the face: `across`, the direction in which skin shortens there when it folds, and the depth of
furrows whose lines run at right angles to it. Furrows wander, break off, and differ in depth; none
of them is alike left and right. All numbers were chosen by eye.

Regions of different direction lie side by side, so there are two slots for them.

Sources: Kraissl 1951, "The selection of appropriate lines for elective surgical incisions" (lines
of wrinkling lie across the pull of the muscles); Lemperle et al. 2001, "A classification of facial
wrinkles" (which there are); Ekman, Friesen 1978 (which action unit makes which).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from . import lips
from .fields import Points, Values, bump, smooth_step, unit
from .form import EYE_CENTRE, fold_side
from .noise import noise

SLOTS = 2
EYE_HUB = np.array([37.0, 1.0, 77.0])  # [mm] that crow's feet point to, behind the corner
MOUTH_HEIGHT = -66.5  # [mm] of what lines around the lips point to
CHIN_HEIGHT = -101.0
ROLL = 0.27  # half width of the trough between two rolls of skin, in spacings
UP, ASIDE = np.array([0.0, 1.0, 0.0]), np.array([1.0, 0.0, 0.0])


class LineFamily(NamedTuple):
    """How the furrows of a family lie."""

    spacing: float  # [mm] from one to the next, about
    width: float  # [mm] from the bottom to where a third of the depth is left
    depth: float  # [mm] of the deepest
    breaks: float  # [mm] along a line over which its depth changes
    fullness: float = 0.6  # share of the depth that a line has in the mean
    swelling: float = 0.0  # height of the roll between two over the depth


class Furrows(NamedTuple):
    """Skin with furrows at n places."""

    depth: Values  # (n,) of furrows [mm]
    height: Values  # (n,) of the skin [mm]: 0 between furrows, and raised a little beside them
    roll: Values | float = 0.0  # (n,) broad height of skin that swells between furrows [mm]


class Crease(NamedTuple):
    """One region at n places of the left half."""

    slot: int
    near: Values  # (n,) in its slot the nearest region counts; reaches further than cover
    across: Points  # (n, 3) unit direction in which skin shortens there
    readiness: float  # how much of a wrinkle a given shortening makes
    cover: Values  # (n,) 0..1, where furrows are seen, and 0 far from them
    furrows: Furrows


def furrows_of(
    lines: LineFamily,
    place: Values,
    along: Values,
    seed: int,
    is_other: npt.NDArray[np.bool_] | None = None,
) -> Furrows:
    """Lay furrows at about every multiple of the spacing.

    place, along: across and along the lines [mm], shape (n,); is_other: where lines are not the
    continuation of those of the same place elsewhere, as on the other side of the face.
    """
    number = np.rint(place / lines.spacing)
    line = number if is_other is None else number + 1000.0 * is_other
    zero = np.zeros_like(line)
    of_line = np.column_stack([71.3 * line, zero, zero])
    on_line = np.column_stack([3.7 * lines.breaks * line, along, zero])
    shift = 0.14 * lines.spacing * noise(of_line, 1.0, seed=seed)
    ragged = noise(on_line, lines.breaks, seed=seed + 1)
    ragged += 0.4 * noise(on_line, 0.3 * lines.breaks, seed=seed + 2)
    share = lines.fullness + 0.6 * ragged + 0.25 * noise(of_line, 1.0, seed=seed + 3)
    from_middle = place - number * lines.spacing
    # Half way to the next line, where `number` jumps, nothing is left of either.
    window = smooth_step(0.5 * lines.spacing, 0.3 * lines.spacing, np.abs(from_middle))
    deepest = lines.depth * smooth_step(0.0, 1.0, share) * window
    off = np.abs(from_middle - shift) / lines.width
    depth = deepest * bump(off, 0.0, 1.0)
    trough = bump(np.abs(from_middle - shift), 0.0, ROLL * lines.spacing)
    roll = lines.swelling * (0.5 * lines.fullness * lines.depth - deepest * trough)
    return Furrows(depth, 0.3 * deepest * bump(off, 2.1, 1.2) - depth, roll)


def add_furrows(first: Furrows, second: Furrows) -> Furrows:
    """Two families of furrows in one skin."""
    depth, height, roll = (one + other for one, other in zip(first, second, strict=True))
    return Furrows(np.asarray(depth), np.asarray(height), roll)


def line_wander(points: Points, reach: float, size: float, seed: int) -> Values:
    """How far lines wander from their course [mm], shape (n,)."""
    fine = noise(points, 0.35 * size, seed=seed + 1)
    return reach * (noise(points, size, seed=seed) + 0.35 * fine)


def plateau(values: Values, start: float, full: float, fade: float, end: float) -> Values:
    """Rise from `start` to `full` and fall from `fade` to `end`, from 0 to 1 and back."""
    return smooth_step(start, full, values) * smooth_step(end, fade, values)


def forehead(points: Points, seed: int) -> Crease:
    """Lines across the forehead: frontalis (AU1, AU2)."""
    x, y, z = np.abs(points[:, 0]), points[:, 1], points[:, 2]
    brow = 26.5 + 2.0 * bump(x, 32.0, 14.0) - 3.0 * smooth_step(42.0, 54.0, x)
    cover = smooth_step(0.0, 7.0, y - brow) * smooth_step(74.0, 60.0, y)
    cover = cover * smooth_step(58.0, 36.0, x) * smooth_step(40.0, 60.0, z)
    cover = cover * (1.0 - smooth_step(41.0, 36.0, y) * smooth_step(19.0, 12.0, x))  # glabella
    place = y + 0.05 * np.maximum(y - 45.0, 0.0) ** 1.5  # the forehead leans back
    place = place - 2.4 * (bump(x, 27.0, 17.0) + bump(x, -27.0, 17.0))  # arches over the brows
    place = place + line_wander(points, 1.7, 23.0, seed)
    main = furrows_of(
        LineFamily(9.0, 1.3, 0.37, 30.0, swelling=1.9), place, points[:, 0], seed + 10
    )
    fine = furrows_of(LineFamily(4.1, 0.7, 0.11, 15.0, 0.25), place + 2.6, points[:, 0], seed + 20)
    near = smooth_step(16.0, 30.0, y) + 1e-3 * (y > 10.0)
    return Crease(0, near, np.tile(UP, (len(points), 1)), 1.0, cover, add_furrows(main, fine))


def glabella(points: Points, seed: int) -> Crease:
    """Upright lines between the brows: corrugator (AU4)."""
    x, y = np.abs(points[:, 0]), points[:, 1]
    side = np.where(points[:, 0] < 0.0, -1.0, 1.0)
    cover = plateau(y, 9.0, 15.0, 26.0, 36.0) * smooth_step(15.0, 9.0, x)
    place = x - 0.13 * (y - 18.0) * smooth_step(0.0, 6.0, x)
    wander = line_wander(points, 0.9, 13.0, seed)
    # Two main lines rise from the heads of the brows; fainter ones stand beside.
    main = furrows_of(
        LineFamily(11.0, 1.2, 0.55, 30.0, 0.9, swelling=2.2),
        place - 5.6 + wander,
        y,
        seed + 10,
        side < 0.0,
    )
    fine = furrows_of(LineFamily(3.3, 0.6, 0.09, 12.0, 0.35), side * place + wander, y, seed + 20)
    near = plateau(y, 5.0, 12.0, 36.0, 50.0) * smooth_step(24.0, 14.0, x)
    return Crease(1, near, np.tile(ASIDE, (len(points), 1)), 1.0, cover, add_furrows(main, fine))


def nose_root(points: Points, seed: int) -> Crease:
    """Lines across the root of the nose and down its sides: procerus, nasalis (AU9)."""
    x, y = np.abs(points[:, 0]), points[:, 1]
    on_bridge = smooth_step(12.0, 3.5, x) * plateau(y, -8.0, -2.0, 6.0, 10.0)
    beside = plateau(x, 3.0, 6.5, 12.5, 17.0) * plateau(y, -27.0, -20.0, -4.0, 1.0)
    # Across the root they are level; on the sides they sink toward the cheek.
    place = y + 0.42 * np.maximum(x - 4.0, 0.0) * smooth_step(2.0, -6.0, y)
    place = place + 0.012 * x**2 + line_wander(points, 0.8, 9.0, seed)
    main = furrows_of(
        LineFamily(4.4, 0.85, 0.28, 10.0, swelling=1.5), place, points[:, 0], seed + 10
    )
    fine = furrows_of(LineFamily(2.0, 0.45, 0.06, 6.0, 0.35), place + 1.0, points[:, 0], seed + 20)
    tilt = smooth_step(3.0, 8.0, x) * smooth_step(4.0, -6.0, y)
    across = unit(UP + 0.42 * tilt[:, None] * ASIDE)
    near = smooth_step(20.0, 12.0, x) * plateau(y, -36.0, -26.0, 8.0, 16.0)
    return Crease(0, near, across, 1.0, np.maximum(on_bridge, beside), add_furrows(main, fine))


def crows_feet(points: Points, seed: int) -> Crease:
    """A fan at the outer corner of the eye: orbicularis oculi (AU6)."""
    is_other = points[:, 0] < 0.0
    away = points * np.where(is_other[:, None], [-1.0, 1.0, 1.0], 1.0) - EYE_HUB
    aside = np.hypot(away[:, 0], away[:, 2]) * np.sign(away[:, 0])
    up = away[:, 1] + 0.10 * aside  # the fan sinks a little outward
    radius, angle = np.hypot(aside, up), np.arctan2(up, aside)
    cover = plateau(radius, 11.0, 16.0, 20.0, 34.0) * plateau(angle, -1.05, -0.65, 0.50, 0.80)
    place = 17.0 * angle + line_wander(points, 0.9, 12.0, seed)
    main = furrows_of(
        LineFamily(3.9, 0.58, 0.26, 11.0, swelling=1.2), place, radius, seed + 10, is_other
    )
    fine = furrows_of(
        LineFamily(2.0, 0.45, 0.06, 7.0, 0.4), place + 1.3, radius, seed + 20, is_other
    )
    level = unit(away * [1.0, 0.0, 1.0])
    across = np.cos(angle)[:, None] * UP - np.sin(angle)[:, None] * level
    near = (
        plateau(radius, 6.0, 11.0, 36.0, 48.0)
        * plateau(angle, -1.5, -1.1, 0.8, 1.3)
        * (aside > 0.0)
    )
    return Crease(0, near, unit(across), 1.7, cover, add_furrows(main, fine))


def lower_lid(points: Points, seed: int) -> Crease:
    """Fine arcs under the eye, where the cheek comes up: orbicularis oculi (AU6, AU7)."""
    x, y = np.abs(points[:, 0]), points[:, 1]
    away = np.column_stack([x, y]) - EYE_CENTRE[:2]
    radius, angle = np.hypot(away[:, 0], 1.25 * away[:, 1]), np.arctan2(away[:, 1], away[:, 0])
    cover = plateau(radius, 11.0, 13.5, 20.0, 27.0) * smooth_step(-4.0, -8.0, y)
    cover = cover * plateau(x, 17.5, 22.0, 42.0, 50.0)
    place = radius + 1.2 * angle + line_wander(points, 0.7, 11.0, seed)
    found = furrows_of(
        LineFamily(3.1, 0.55, 0.17, 9.0), place, 14.0 * angle, seed + 10, points[:, 0] < 0.0
    )
    across = unit(np.column_stack([away, np.zeros_like(x)]))
    near = plateau(radius, 8.0, 11.0, 28.0, 36.0) * smooth_step(2.0, -4.0, y)
    near = near * smooth_step(8.0, 14.0, x)
    return Crease(1, near, across, 1.0, cover, found)


def smile_lines(points: Points, seed: int) -> Crease:
    """The nasolabial fold and brackets beside the mouth: zygomatici, levators (AU10, AU12)."""
    x, y, z = np.abs(points[:, 0]), points[:, 1], points[:, 2]
    sides, slope = fold_side(y)
    beside = x - sides
    lean = 1.0 / np.sqrt(1.0 + slope**2)
    place = lean * beside + line_wander(points, 0.6, 16.0, seed)
    along = plateau(y, -88.0, -66.0, -41.0, -34.5)
    crease = bump(place, -0.4, 1.7) * along
    # Lip side hollow, cheek side full: the cheek hangs over the crease. It is so broad that it has
    # to end gently, or its end would be a wrinkle of its own.
    full = plateau(y - 0.5 * place, -92.0, -62.0, -50.0, -34.0)
    fold = 0.95 * full * bump(place, 5.5, 4.5) - 1.15 * along * bump(place, -0.6, 2.6)
    bracket = bump(place - 0.08 * (y + 66.0), 7.5, 1.4) * plateau(y, -82.0, -70.0, -57.0, -47.0)
    outer = bump(place - 0.12 * (y + 62.0), 14.5, 1.0) * plateau(y, -76.0, -66.0, -54.0, -44.0)
    ragged = np.clip(0.75 + 0.35 * noise(points, 9.0, seed=seed + 3), 0.0, 1.0)
    depth = 0.35 * crease + ragged * (0.20 * bracket + 0.12 * outer)
    across = np.column_stack([lean, -lean * slope, np.zeros_like(x)])
    near = plateau(beside, -16.0, -8.0, 24.0, 34.0) * plateau(y, -98.0, -88.0, -40.0, -33.0)
    near = near * smooth_step(4.0, 10.0, x)  # none on the middle, which has no side
    cover = smooth_step(40.0, 56.0, z) * plateau(place, -7.0, -4.0, 17.0, 20.0)
    cover = cover * plateau(y, -91.0, -87.0, -36.0, -32.0)
    return Crease(0, near, across, 1.6, cover, Furrows(depth, -depth, fold))


def chin(points: Points, seed: int) -> Crease:
    """Dimples on the chin: mentalis (AU17)."""
    x, y, z = points.T
    away = np.hypot(x / 18.0, (y - CHIN_HEIGHT) / 12.0)
    cover = smooth_step(1.45, 0.35, away) * smooth_step(60.0, 75.0, z)
    coarse, fine = noise(points, 5.0, seed=seed), noise(points, 2.6, seed=seed + 1)
    height = 0.26 * coarse + 0.10 * fine
    near = smooth_step(1.9, 1.2, away)
    across = np.tile(ASIDE, (len(points), 1))
    return Crease(0, near, across, 1.6, cover, Furrows(np.maximum(-height, 0.0), height))


def mental_crease(points: Points, seed: int) -> Crease:
    """The crease between lower lip and chin: mentalis, depressor anguli oris (AU15, AU17)."""
    x, y = points[:, 0], points[:, 1]
    place = y + 87.5 + 0.012 * x**2 + line_wander(points, 0.5, 9.0, seed)
    ragged = np.clip(0.75 + 0.3 * noise(points, 8.0, seed=seed + 3), 0.0, 1.0)
    depth = ragged * (0.40 * bump(place, 0.0, 1.5) + 0.14 * bump(place, -4.2, 0.9))
    cover = smooth_step(19.0, 8.0, np.abs(x)) * plateau(place, -8.0, -5.0, 4.0, 6.0)
    near = smooth_step(9.0, 4.0, np.abs(place)) * smooth_step(30.0, 20.0, np.abs(x))
    return Crease(0, near, np.tile(UP, (len(points), 1)), 1.0, cover, Furrows(depth, -depth))


def above_lip(points: Points, seed: int, mouth_row: Values) -> Crease:
    """Fine lines that rise from the upper lip: orbicularis oris (AU18).

    Those below the lower one would lie in its shadow, and look like hair.
    """
    x, y = np.abs(points[:, 0]), points[:, 1]
    side = np.where(points[:, 0] < 0.0, -1.0, 1.0)
    away = np.column_stack([x, y - MOUTH_HEIGHT])
    off = np.hypot(x / (lips.HALF_WIDTH + 3.0), away[:, 1] / 11.5)
    cover = smooth_step(6.02, 6.4, mouth_row) * smooth_step(1.65, 1.0, off) * (away[:, 1] > 0.0)
    cover = cover * smooth_step(24.0, 14.0, x) * (1.0 - 0.75 * bump(x, 0.0, 3.0))  # the philtrum
    angle = np.arctan2(1.55 * away[:, 1], x)
    place = 21.0 * side * (0.5 * np.pi - angle) + line_wander(points, 0.6, 7.0, seed)
    found = furrows_of(LineFamily(2.8, 0.55, 0.20, 14.0, 0.8), place, 16.0 * off, seed + 10)
    across = unit(np.column_stack([-away[:, 1], x, np.zeros_like(x)]))
    return Crease(1, smooth_step(3.2, 2.2, off), across, 1.0, cover, found)


REGIONS: tuple[Callable[[Points, int], Crease], ...] = (
    forehead,
    glabella,
    nose_root,
    crows_feet,
    lower_lid,
    smile_lines,
    chin,
    mental_crease,
)


def creases(points: Points, mouth_row: Values) -> list[Crease]:
    """All regions at places on the face, shape (n, 3) [mm]; mouth_row: as in `Texels`."""
    found = [region(points, 100 * k) for k, region in enumerate(REGIONS)]
    found.append(above_lip(points, 900, mouth_row))
    side = np.where(points[:, :1] < 0.0, [-1.0, 1.0, 1.0], 1.0)
    front = smooth_step(10.0, 30.0, points[:, 2])
    return [
        crease._replace(
            near=front * crease.near, across=side * crease.across, cover=front * crease.cover
        )
        for crease in found
    ]
