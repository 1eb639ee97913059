"""Summarise a whole set by the labels of its samples: write index.csv and the card README.md."""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path
from typing import Any

from .labels import by_number
from .request import SetRequest

LEAST_PRESENT = 0.05  # value from which a unit counts as present, a quarter of intensity A


@dataclass
class Counts:
    """Numbers of samples for each kind, each person's number, and each action unit."""

    kinds: Counter[str] = field(default_factory=Counter)
    persons: Counter[int] = field(default_factory=Counter)
    units: Counter[str] = field(default_factory=Counter)


def write_index(
    path: Path, samples: Iterable[tuple[dict[str, Any], Mapping[str, str | int]]]
) -> Counts:
    """Write a CSV file whose rows have kind, head pose, action units etc. of each sample.

    samples: labels and additional columns of each sample. Returns the counts for the card.
    """
    counts = Counts()
    with path.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        for sample, more in samples:
            row = {**_row(sample), **more}
            if not counts.kinds:
                table.writerow(row)
            table.writerow(row.values())
            units = sample["action_units"].items()
            counts.kinds[sample["kind"]] += 1
            counts.persons[sample["person"]["number"]] += 1
            counts.units.update(name for name, value in units if value >= LEAST_PRESENT)
    return counts


def _row(sample: dict[str, Any]) -> dict[str, Any]:
    person = {name: value for name, value in sample["person"].items() if name != "measures"}
    return {
        "id": sample["id"],
        "kind": sample["kind"],
        "name": sample["name"],
        **{f"person_{name}": value for name, value in person.items()},
        **{f"head_{name}": sample["head"][name] for name in ("yaw", "pitch", "roll")},
        **{f"aperture_{name}": value for name, value in sample["apertures"].items()},
        "visible": sum(sample["landmarks"]["visible"]),
        **sample["action_units"],
    }


def card_of(request: SetRequest, numbers: range, counts: Counts) -> str:
    """Return the text of a set's card: the command, and how frequent each kind and unit is."""
    samples = len(numbers)
    persons = len(counts.persons)
    units = [(name, counts.units[name]) for name in sorted(counts.units, key=by_number)]
    text = (files(__package__) / "card.md").read_text("utf-8")
    return text.format(
        count=samples,
        version=request.version,
        arguments=f"--first {numbers.start} {request.arguments}"
        if numbers.start
        else request.arguments,
        persons=persons,
        samples_each=samples / persons,
        least=LEAST_PRESENT,
        kinds=_table("kind", counts.kinds.most_common(), samples),
        units=_table("action unit", units, samples),
    )


def _table(head: str, counted: Iterable[tuple[str, int]], total: int) -> str:
    rows = [f"| {name} | {number / total:.1%} |" for name, number in counted]
    return "\n".join([f"| {head} | of the samples |", "| --- | --- |", *rows])
