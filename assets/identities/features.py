"""Choose random features of a texture by sex and age: brows, lids, lips, hair, irises."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from ..pigments import SHIPPED_BEARD
from .brows import Brows, drawn_brows
from .eyes import USUAL_IRIS, Iris, drawn_iris
from .hair import is_tied
from .hairline import NO_RECESSION_AGE, Hairline, drawn_hairline
from .population import BEARDS_OF_MEN, ONLY_BROWN
from .space import Identity, Sex
from .spots import Spot, drawn_spots

# [mm]; tied hair showed the thin hair of its first 15 mm as a bare forehead. With this distance,
# foreheads of women are 65.6 mm high in pictures with tied hair, 63.8 mm with loose hair.
TIED_AHEAD = 6.0


@dataclass(frozen=True)
class Features:
    """Features of a person's texture; the defaults are those of the built-in head.

    brows: None for the brows of the built-in head.
    lid_line: darkness of the edges of the lids, where lashes root, 0 to 1.
    stubble: fraction of the beard's area that stubble covers, 0 to 1.
    beard_length: length of a full beard at the chin [mm]; 0: no full beard.
    beard: density of a beard's shadow, added to that of the built-in head.
    lips: density of blood in the lips, added to that of the built-in head.
    pale_lips: fraction of the skin's additional melanin that lips lack.
    relief: strength of pores and patches, added to that of the built-in head.
    fair: how fair the hair is, 0 to 1.
    grey: how grey the hair is, 0 to 1.
    hairline: shape of the hairline.
    iris: how the irises differ from the painted irises of the same colour.
    spots: moles, freckles and age spots.
    """

    brows: Brows | None = None
    lid_line: float = 0.0
    stubble: float = 0.0
    beard_length: float = 0.0
    beard: float = 0.0
    lips: float = 0.0
    pale_lips: float = 0.0
    relief: float = 0.0
    fair: float = 0.0
    grey: float = 0.0
    hairline: Hairline = field(default_factory=Hairline)
    iris: Iris = USUAL_IRIS
    spots: tuple[Spot, ...] = ()


PLAIN_FEATURES = Features()


def features_of(
    identity: Identity,
    angle: float,
    random: np.random.Generator,
    beards: Mapping[str, float] = BEARDS_OF_MEN,
) -> Features:
    """Choose random features for an identity's sex and age, and a skin tone, ITA [deg].

    beards: frequencies of men's beards, as in `Population`.

    In women, eyes and lips contrast more with the skin than in men (Russell 2009, "A sex difference
    in facial contrast and its exaggeration by cosmetics", Perception 38:1211-1219). The contrast
    falls with age (Porcheron, Mauger, Russell 2013, PLoS ONE 8:e57985).
    On dark skin lips vary most: some are as dark as the skin, others far lighter and pinker
    (Vergnaud and others 2024, "Lip color diversity", Skin Res. Technol. 30:e13583). On light skin
    `pale_lips` changes nothing. All numbers are chosen by eye.
    """
    is_man = identity.sex is Sex.MAN
    years = identity.age
    beard, fibres, fair, grey, line, hairs = random.uniform(0.0, 1.0, 6)
    fair_skin = 45.0  # ITA [deg] above which hair may be fair
    brows = drawn_brows(is_man, years, random)
    # Men whose hair recedes have too little to tie it: their hairline remains that of young men.
    receding_years = min(years, NO_RECESSION_AGE) if is_tied(identity.cut) else years
    hairline = drawn_hairline(is_man, receding_years, random)
    if is_tied(identity.cut):
        hairline = replace(hairline, tied=TIED_AHEAD)
    iris = drawn_iris(years, fibres, random, angle=angle)
    blood_chance, pale_chance = np.clip(random.normal(size=2), -2.0, 2.0).tolist()
    if is_man:
        blood = -0.05 + 0.13 * blood_chance
    else:
        fading = 1.0 - 0.006 * (years - 20.0)
        blood = fading * (0.48 + 0.2 * blood_chance)
    pale = 0.12 + 0.15 * pale_chance
    stubble, length = _drawn_beard(hairs, beards) if is_man else (0.0, 0.0)
    return Features(
        brows=brows,
        lid_line=0.2 * line if is_man else 0.5 + 0.4 * line,
        stubble=stubble,
        beard_length=length,
        beard=0.1 + 0.8 * beard**1.3 if is_man else -SHIPPED_BEARD,
        lips=blood,
        pale_lips=pale,
        relief=(0.15 if is_man else -0.6) + 0.02 * (years - 30.0),
        fair=fair if angle > fair_skin else 0.0,
        grey=_fraction_of_grey(years, angle, grey),
        hairline=hairline,
        iris=iris,
        spots=drawn_spots(years, angle, random),
    )


def _drawn_beard(chance: float, frequencies: Mapping[str, float]) -> tuple[float, float]:
    """Return the density of stubble, 0 to 0.9, and the length of a full beard [mm], 0 for none.

    A full beard has 6 to 20 mm at the chin. chance: random, 0 to 1. frequencies: as in Population.
    """
    kinds = list(BEARDS_OF_MEN)
    weights = np.array([frequencies.get(kind, 0.0) for kind in kinds])
    ends = np.cumsum(weights / weights.sum())
    number = min(int(np.searchsorted(ends, chance, side="right")), len(kinds) - 1)
    start = ends[number - 1] if number else 0.0
    past = float((chance - start) / (ends[number] - start))  # 0 to 1 within the kind
    most_stubble = 0.9
    shortest = 6.0  # [mm]
    longest = 20.0  # [mm]
    if kinds[number] == "full":
        return most_stubble, shortest + (longest - shortest) * past
    return (most_stubble * past if kinds[number] == "stubble" else 0.0), 0.0


def _fraction_of_grey(years: float, angle: float, early: float) -> float:
    """Compute the fraction of grey in a person's hair, 0 to 0.95.

    Between 45 and 65 years the mean is 0.27. Persons with dark skin turn grey later (Panhard,
    Lozano, Loussouarn 2012, "Greying of the human hair", Br. J. Dermatology 167:865-873).

    angle: ITA [deg]. early: 0 for hair that turns grey late to 1 for early.
    """
    dark_skin = -30.0  # ITA [deg] below which the delay is full
    delay = 10.0  # [years] by which hair turns grey later
    later = delay * float(np.clip((ONLY_BROWN - angle) / (ONLY_BROWN - dark_skin), 0.0, 1.0))
    past = float(np.clip((years - 46.0 + 16.0 * early - later) / 34.0, 0.0, 1.0))
    return min(past * past, 0.95)
