"""The card of a set, its README.md: what it is, how it was made, what is in it."""

from __future__ import annotations

from collections.abc import Iterable
from importlib.resources import files

import numpy as np

from .index import THERE, Counts, histogram
from .labels import by_number
from .request import Request

STEP = 15.0  # [degrees] of the histograms
BAR = 40  # characters for all of a set


def card_of(request: Request, counts: Counts) -> str:
    """The text for a set that was made as requested, with what was counted in it."""
    persons = len(counts.persons)
    units = [
        [name, f"{number / counts.samples:.1%}"]
        for name, number in sorted(counts.units.items(), key=lambda item: by_number(item[0]))
    ]
    text = (files(__package__) / "card.md").read_text("utf-8")
    return text.format(
        count=counts.samples,
        version=request.version,
        told=request.told,
        seed=request.seed,
        size=" x ".join(map(str, request.size)),
        files=_table(["file", "what"], request.files()),
        persons=persons,
        samples_each=counts.samples / persons,
        visible=counts.visible / (70 * counts.samples),
        there=THERE,
        kinds=_table(["kind", "samples", ""], _bars(counts.kinds.most_common(), counts.samples)),
        units=_table(["action unit", "of the samples"], units),
        letters=_table(
            ["intensity", "units", ""],
            _bars(sorted(counts.letters.items()), counts.letters.total()),
        ),
        tones=_histogram("tone", list(counts.persons.values()), "persons"),
        poses="\n\n".join(_histogram(*angles) for angles in counts.poses.items()),
    )


def _histogram(name: str, angles: list[float], of: str = "samples") -> str:
    rows = [
        [f"{low:+.0f} to {low + STEP:+.0f}", f"{share:.1%}", "#" * round(BAR * share)]
        for low, share in histogram(angles, STEP)
    ]
    spread = f"{name}: mean {np.mean(angles):+.1f}, standard deviation {np.std(angles):.1f} degrees"
    return f"{spread}\n\n" + _table(["degrees", of, ""], rows)


def _bars(counted: Iterable[tuple[str, int]], total: int) -> list[list[str]]:
    return [
        [name, f"{number} ({number / total:.1%})", "#" * round(BAR * number / total)]
        for name, number in counted
    ]


def _table(head: list[str], rows: Iterable[Iterable[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
