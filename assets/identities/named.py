"""Persons by number or by name."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from .complexion import coloured
from .features import Features, features_of
from .person import Person, make_person
from .population import EVERYBODY, Population, drawn_irises
from .space import Identity, Sex, sample_identity


class _Known(NamedTuple):
    """The person with a name: a number's face of some sex and age, in chosen colours."""

    seed: int
    sex: Sex
    age: float
    angle: float
    irises: str
    cut: str


NAMED: Mapping[str, _Known] = MappingProxyType(
    {
        "ada": _Known(108, Sex.WOMAN, 27.0, 34.0, "hazel", "parted"),
        "kofi": _Known(118, Sex.MAN, 38.0, -38.0, "brown", "cropped"),
        "maria": _Known(118, Sex.WOMAN, 66.0, 56.0, "blue", "aside"),
    }
)


@dataclass(frozen=True)
class Colours:
    """A person's tone of skin (ITA [deg]), blood in it, colour of eyes, and features."""

    angle: float
    blood: float
    irises: str
    features: Features


def own_colours(
    identity: Identity,
    seed: int,
    *,
    angle: float | None = None,
    irises: str | None = None,
    population: Population = EVERYBODY,
) -> Colours:
    """The colours of a number, always the same; all tones are equally likely.

    angle, irises: replace the number's own.
    """
    random = np.random.default_rng([seed, 18])
    drawn_angle = float(random.uniform(*population.tones))
    angle = drawn_angle if angle is None else angle
    blood = float(np.clip(random.normal(1.0, 0.1), 0.75, 1.25))
    drawn = drawn_irises(random, angle, population.irises)
    return Colours(angle, blood, irises or drawn, features_of(identity, angle, random))


def in_own_colours(
    person: Person, seed: int, *, angle: float | None = None, irises: str | None = None
) -> Person:
    """A person with the skin, the eyes and the hair of a number (`own_colours`)."""
    return in_colours(person, own_colours(person.identity, seed, angle=angle, irises=irises))


def in_colours(person: Person, colours: Colours, *, shrink: int = 1) -> Person:
    """A person with skin, eyes and hair of these colours; shrink: as in `coloured`."""
    return coloured(
        person,
        angle=colours.angle,
        blood=colours.blood,
        irises=colours.irises,
        features=colours.features,
        shrink=shrink,
    )


@cache
def person_in_words(who: int | str) -> str:
    """Name, sex and age of the person with a number or a name: "Person 7, woman, about 60"."""
    known = sample_identity(who) if isinstance(who, int) else NAMED[who]
    name = f"Person {who}" if isinstance(who, int) else who.capitalize()
    return f"{name}, {known.sex.value}, about {5 * round(known.age / 5.0)}"


def person_called(who: int | str) -> Person:
    """The person with a number (0 or more) or a name in `NAMED`, in own colours."""
    if isinstance(who, int):
        made = in_own_colours(make_person(sample_identity(who)), who)
        return replace(made, called=str(who))
    known = NAMED[who]
    drawn = sample_identity(known.seed, sex=known.sex, age=known.age)
    made = make_person(replace(drawn, cut=known.cut))
    made = in_own_colours(made, known.seed, angle=known.angle, irises=known.irises)
    return replace(made, called=who)
