"""Lines of expression of a person: how many there are, how far they reach, how deep they get.

Forehead: lines run along all of it in 51 of 100 people, lie in its middle in 25, at its sides in 24
(Braz, Sakuma 2010, "Frontalis muscle contraction patterns", Surg. Cosmet. Dermatol. 2). Between the
brows two upright ones are the rule, a single one is rare: 3 of 100 ("Study of glabellar wrinkle
patterns in the Pakistani population", Lahore 2025). Of people with deep crow's feet three tenths
each have a whole, a lower and a central fan, and 5 of 100 an upper one; whole ones come with age,
lower ones with men ("crow's feet lines", 1392 people, PubMed 25789814).
Lines get deeper with age, in men they are deeper and begin on the forehead, in women beside the
eyes (Luebberding, Krueger, Kerscher 2014, Dermatol. Surg. 40:22-32). Numbers of lines, lengths and
depths were not found in print: they are assumed.
"""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

import numpy as np


class Spread(Enum):
    """Where lines of the forehead are."""

    WHOLE = "whole"
    MIDDLE = "middle"
    SIDES = "sides"


class Fan(Enum):
    """The part of a whole fan that a person's crow's feet fill."""

    WHOLE = "whole"
    LOWER = "lower"
    CENTRAL = "central"
    UPPER = "upper"


class Lines(NamedTuple):
    """The lines of expression of a person; depths are relative to the built-in head's.

    seed: of courses and breaks. forehead: number of lines across it. spread: where they are. dip:
    how far they hang down in the middle [mm]. broken: how much of them is missing, 0 to 1. frown:
    number of upright ones between the brows. uneven: how much shallower all but the deepest are, 0
    to 1. feet: number of crow's feet. fan: where they are. reach: greatest length of one [mm].
    fine: number of fine lines on the forehead for each of the others.
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


def drawn_lines(is_man: bool, age: float, random: np.random.Generator) -> Lines:
    """Random lines for a sex and an age [years]."""
    seed = int(random.integers(2**31))
    spread, frown, fan, dip, broken, uneven, reach = random.uniform(0.0, 1.0, 7).tolist()
    count, feet, *deep = np.clip(random.normal(size=6), -2.0, 2.0).tolist()
    late = float(np.clip((age - 20.0) / 50.0, 0.0, 1.1))
    man = float(is_man)
    whole, lower = 0.24 + 0.2 * late, 0.24 + 0.14 * man
    upper = 0.05
    fans = np.cumsum([whole, lower, upper])
    spreads = np.cumsum([0.51, 0.25])
    # Young skin wrinkles less deep; how much is assumed.
    depths = (0.72 + 0.5 * late) * (0.92 + 0.16 * man) * np.exp2(0.35 * np.array(deep))
    of_forehead, of_frown, of_feet, of_fold = (depths * [1.0, 1.0, 1.12 - 0.12 * man, 1.0]).tolist()
    return Lines(
        seed=seed,
        forehead=int(np.clip(np.rint(3.1 + 1.3 * late + 1.1 * count), 1, 6)),
        spread=tuple(Spread)[int((spread > spreads).sum())],
        dip=-0.5 + 4.5 * dip,
        broken=broken,
        forehead_depth=of_forehead,
        frown=1 + int(frown > 0.06) + int(frown > 0.87),
        uneven=0.7 * uneven,
        frown_depth=of_frown,
        feet=int(np.clip(np.rint(3.6 + 1.8 * late + 0.9 * feet), 2, 7)),
        fan=(Fan.WHOLE, Fan.LOWER, Fan.UPPER, Fan.CENTRAL)[int((fan > fans).sum())],
        reach=12.0 + 6.0 * late + 5.0 * reach,
        feet_depth=of_feet,
        fold_depth=of_fold,
        fine=int(np.rint(3.0 * late)),
    )
