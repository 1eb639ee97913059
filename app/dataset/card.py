"""The card of a set, its README.md: what it is, how it was made, what is in it, what it is not."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from .index import THERE, Counts, histogram
from .labels import by_number
from .request import Request

STEP = 15.0  # [degrees] of the histograms
BAR = 40  # characters for all of a set

CARD = """\
# {count} faces with exact action units

Pictures of faces that Risorius {version} made: a simulated face whose muscles are told how far to
contract, drawn without a camera. No person was photographed, and nobody's likeness is in it.

    risorius dataset --count {count} {told} -o FOLDER

Seed {seed}; the same command makes the same files on the same machine. `dataset.json` holds every
option and the table that samples were drawn from.

## Files

For each sample, with {size} pixels:

{files}

`index.csv` has a row for each sample: kind, person, head pose, every action unit. Left and right
are the subject's own. The fields of the .json are described in the manual of Risorius, on the page
"Data sets of faces".

## What is in it

{persons} persons, {samples_each:.1f} pictures of each; {visible:.0%} of all landmarks are visible.

{kinds}

An action unit counts as there from {there} of 1 on. Letters are fifths of the scale.

{units}

{letters}

Tones of skin, as individual typology angles: above 55 very light, 28 intermediate, below -30 dark.

{tones}

How heads are turned to the camera:

{poses}

## What the labels mean

An action unit of 0.5 is half of what Risorius takes for the most that unit does: a fixed mixture of
muscles, half contracted. It is exact as an order and as a cause. It is not what a FACS coder would
score: nobody coded these pictures, the scale is linear in contraction, not in what is seen, and the
letters are equal fifths, which those of FACS are not. A unit of 0.1 may be hard to see. In speech,
units are those that come nearest to what the muscles of the viseme do.

## Limits

- One built head is bent into all persons: adults, without hair on the head but for a shaven crown,
  without beard, glasses, make-up, and with one and the same skin texture in other tones.
- Muscles are springs and a model. Some units are weaker than in people (17, 22, 28).
- Faces are at rest in their pose; nothing is blurred by motion, and there is no noise of a camera.
- Measures of faces are those of North American adults of European descent (Weinberg et al. 2016).

Use it to train or test what reads landmarks, action units, pose, gaze or depth, along with pictures
of people. Do not use it alone to say how well something works on people, and not to infer what
anybody feels: names of expressions here are names of combinations of units.
"""


def card_of(request: Request, counts: Counts) -> str:
    """The text for a set that was made as requested, with what was counted in it."""
    persons = len(counts.persons)
    units = [
        [name, f"{number / counts.samples:.1%}"]
        for name, number in sorted(counts.units.items(), key=lambda item: by_number(item[0]))
    ]
    return CARD.format(
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
