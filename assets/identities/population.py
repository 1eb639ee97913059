"""The population of random persons: frequencies of sexes, cuts and eye colours; ages and tones.

Tones and ages are drawn uniformly. Frequencies of cuts are chosen.

In the United States, 41 % of all people have brown eyes, 15 % specked, 12 % green and 32 % blue or
grey eyes (American Academy of Ophthalmology 2016, as tabulated by Statistic Brain). Among whites,
34 % have blue eyes (Grant, Lauderdale 2002, Ann. Hum. Biol. 29:657-666). From these figures we
assume the frequencies for very light skin, the ratio of blue to grey eyes, and how fast both become
rare with darker skin.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from ...geometry.steps import smoothstep

LIGHTEST_TONE = 70.0  # individual typology angle of skin, ITA [deg]
DARKEST_TONE = -55.0
ONLY_BROWN = 28.0  # ITA [deg] below which blue eyes are rare
YOUNGEST_AGE = 20.0  # [years]
OLDEST_AGE = 75.0
IRIS_FREQUENCIES = MappingProxyType(
    {"brown": 0.27, "hazel": 0.18, "green": 0.13, "blue": 0.31, "grey": 0.11}
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
BEARDS_OF_MEN = MappingProxyType({"none": 0.55, "stubble": 0.25, "full": 0.2})  # assumed


@dataclass(frozen=True)
class Population:
    """The population of random persons; `person_called` draws from the default.

    - women: fraction of women, 0 to 1.
    - ages: lowest and highest age [years].
    - tones: darkest and lightest skin tone, ITA [deg].
    - irises: frequencies of eye colours among people with very light skin.
    - cuts_of_women, cuts_of_men: frequencies of hair cuts.
    - beards: frequencies of shaved men, of stubble and of full beards (BEARDS_OF_MEN).
    """

    women: float = 0.5
    ages: tuple[float, float] = (YOUNGEST_AGE, OLDEST_AGE)
    tones: tuple[float, float] = (DARKEST_TONE, LIGHTEST_TONE)
    irises: Mapping[str, float] = field(default_factory=lambda: IRIS_FREQUENCIES)
    cuts_of_women: Mapping[str, float] = field(default_factory=lambda: CUTS_OF_WOMEN)
    cuts_of_men: Mapping[str, float] = field(default_factory=lambda: CUTS_OF_MEN)
    beards: Mapping[str, float] = field(default_factory=lambda: BEARDS_OF_MEN)


EVERYBODY = Population()


def drawn_irises(
    random: np.random.Generator, angle: float, frequencies: Mapping[str, float] = IRIS_FREQUENCIES
) -> str:
    """Choose a random colour of eyes for a skin tone; angle: ITA [deg].

    frequencies: frequencies with very light skin. With darker skin, green, blue and grey eyes
    become rare first, then hazel eyes.
    """
    # ITA [deg] up to which nobody has such eyes, and from which their frequency is full.
    fades = {"brown": (-90.0, -80.0), "hazel": (-5.0, 45.0)}
    pale_fade = 15.0, 50.0
    weights = {}
    for name, frequency in frequencies.items():
        none, full = fades.get(name, pale_fade)
        weights[name] = frequency * float(smoothstep(np.array(angle), none, full))
    total = sum(frequencies.values())
    weights["brown"] = weights.get("brown", 0.0) + total - sum(weights.values())
    chances = np.array(list(weights.values())) / total
    number = int(random.choice(len(weights), p=chances))
    return list(weights)[number]
