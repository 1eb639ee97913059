"""The persons of a set: a head, a tone of skin, a colour of eyes, from the set's seed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from risorius.assets import AssetError
from risorius.assets.fitting import FittedHead, fit_head
from risorius.assets.identities import (
    Features,
    coloured,
    drawn_irises,
    features_of,
    make_person,
    sample_identity,
)

from ..workers import Send
from .request import Request

PERSONS = 1  # sets their seeds apart from those of samples


@dataclass(frozen=True)
class Somebody:
    """A head with its colours, and what is told of it."""

    head: FittedHead
    labels: dict[str, Any]


def person_of(request: Request, number: int) -> Somebody:
    """Person `number` of a set; UserError for a head of the user's that cannot be fitted.

    The tone is an individual typology angle: 55 and more very light, below -30 dark.
    """
    table = request.table
    seeds = np.random.SeedSequence([request.seed, number, PERSONS])
    random = np.random.default_rng(seeds)
    tone = round(float(random.uniform(*table.persons.tone)), 2)
    irises = drawn_irises(random, tone, table.irises)
    labels: dict[str, Any] = {"number": number, "tone": tone, "irises": irises}
    features = Features()
    if request.heads:
        head = _fitted(request.heads[number])
        labels["head"] = request.heads[number].name
    else:
        made = make_person(sample_identity(int(seeds.generate_state(1)[0])))
        labels["sex"] = made.identity.sex.value
        labels["age"] = round(made.identity.age, 1)
        labels["measures"] = {code: round(value, 3) for code, value in made.measures.items()}
        features = features_of(made.identity, tone, random)
        head = made
    return Somebody(coloured(head, angle=tone, irises=irises, features=features), labels)


def check_heads(files: Sequence[Path], send: Send) -> None:
    """Tell of each head of the user's why it cannot be fitted; None where it can."""
    for file in files:
        try:
            _fitted(file)
        except AssetError as error:
            send(str(error))
        else:
            send(None)


def _fitted(file: Path) -> FittedHead:
    return fit_head(file, file.with_suffix(".json"))
