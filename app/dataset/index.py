"""What is told of a whole set, from its samples' labels: index.csv and the counts for its card."""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from .table import OF_EYES_AND_HEAD

THERE = 0.05  # from which value on a unit counts as there: a quarter of A
POSE = ("yaw", "pitch", "roll")


@dataclass
class Counts:
    """How often what is in a set.

    units: name -> in how many samples it is there, without those of head and gaze. letters: of all
    units that are, A to E.
    kinds: of samples. poses: name -> the angle in each sample [degrees]. persons: number -> the
    tone of each [degrees]. visible: landmarks of all.
    """

    samples: int = 0
    units: Counter[str] = field(default_factory=Counter)
    letters: Counter[str] = field(default_factory=Counter)
    kinds: Counter[str] = field(default_factory=Counter)
    poses: dict[str, list[float]] = field(default_factory=lambda: {name: [] for name in POSE})
    persons: dict[int, float] = field(default_factory=dict)
    visible: int = 0

    def add(self, sample: dict[str, Any]) -> None:
        """Count a sample."""
        self.samples += 1
        self.visible += sum(sample["landmarks"]["visible"])
        for name, value in sample["action_units"].items():
            if value >= THERE and name not in OF_EYES_AND_HEAD:
                self.units[name] += 1
                self.letters["ABCDE"[min(int(5.0 * value), 4)]] += 1
        for name in POSE:
            self.poses[name].append(sample["head"][name])
        self.kinds[sample["kind"]] += 1
        self.persons[sample["person"]["number"]] = sample["person"]["tone"]


def write_index(path: Path, samples: Iterable[dict[str, Any]]) -> Counts:
    """One row for each sample: what it is, the head's pose, every action unit; and the counts."""
    counts = Counts()
    with path.open("w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        for sample in samples:
            row = _row(sample)
            if not counts.samples:
                rows.writerow(row)
            rows.writerow(row.values())
            counts.add(sample)
    return counts


def _row(sample: dict[str, Any]) -> dict[str, Any]:
    person = {name: value for name, value in sample["person"].items() if name != "measures"}
    return {
        "id": sample["id"],
        "kind": sample["kind"],
        "name": sample["name"],
        **{f"person_{name}": value for name, value in person.items()},
        **{f"head_{name}": sample["head"][name] for name in POSE},
        **{f"aperture_{name}": value for name, value in sample["apertures"].items()},
        "visible": sum(sample["landmarks"]["visible"]),
        **sample["action_units"],
    }


def histogram(values: list[float], width: float) -> list[tuple[float, float]]:
    """How many of the values lie in each step of `width`: (lower end, share)."""
    places = Counter((np.floor(np.array(values) / width)).astype(int).tolist())
    return [
        (place * width, places[place] / len(values))
        for place in range(min(places), max(places) + 1)
    ]
