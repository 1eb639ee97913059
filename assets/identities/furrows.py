"""Choose random courses and depths of a person's lines: forehead, between brows, beside eyes.

Lines run perpendicular to the pull of muscles (Kraissl 1951): horizontally on the forehead, upright
between the brows, as a fan beside the eye. The course and the depth of a line are functions of a
coordinate along the line. All lengths are chosen by eye in comparison with the built-in head.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...geometry.arrays import Floats64
from ...geometry.steps import smoothstep
from ..smooth import bump
from .lines import ExpressionLines, Fan, Spread

SAMPLE_SPACING = 0.5  # [mm] between samples along a line
FOREHEAD_REACH = -62.0, 62.0  # [mm]; x of the first and the last sample
GLABELLA_REACH = 0.0, 50.0  # [mm]; y of the first and the last sample
FEET_REACH = 5.0, 45.0  # [mm]; distances of the first and the last sample from the fan's hub
FAN_ANGLES = {  # smallest and greatest angle of crow's feet above the horizontal [rad]
    Fan.WHOLE: (-0.95, 0.5),
    Fan.LOWER: (-0.75, 0.1),
    Fan.CENTRAL: (-0.45, 0.3),
    Fan.UPPER: (-0.15, 0.55),
}


class FurrowLine(NamedTuple):
    """An expression line, sampled along its region.

    course: coordinate across the region at each sample, [mm] or [rad], (s,).
    depth: depth at each sample [mm], (s,).
    width: half width of the furrow [mm].
    roll: half width of a broad trough around the furrow [mm]; skin beyond the trough looks swollen.
    swelling: depth of the trough, as a fraction of the furrow's depth.
    """

    course: Floats64
    depth: Floats64
    width: float
    roll: float
    swelling: float


def forehead_lines(lines: ExpressionLines, random: np.random.Generator) -> list[FurrowLine]:
    """Choose random lines of the forehead; some are broken into two halves of unequal height."""
    x = _sample_coordinates(FOREHEAD_REACH)
    # [mm] above the root of the nose, along the skin.
    lowest = 36.5
    highest = 70.0
    spacing = (highest - lowest) / lines.forehead
    spread = min(spacing, 11.0)
    middle = 0.5 * (highest + lowest) + random.uniform(-0.5, 0.5) * (spacing - spread)
    arch = 1.0 - bump(x, 0.0, 16.0) - 0.8 * smoothstep(np.abs(x), 30.0, 58.0)
    tilt = random.normal(0.0, 0.015)
    course = lines.dip * arch + tilt * x + 0.8 * _random_curve(45.0, x, random)
    deepest = 0.44 * lines.forehead_depth * (4.5 / lines.forehead) ** 0.35  # [mm]
    found = []
    for number in range(lines.forehead):
        place = middle + (number + 0.5 - 0.5 * lines.forehead) * spread
        place += 0.17 * spread * random.uniform(-1.0, 1.0)
        own = place + course + 0.45 * _random_curve(26.0, x, random)
        shown = _line_strength(lines.spread, np.abs(x + random.normal(0.0, 4.0)), random)
        waves = (0.12 + 0.28 * lines.broken) * _random_curve(44.0, x, random)
        whole = smoothstep(1.0 - 0.36 * lines.broken + waves, 0.0, 1.0)
        right_end, left_end = random.uniform(34.0, 54.0, 2)  # [mm] from the midline
        fading = 14.0  # [mm] over which a line fades at its ends
        reach = smoothstep(x, -right_end, -right_end + fading)
        reach = reach * smoothstep(x, left_end, left_end - fading)
        depth = deepest * random.uniform(0.65, 1.0) * whole * reach * shown
        if random.random() < 0.25 + 0.5 * lines.broken:
            gap = random.uniform(-20.0, 20.0)
            over = random.uniform(2.0, 8.0)  # [mm] of overlap of both halves
            step = random.choice([-1.0, 1.0]) * random.uniform(0.15, 0.26) * spread
            left = smoothstep(x, gap + over, gap - 5.0)
            right = smoothstep(x, gap - over, gap + 5.0)
            parts = [(own + step, depth * left), (own - step, depth * right)]
        else:
            parts = [(own, depth)]
        width = 2.3 * random.uniform(0.85, 1.15)
        found += [FurrowLine(*part, width, 0.45 * min(spread, 9.0) + 0.4, 1.9) for part in parts]
    for _ in range(lines.fine * lines.forehead):
        own = random.uniform(lowest, highest) + course + 0.8 * _random_curve(20.0, x, random)
        centre = random.uniform(-35.0, 35.0)
        half = random.uniform(7.0, 18.0)
        depth = 0.1 * lines.forehead_depth * smoothstep(np.abs(x - centre), half, 0.3 * half)
        found.append(FurrowLine(course=own, depth=depth, width=1.2, roll=1.8, swelling=0.2))
    return found


def _line_strength(spread: Spread, beside: Floats64, random: np.random.Generator) -> Floats64:
    """Return a line's strength, 0 to 1, (s,); beside: distances from the midline [mm], (s,)."""
    reach = random.uniform(0.8, 1.25)
    match spread:
        case Spread.WHOLE:
            return np.ones_like(beside)
        case Spread.MIDDLE:
            return smoothstep(beside, 40.0 * reach, 18.0 * reach)
        case Spread.SIDES:
            return random.uniform(0.0, 0.3) + 0.7 * smoothstep(beside, 6.0 * reach, 28.0 * reach)


def frown_lines(lines: ExpressionLines, random: np.random.Generator) -> list[FurrowLine]:
    """Choose random upright lines between the brows, which diverge upward."""
    y = _sample_coordinates(GLABELLA_REACH)
    places = {1: (0.0,), 2: (-5.6, 5.6), 3: (-7.2, 0.4, 6.8)}[lines.frown]
    deepest = random.integers(len(places))
    deepest_of_all = 0.55 * lines.frown_depth * (0.75 if lines.frown > 2 else 1.0)  # [mm]
    found = []
    for number, place in enumerate(places):
        aside = place + random.normal(0.0, 0.9 if lines.frown > 1 else 1.8)
        own = aside * (1.0 + 0.02 * (y - 18.0))
        own += 0.45 * _random_curve(18.0, y, random)
        low = random.uniform(8.0, 11.0)
        high = random.uniform(29.0, 37.0)
        ends = smoothstep(y, low, low + 9.0) * smoothstep(y, high, high - 16.0)
        factor = 1.0 if number == deepest else 1.0 - lines.uneven * random.uniform(0.6, 1.2)
        depth = deepest_of_all * factor * ends * (1.0 + 0.12 * _random_curve(14.0, y, random))
        found.append(FurrowLine(course=own, depth=depth, width=1.7, roll=4.4, swelling=0.8))
    return found


def crows_feet(lines: ExpressionLines, random: np.random.Generator) -> list[FurrowLine]:
    """Choose random crow's feet of one side; some of them fork."""
    radius = _sample_coordinates(FEET_REACH)
    low, high = FAN_ANGLES[lines.fan]
    wide = (high - low) / lines.feet
    begin = 11.0  # [mm] from the hub, some millimetres behind the corner of the lids
    found = []
    for number in range(lines.feet):
        angle = low + (number + 0.5 + 0.25 * random.uniform(-1.0, 1.0)) * wide
        own = angle + random.normal(0.0, 0.006) * (radius - 20.0)
        own += 0.45 * _random_curve(16.0, radius, random) / radius
        start = begin + random.uniform(0.0, 3.0)
        end = begin + lines.reach * random.uniform(0.55, 1.0)
        shown = smoothstep(radius, start - 2.0, start + 5.0)
        shown = shown * smoothstep(radius, end, start + 0.4 * (end - start))
        depth = 0.3 * lines.feet_depth * random.uniform(0.55, 1.0) * shown
        depth *= 1.0 + 0.15 * _random_curve(9.0, radius, random)
        roll = float(np.clip(10.0 * wide, 1.4, 2.4))
        found.append(FurrowLine(course=own, depth=depth, width=1.2, roll=roll, swelling=0.8))
        if random.random() < 0.3:
            fork = start + random.uniform(4.0, 8.0)
            away = random.choice([-1.0, 1.0]) * 0.018 * np.maximum(radius - fork, 0.0)
            branch = 0.6 * depth * smoothstep(radius, fork - 1.0, fork + 3.0)
            found.append(
                FurrowLine(course=own + away, depth=branch, width=0.9, roll=1.4, swelling=0.8)
            )
    return found


def _random_curve(length: float, samples: Floats64, random: np.random.Generator) -> Floats64:
    """Draw a random curve of mean 0 and deviation 1, (s,); length: mean wavelength [mm]."""
    waves = length / np.array([0.6, 1.0, 1.7])
    begins = random.uniform(0.0, 2.0 * np.pi, 3)
    amplitudes = np.array([0.8, 0.5, 0.33])
    phases = 2.0 * np.pi * samples[:, None] / waves + begins  # (s, 3)
    return np.asarray(np.cos(phases) @ amplitudes * 1.41)


def _sample_coordinates(reach: tuple[float, float]) -> Floats64:
    """Return coordinates of the samples along lines [mm], (s,)."""
    return np.arange(reach[0], reach[1], SAMPLE_SPACING)
