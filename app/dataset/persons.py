"""The persons of a set: a head, a tone of skin, a colour of eyes, from the set's seed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from risorius.assets.fitting import FittedHead
from risorius.assets.identities import (
    coloured,
    drawn_irises,
    features_of,
    make_person,
    sample_identity,
)

from .request import Request

PERSONS = 1  # sets their seeds apart from those of samples


@dataclass(frozen=True)
class Somebody:
    """A head with its colours, and what is told of it."""

    head: FittedHead
    labels: dict[str, Any]


def person_of(request: Request, number: int) -> Somebody:
    """Person `number` of a set.

    The tone is an individual typology angle: 55 and more very light, below -30 dark.
    """
    table = request.table
    seeds = np.random.SeedSequence([request.seed, number, PERSONS])
    random = np.random.default_rng(seeds)
    tone = round(float(random.uniform(*table.persons.tone)), 2)
    irises = drawn_irises(random, tone, table.irises)
    person = make_person(sample_identity(int(seeds.generate_state(1)[0])))
    labels = {
        "number": number,
        "tone": tone,
        "irises": irises,
        "sex": person.identity.sex.value,
        "age": round(person.identity.age, 1),
        "measures": {code: round(value, 3) for code, value in person.measures.items()},
    }
    features = features_of(person.identity, tone, random)
    return Somebody(coloured(person, angle=tone, irises=irises, features=features), labels)
