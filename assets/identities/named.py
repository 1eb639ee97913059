"""Persons by number or by name."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from types import MappingProxyType

from .complexion import in_own_colours
from .person import Person, make_person
from .traits import Sex, sample_identity


@dataclass(frozen=True)
class _Known:
    """Who bears a name: a number's person with some of its numbers chosen.

    scores, shapes: in deviations, as of `Identity`.
    """

    seed: int
    sex: Sex
    age: float
    angle: float
    irises: str
    cut: str
    scores: Mapping[str, float]
    shapes: Mapping[str, float]


NAMED: Mapping[str, _Known] = MappingProxyType(
    {
        "ada": _Known(
            27, Sex.WOMAN, 27.0, 34.0, "hazel", "fringed",
            {"go-go": -1.3, "zy-zy": -0.2, "ls-sto": 1.2, "sto-li": 1.4, "al-al": -0.6,
             "ch-ch": -0.2, "n-gn": -0.5, "sn-ls": -0.8},
            {"cheeks": 1.2, "chin width": -1.6, "jaw line": -1.2, "lips": 1.4, "eye slant": 0.8},
        ),
        "kofi": _Known(
            9, Sex.MAN, 38.0, -38.0, "brown", "cropped",
            {"al-al": 2.2, "ls-sto": 1.8, "sto-li": 2.0, "zy-zy": 0.9, "n-prn": -0.6, "ch-ch": 0.8},
            {"nose bridge": -1.2, "lips": 2.2, "cheekbones": 1.0, "jaw angle": 0.5, "chin": 0.4},
        ),
        "maria": _Known(
            47, Sex.WOMAN, 66.0, 56.0, "blue", "brushed",
            {"go-go": 0.2, "zy-zy": 0.5, "n-gn": -0.9, "ls-sto": -0.6, "sto-li": -0.4,
             "al-al": 0.4, "sn-ls": 0.6},
            {"chin": -0.8, "chin width": -0.3, "nose bridge": 0.5, "cheeks": -0.4},
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
    scores, shapes = {**drawn.scores, **known.scores}, {**drawn.shapes, **known.shapes}
    identity = replace(drawn, cut=known.cut, scores=scores, shapes=shapes)
    made = make_person(identity)
    made = in_own_colours(made, known.seed, angle=known.angle, irises=known.irises)
    return replace(made, called=who)
