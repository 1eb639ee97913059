"""Whom persons are drawn from: shares of sexes, cuts of hair and colours of eyes, ages, tones.

All shares are chosen by eye; tones and ages are drawn evenly.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

LIGHTEST = 70.0  # individual typology angle of skin, ITA [deg]
DARKEST = -55.0
ONLY_BROWN = 28.0  # ITA below which eyes are brown, as nearly all are there
YOUNGEST = 20.0  # [years]
OLDEST = 75.0
IRIS_SHARES = MappingProxyType(
    {"brown": 0.4, "hazel": 0.15, "green": 0.12, "blue": 0.2, "grey": 0.13}
)
CUTS_OF_WOMEN = MappingProxyType(
    {
        "parted": 0.2,
        "centred": 0.2,
        "aside": 0.22,
        "knotted": 0.14,
        "topknot": 0.08,
        "tailed": 0.16,
    }
)
CUTS_OF_MEN = MappingProxyType(
    {
        "short": 0.38,
        "cropped": 0.3,
        "brushed": 0.14,
        "swept": 0.12,
        "knotted": 0.03,
        "tailed": 0.03,
    }
)


@dataclass(frozen=True)
class Population:
    """Whom persons are drawn from; the default is that of `person_called`.

    women: their share, 0 to 1. ages: lowest and highest [years]. tones: darkest and lightest, ITA
    [deg]. irises: shares of their colours with light skin. cuts_of_women, cuts_of_men: shares of
    cuts of hair.
    """

    women: float = 0.5
    ages: tuple[float, float] = (YOUNGEST, OLDEST)
    tones: tuple[float, float] = (DARKEST, LIGHTEST)
    irises: Mapping[str, float] = field(default_factory=lambda: IRIS_SHARES)
    cuts_of_women: Mapping[str, float] = field(default_factory=lambda: CUTS_OF_WOMEN)
    cuts_of_men: Mapping[str, float] = field(default_factory=lambda: CUTS_OF_MEN)


EVERYBODY = Population()


def drawn_irises(
    random: np.random.Generator, angle: float, shares: Mapping[str, float] = IRIS_SHARES
) -> str:
    """The colour of somebody's eyes, by how often each is there; dark skin has brown ones."""
    weights = np.array(list(shares.values()))
    drawn = list(shares)[int(random.choice(len(weights), p=weights / weights.sum()))]
    return drawn if angle >= ONLY_BROWN else "brown"
