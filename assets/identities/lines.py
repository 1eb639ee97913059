"""Choose the expression lines of a person at random: their number, length and depth.

- Forehead: lines cross the whole forehead in 51 % of people, only its centre in 25 %, and only its
  sides in 24 % (Braz, Sakuma 2010, "Frontalis muscle contraction patterns", Surg. Cosmet.
  Dermatol. 2).
- Between the brows: most people have two upright lines, and 3 % have a single one ("Study of
  glabellar wrinkle patterns in the Pakistani population", Lahore 2025).
- Crow's feet: of people with deep ones, 30 % each have a whole, a lower and a central fan, and 5 %
  an upper fan. Whole fans are more frequent at higher age, lower fans in men ("crow's feet lines",
  1392 people, PubMed 25789814).

Lines become deeper with age. Men have deeper lines, which appear first on the forehead; in women
lines appear first beside the eyes (Luebberding, Krueger, Kerscher 2014, Dermatol. Surg. 40:22-32).
We found no published numbers, lengths and depths of lines, so these are assumed.
"""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

import numpy as np


class Spread(Enum):
    """The part of the forehead that lines cross."""

    WHOLE = "whole"
    MIDDLE = "middle"
    SIDES = "sides"


class Fan(Enum):
    """The part of the fan beside the eye that has crow's feet."""

    WHOLE = "whole"
    LOWER = "lower"
    CENTRAL = "central"
    UPPER = "upper"


class ExpressionLines(NamedTuple):
    """The expression lines of a person; all depths are relative to the built-in head's.

    - seed: seed for the courses and the breaks of lines.
    - forehead: number of lines across the forehead.
    - spread: part of the forehead that lines cross.
    - dip: how far lines of the forehead hang down at the midline [mm].
    - broken: how much of the lines is missing, 0 to 1.
    - frown: number of upright lines between the brows.
    - uneven: how much shallower the other upright lines are than the deepest one, 0 to 1.
    - feet: number of crow's feet on each side.
    - fan: part of the fan beside the eye that has crow's feet.
    - reach: length of the longest crow's foot [mm].
    - fine: number of fine lines on the forehead for each line in `forehead`.
    """

    seed: int
    forehead: int
    spread: Spread
    dip: float
    broken: float
    forehead_depth: float
    frown: int
    uneven: float
    frown_depth: float
    feet: int
    fan: Fan
    reach: float
    feet_depth: float
    fold_depth: float
    fine: int


def drawn_lines(is_man: bool, age: float, random: np.random.Generator) -> ExpressionLines:
    """Choose random lines for a person of this sex and age [years]."""
    seed = int(random.integers(2**31))
    spread, frown, fan, dip, broken, uneven, reach = random.uniform(0.0, 1.0, 7).tolist()
    count, feet, *deep = np.clip(random.normal(size=6), -2.0, 2.0).tolist()
    late = float(np.clip((age - 20.0) / 50.0, 0.0, 1.1))
    man = float(is_man)
    whole = 0.24 + 0.2 * late
    lower = 0.24 + 0.14 * man
    upper = 0.05
    fans = np.cumsum([whole, lower, upper])
    spreads = np.cumsum([0.51, 0.25])
    # Young skin has shallower wrinkles; how much shallower is assumed.
    of_age = 0.72 + 0.5 * late
    of_sex = 0.92 + 0.16 * man
    depths = of_age * of_sex * np.exp2(0.35 * np.array(deep))
    of_forehead, of_frown, of_feet, of_fold = depths.tolist()
    of_feet *= 1.12 - 0.12 * man
    furrow_count = np.rint(3.1 + 1.3 * late + 1.1 * count)
    feet_count = np.rint(3.6 + 1.8 * late + 0.9 * feet)
    kinds_of_fan = (Fan.WHOLE, Fan.LOWER, Fan.UPPER, Fan.CENTRAL)
    return ExpressionLines(
        seed=seed,
        forehead=int(np.clip(furrow_count, 1, 6)),
        spread=tuple(Spread)[int((spread > spreads).sum())],
        dip=-0.5 + 4.5 * dip,
        broken=broken,
        forehead_depth=of_forehead,
        frown=1 + int(frown > 0.03) + int(frown > 0.87),
        uneven=0.45 * uneven,
        frown_depth=of_frown,
        feet=int(np.clip(feet_count, 2, 7)),
        fan=kinds_of_fan[int((fan > fans).sum())],
        reach=12.0 + 6.0 * late + 5.0 * reach,
        feet_depth=of_feet,
        fold_depth=of_fold,
        fine=int(np.rint(3.0 * late)),
    )
