"""Angles of head and eyes as ARKit's writers give them: Live Link Face in radians, some in degrees.

ARKit's shapes eyeLookDown, eyeLookIn ... follow its eye angles, so they tell where an eye looks
ahead. Live Link Face writes, fitted to a real take (correlation 0.98 to 0.999; [rad], + is down and
to the subject's right):

    pitch = 0.61 down - 0.44 up
    yaw = 0.62 in - 0.59 out - 0.07 of the left eye, the opposite of the right eye

So its axes stand 4 degrees outwards of where the eyes look, as the axis of a real eyeball does.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from .take import Array

LARGEST_DEGREES = 360.0  # what is larger is no angle in any unit
LARGEST_RADIANS = 1.6  # no head that is seen turns further, nor an eye
MOVES = 0.005  # [rad] standard deviation of a look that tells something
FOLLOWS = 0.9  # correlation that tells where an eye looks ahead
CENTRED = 0.01  # [rad] by which it may be off unnoticed


def in_degrees(
    angles: Mapping[str, Array], shapes: Mapping[str, Array], notes: list[str]
) -> dict[str, Array]:
    """Angles in degrees, + to the subject's left, up, to the left shoulder.

    angles: name of ours -> as the file has it. shapes: ARKit name -> 0 to 1, for comparison. Both
    of shape (T,), NaN where nothing is known.
    """
    angles = {
        name: np.where(np.abs(values) > LARGEST_DEGREES, np.nan, values)
        for name, values in angles.items()
    }
    moving = {name: values for name, values in angles.items() if np.nan_to_num(values).any()}
    if len(moving) < len(angles):
        still = ", ".join(name for name in angles if name not in moving)
        notes.append(f"Always 0, as if switched off, and left out: {still}.")
    if not moving:
        return {}
    size = max(float(np.nanpercentile(np.abs(values), 99)) for values in moving.values())
    is_radians = size <= LARGEST_RADIANS
    unit = "radians" if is_radians else "degrees"
    notes.append(f"Angles reach {size:.2g} and were taken for {unit}.")
    looks = looks_of(shapes)
    outward = {name: _outward(values, looks.get(name)) for name, values in moving.items()}
    if any(outward.values()):
        notes.append("The eyeballs' axes stand outwards of where the eyes look; that was undone.")
    scale = -180.0 / math.pi if is_radians else -1.0  # ARKit's writers count down and to the right
    return {name: scale * (values - outward[name]) for name, values in moving.items()}


def looks_of(shapes: Mapping[str, Array]) -> dict[str, Array]:
    """The eye angles [rad], + = down and to the subject's right, that the eyeLook shapes tell."""
    found = {}
    for side, towards_right in (("left", 1.0), ("right", -1.0)):
        name = side.capitalize()
        down, up = shapes.get(f"eyeLookDown{name}"), shapes.get(f"eyeLookUp{name}")
        inward, out = shapes.get(f"eyeLookIn{name}"), shapes.get(f"eyeLookOut{name}")
        if down is not None and up is not None:
            found[f"eye_pitch_{side}"] = 0.61 * down - 0.44 * up
        if inward is not None and out is not None:
            found[f"eye_yaw_{side}"] = towards_right * (0.62 * inward - 0.59 * out)
    return found


def _outward(values: Array, look: Array | None) -> float:
    """How far an angle is off, in its own unit, where the shapes say that the eye looks ahead."""
    if look is None or _correlation(values, look) < FOLLOWS:
        return 0.0
    angle, seen = _both_known(values, look)
    slope, offset = np.polyfit(seen, angle, 1)
    return float(offset) if abs(offset) > CENTRED * abs(slope) else 0.0


def _both_known(first: Array, second: Array) -> tuple[Array, Array]:
    """The frames of two channels in which both are known."""
    known = np.isfinite(first) & np.isfinite(second)
    return first[known], second[known]


def _correlation(column: Array | None, look: Array | None) -> float:
    """Of an angle with what the shapes tell; 0 where either is missing or does not move."""
    if column is None or look is None:
        return 0.0
    column, look = _both_known(column, look)
    if len(column) < 10 or np.std(look) < MOVES or np.std(column) < 1e-9:
        return 0.0
    return float(np.corrcoef(column, look)[0, 1])
