"""Conversion of angles of head and eyes from the units and signs in tables and JSON."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from risorius.geometry.arrays import Floats64

from .names import measured


def in_degrees(
    angles: Mapping[str, Floats64], outward: Mapping[str, float], notes: list[str]
) -> dict[str, Floats64]:
    """Convert angles to degrees, positive to the subject's left, up, and to the left shoulder.

    angles: our name -> values of the file, shape (T,), NaN where unknown. outward: name -> offset
    of an eyeball's axis [degrees]. notes: list to which remarks for the report are added.
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
    largest_radians = 1.6  # no visible head and no eye turns further
    is_radians = size <= largest_radians
    unit = "radians" if is_radians else "degrees"
    notes.append(f"Angles reach {size:.2g} and were read as {unit}.")
    scale = -180.0 / math.pi if is_radians else -1.0
    return {name: scale * values - outward.get(name, 0.0) for name, values in moving.items()}
