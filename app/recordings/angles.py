"""Units and signs of angles of the head and the eyes, as tables and JSON write them."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from risorius.geometry.arrays import Floats64

from .names import measured


def in_degrees(
    angles: Mapping[str, Floats64], outward: Mapping[str, float], notes: list[str]
) -> dict[str, Floats64]:
    """Angles in degrees, + to the subject's left, up, to the left shoulder.

    angles: name of ours -> as the file has it, shape (T,), NaN where nothing is known. outward: by
    how much the axes of eyeballs are off [degrees].
    """
    moving = {}
    for name, values in angles.items():
        kept = measured(name, values)
        if np.nan_to_num(kept).any():
            moving[name] = kept
    if len(moving) < len(angles):
        still = ", ".join(name for name in angles if name not in moving)
        notes.append(f"Always 0, as if switched off, and left out: {still}.")
    if not moving:
        return {}
    size = max(float(np.nanpercentile(np.abs(values), 99)) for values in moving.values())
    largest_radians = 1.6  # no head that is seen turns further, nor an eye
    is_radians = size <= largest_radians
    unit = "radians" if is_radians else "degrees"
    notes.append(f"Angles reach {size:.2g} and were taken for {unit}.")
    scale = -180.0 / math.pi if is_radians else -1.0
    return {name: scale * values - outward.get(name, 0.0) for name, values in moving.items()}
