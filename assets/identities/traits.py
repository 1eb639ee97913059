"""What tells one person from another in numbers: a sex, an age, a cut of hair, weights of modes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from .space import MOST, YOUNG, Sex, person_space

HAIR = 0.75, 1.3  # how long it is, beside its cut
CUT_SHARES: Mapping[Sex, Mapping[str, float]] = MappingProxyType(
    {
        Sex.WOMAN: {"bob": 0.15, "parted": 0.35, "waved": 0.35, "curly": 0.1, "fringed": 0.05},
        Sex.MAN: {"short": 0.4, "cropped": 0.25, "brushed": 0.15, "swept": 0.1, "curly": 0.1},
    }
)
AGES = 20.0, 75.0  # [years]
UNEVENNESS = 0.1  # deviations, by which a face is another person's on the left than on the right


@dataclass(frozen=True)
class Identity:
    """A face in numbers.

    sex, age [years]: that its weights were drawn for.
    hair: how long it is, beside that of its cut.
    cut: name of its cut (`CUTS` of hair.py).
    weights: of the modes, in deviations from the mean of people (space.py).
    unevenness: by how much they are more on the left and less on the right.
    covered: how much of the iris the upper lid covers [mm].
    corners: how far up those of the mouth are turned at rest [mm].
    brows: how far up the brows lie [mm].
    """

    sex: Sex
    age: float
    hair: float
    cut: str
    weights: tuple[float, ...]
    unevenness: tuple[float, ...]
    covered: float = 1.6
    corners: float = 0.0
    brows: float = 0.0

    def scaled(self, share: float) -> Identity:
        """An identity with a share of all that is its own: 0 is the mean of people."""
        kinds = (self.weights, self.unevenness)
        weights, unevenness = (tuple(share * weight for weight in kind) for kind in kinds)
        corners, brows = share * self.corners, share * self.brows
        return replace(self, weights=weights, unevenness=unevenness, corners=corners, brows=brows)


def sample_identity(
    seed: int, *, sex: Sex | None = None, age: float | None = None, is_even: bool = False
) -> Identity:
    """The person of a number: the same one every time; even: left and right alike.

    seed: 0 and more. sex, age: instead of the number's own.
    """
    random = np.random.default_rng([seed, 17])
    drawn = Sex.WOMAN if random.random() < 0.5 else Sex.MAN
    sex = drawn if sex is None else sex
    years = float(random.uniform(*AGES))
    age = years if age is None else age
    hair = float(random.uniform(*HAIR))
    cuts = CUT_SHARES[sex]
    cut = str(random.choice(list(cuts), p=list(cuts.values())))
    weights = person_space().draw(sex, age, random)
    sides = np.clip(random.normal(size=len(weights)), -MOST, MOST)
    uneven = (0.0 if is_even else UNEVENNESS) * sides
    covered, corners, brows = np.clip(random.normal(size=3), -2.0, 2.0)
    late, is_woman = max(age - YOUNG, 0.0) / 10.0, sex is Sex.WOMAN
    return Identity(
        sex,
        age,
        hair,
        cut,
        tuple(weights.tolist()),
        tuple(uneven.tolist()),
        covered=float(1.7 - 0.3 * is_woman + 0.35 * covered + 0.15 * late),
        corners=float(0.9 + 0.3 * is_woman + 0.6 * corners - 0.15 * late),
        brows=float((1.5 if is_woman else -1.5) + 1.2 * brows - 0.3 * late),
    )
