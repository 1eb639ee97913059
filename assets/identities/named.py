"""Persons by number or by name."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from types import MappingProxyType

import numpy as np

from .complexion import in_own_colours
from .person import Person, make_person
from .space import Sex, person_space, sample_identity


@dataclass(frozen=True)
class _Known:
    """Who bears a name: a number's person with some of its measures chosen.

    scores: in deviations from the mean of its sex.
    """

    seed: int
    sex: Sex
    age: float
    angle: float
    irises: str
    cut: str
    scores: Mapping[str, float]


NAMED: Mapping[str, _Known] = MappingProxyType(
    {
        "ada": _Known(
            27, Sex.WOMAN, 27.0, 34.0, "hazel", "parted",
            {"go-go": -0.8, "zy-zy": -0.2, "ls-sto": 1.0, "sto-li": 1.0, "al-al": -0.6},
        ),
        "kofi": _Known(
            9, Sex.MAN, 38.0, -38.0, "brown", "cropped",
            {"al-al": 2.2, "ls-sto": 1.8, "sto-li": 1.8, "zy-zy": 0.9, "n-prn": -0.6, "ch-ch": 0.8},
        ),
        "maria": _Known(
            13, Sex.WOMAN, 66.0, 56.0, "blue", "aside",
            {"go-go": -0.3, "zy-zy": 0.2, "ls-sto": 0.0, "sto-li": 0.2, "sn-prn": 0.0},
        ),
    }
)  # fmt: skip


@cache
def person_in_words(who: int | str) -> str:
    """Name, sex and age of the person of a number or a name: "Person 7, woman, about 60"."""
    known = sample_identity(who) if isinstance(who, int) else NAMED[who]
    name = f"Person {who}" if isinstance(who, int) else who.capitalize()
    return f"{name}, {known.sex.value}, about {5 * round(known.age / 5.0)}"


def person_called(who: int | str) -> Person:
    """The person of a number (0 and more) or of a name in `NAMED`, in own colours."""
    if isinstance(who, int):
        made = in_own_colours(make_person(sample_identity(who)), who)
        return replace(made, called=str(who))
    known = NAMED[who]
    drawn = sample_identity(known.seed, sex=known.sex, age=known.age)
    weights = person_space().with_scores(np.array(drawn.weights), known.scores, known.sex)
    made = make_person(replace(drawn, cut=known.cut, weights=tuple(weights.tolist())))
    made = in_own_colours(made, known.seed, angle=known.angle, irises=known.irises)
    return replace(made, called=who)
