"""The current openings of a face between the lids and between the lips.

Light passes through an opening to an eyeball or into the mouth. Rims run through the rig's
landmarks: the rim of a lid is the cubic curve through its four landmarks.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from risorius.geometry.arrays import Floats64

INNER_LIP_LANDMARKS = slice(60, 68)  # landmarks of the inner edges of the lips
# Bone of the eyeball -> landmarks.
LID_LANDMARKS = {"eye_right": slice(36, 42), "eye_left": slice(42, 48)}
BEHIND_LIPS = ("teeth", "gums", "tongue", "oral_cavity")  # beginnings of names of parts


class Rim(NamedTuple):
    """The rim of an opening.

    points: shape (n, 3) [mm], the upper half first, clockwise as seen from outside.
    is_filled: whether the part in the opening reaches the rim.
    """

    points: Floats64
    is_filled: bool


def rims_of(landmarks: Floats64, point_count: int) -> dict[str, Rim]:
    """Return the openings by the eyeballs' bones and "mouth", from current landmarks (68, 3).

    point_count: even number of points of each rim.
    """
    of_lids = _rim_weights(6, point_count)
    of_lips = _rim_weights(8, point_count)
    rims = {bone: Rim(of_lids @ landmarks[lids], True) for bone, lids in LID_LANDMARKS.items()}
    return {**rims, "mouth": Rim(of_lips @ landmarks[INNER_LIP_LANDMARKS], False)}


def opening_before(name: str, bone: str) -> str:
    """Name the opening through which a part is visible; empty for other parts."""
    if name.startswith(BEHIND_LIPS):
        return "mouth"
    return bone if name.startswith("eyeball") else ""


@cache
def _rim_weights(count: int, point_count: int) -> Floats64:
    """Return weights of an opening's landmarks for the points of its rim, (point_count, count).

    Each half of the rim is the polynomial through its landmarks, from corner to corner.
    """
    of_half = count // 2
    knots = np.linspace(0.0, 1.0, of_half + 1)
    of_half_rim = point_count // 2
    fractions = np.arange(of_half_rim) / of_half_rim
    weights = np.vander(fractions, of_half + 1) @ np.linalg.inv(np.vander(knots, of_half + 1))
    found = np.zeros((2, of_half_rim, count))
    for half in range(2):
        columns = (half * of_half + np.arange(of_half + 1)) % count
        found[half][:, columns] = weights
    return found.reshape(point_count, count)
