"""Persons by number or by name."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from types import MappingProxyType
from typing import NamedTuple

from .complexion import in_own_colours
from .person import Person, make_person
from .space import Sex, sample_identity


class _Known(NamedTuple):
    """Who bears a name: a number's face of some sex and age, in chosen colours."""

    seed: int
    sex: Sex
    age: float
    angle: float
    irises: str
    cut: str


NAMED: Mapping[str, _Known] = MappingProxyType(
    {
        "ada": _Known(112, Sex.WOMAN, 27.0, 34.0, "hazel", "parted"),
        "kofi": _Known(102, Sex.MAN, 38.0, -38.0, "brown", "cropped"),
        "maria": _Known(111, Sex.WOMAN, 66.0, 56.0, "blue", "aside"),
    }
)


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
    made = make_person(replace(drawn, cut=known.cut))
    made = in_own_colours(made, known.seed, angle=known.angle, irises=known.irises)
    return replace(made, called=who)
