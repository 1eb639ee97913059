"""Give a person an individual smile: muscles that pull beside zygomaticus major.

In 67 % of people the corners of the mouth rise first. In a canine smile (31 %) the upper lip rises
first, and 2 % bare both rows of teeth (Rubin 1974, "The anatomy of a smile", Plast. Reconstr. Surg.
53:384-387). Women show gums twice as often as men (Tjan and others 1984, J. Prosthet. Dent.
51:24-28). The weight of each muscle is chosen by eye.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from ..model import Layer


class Smile(NamedTuple):
    """How a person's smile differs from the built-in smile, for which all fields are 0.

    lift: rise of the upper lip, 0 to 1.
    curl: roll of the upper lip, -1 (less) to 1 (more).
    spread: width of the mouth, -1 to 1.
    drop: opening of the jaw, -1 to 1.
    """

    lift: float = 0.0
    curl: float = 0.0
    spread: float = 0.0
    drop: float = 0.0


USUAL_SMILE = Smile()
CANINE_SHARE = 0.33


def drawn_smile(is_woman: bool, random: np.random.Generator) -> Smile:
    """Choose a random smile for a person of this sex."""
    kind, strength, *others = random.uniform(0.0, 1.0, 5)
    strength *= 1.0 if is_woman else 0.8
    lift = 0.5 + 0.5 * strength if kind < CANINE_SHARE else 0.25 * strength
    curl, spread, drop = (float(2.0 * each - 1.0) for each in others)
    return Smile(float(lift), curl, spread, drop)


def smiling(layers: tuple[Layer, ...], smile: Smile) -> tuple[Layer, ...]:
    """Change AU12 and joy in the tables of controls to a person's smile."""
    added = {
        "AU12": {
            "zygomaticus_minor": 0.45 * smile.lift,
            "levator_anguli_oris": 0.1 * smile.lift - 0.1 * smile.spread,
            "buccinator": 0.1 * smile.spread,
        },
        "joy": {
            "AU10": 0.75 * smile.lift,
            "orbicularis_oris_roll_upper": 0.2 * smile.curl,
            "AU20": 0.25 * smile.spread,
            "AU25": 0.1 * smile.drop,
            "AU26": 0.22 * smile.drop,
        },
    }
    changed = []
    for layer in layers:
        rows = {name: _with_weights(row, added.get(name, {})) for name, row in layer.rows.items()}
        changed.append(replace(layer, rows=rows))
    return tuple(changed)


def _with_weights(row: Mapping[str, Any], added: Mapping[str, float]) -> Mapping[str, Any]:
    """Add to some weights of a row, and clip them to 0 to 1."""
    changed = dict(row)
    for name, more in added.items():
        changed[name] = float(np.clip(row.get(name, 0.0) + more, 0.0, 1.0))
    return changed
