"""Make persons, given by number or name, in their own colours."""

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
    """A named person: the face of number `seed`, with chosen sex, age, colours and cut."""

    seed: int
    sex: Sex
    age: float
    angle: float
    irises: str
    cut: str


NAMED_PERSONS: Mapping[str, _Known] = MappingProxyType(
    {
        "ada": _Known(108, Sex.WOMAN, 27.0, 34.0, "hazel", "parted"),
        "kofi": _Known(118, Sex.MAN, 38.0, -38.0, "brown", "cropped"),
        "maria": _Known(118, Sex.WOMAN, 66.0, 56.0, "blue", "aside"),
    }
)


@dataclass(frozen=True)
class Colours:
    """A person's colours of skin and eyes, and features of the texture."""

    angle: float  # skin tone, ITA [deg]
    blood: float  # amount of blood in the skin, relative to most skin of this tone
    irises: str  # a colour of IRIS_FREQUENCIES
    features: Features


def colours_of_number(
    identity: Identity,
    seed: int,
    *,
    angle: float | None = None,
    irises: str | None = None,
    population: Population = EVERYBODY,
) -> Colours:
    """Choose random colours for a person's number; a number always gives the same colours.

    All tones of the population are equally likely. angle (ITA [deg]), irises: replace drawn ones.
    """
    random = np.random.default_rng([seed, 18])
    drawn_angle = float(random.uniform(*population.tones))
    angle = drawn_angle if angle is None else angle
    blood = float(np.clip(random.normal(1.0, 0.1), 0.75, 1.25))
    drawn = drawn_irises(random, angle, population.irises)
    features = features_of(identity, angle, random, population.beards)
    return Colours(angle, blood, irises or drawn, features)


def with_colours_of_number(
    person: Person, seed: int, *, angle: float | None = None, irises: str | None = None
) -> Person:
    """Give a person the skin, the eyes and the hair of a number (`colours_of_number`)."""
    return in_colours(person, colours_of_number(person.identity, seed, angle=angle, irises=irises))


def in_colours(person: Person, colours: Colours, *, shrink: int = 1) -> Person:
    """Give a person skin, eyes and hair of some colours; shrink: as in `coloured`."""
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
    """Describe a person, given by number or name, such as "Person 7, woman, about 60"."""
    known = sample_identity(who) if isinstance(who, int) else NAMED_PERSONS[who]
    name = f"Person {who}" if isinstance(who, int) else who.capitalize()
    return f"{name}, {known.sex.value}, about {5 * round(known.age / 5.0)}"


def person_called(who: int | str) -> Person:
    """Make a person, in the person's colours.

    who: a number (0 or more) or a name of `NAMED_PERSONS`.

    Raises KeyError for other names.
    """
    if isinstance(who, int):
        made = with_colours_of_number(make_person(sample_identity(who)), who)
        return replace(made, called=str(who))
    known = NAMED_PERSONS[who]
    drawn = sample_identity(known.seed, sex=known.sex, age=known.age)
    made = make_person(replace(drawn, cut=known.cut))
    made = with_colours_of_number(made, known.seed, angle=known.angle, irises=known.irises)
    return replace(made, called=who)
