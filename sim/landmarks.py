"""The 68 landmarks, and points relative to them.

A rig must fit any head, so it has no vertex indices and no world coordinates. Each of its points is
relative to the 68 iBug/Multi-PIE landmarks: a weighted mix of landmarks, plus an offset "lateral,
up, forward" in millimetres of a head of standard size (coordinates.py).

Source: Kähler, Haber, Yamauchi, Seidel 2002 ("Head shop"): landmarks carry muscles from head to
head.

    0-16  jaw line, from the subject's RIGHT ear to the left      36-41 right eye, 42-47 left eye
    17-21 right brow, 22-26 left brow                             48-59 outer lips, from the right
    27-30 bridge and tip of the nose, 31-35 nose base             60-67 inner lips, likewise
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from ..geometry.arrays import Floats64, Integers64

LANDMARK_COUNT = 68

# Landmarks in the middle of each lip. The inner points are left out, because they often coincide.
UPPER_LIP_MIDDLE = (50, 51, 52)
LOWER_LIP_MIDDLE = (56, 57, 58)
INNER_CORNERS = (60, 64)
UPPER_INNER_LIP = (60, 61, 62, 63, 64)  # the inner line of the upper lip
LOWER_INNER_LIP = (60, 67, 66, 65, 64)  # the inner line of the lower lip


class Side(Enum):
    """The subject's side; `sign` is the direction of "lateral" along the first standard axis."""

    RIGHT = "right"
    LEFT = "left"

    @property
    def sign(self) -> float:
        """+1 on the subject's left, -1 on the right."""
        return 1.0 if self is Side.LEFT else -1.0


# Of each eye: outer corner, the two upper lid points, inner corner, the two lower lid points.
EYE_LANDMARKS = {Side.RIGHT: (36, 37, 38, 39, 40, 41), Side.LEFT: (45, 44, 43, 42, 47, 46)}


def _mirror_table() -> Integers64:
    jaw = [(right, 16 - right) for right in range(8)]
    brows = [(right, 43 - right) for right in range(17, 22)]
    nostrils = [(31, 35), (32, 34)]
    eyes = [(36, 45), (37, 44), (38, 43), (39, 42), (40, 47), (41, 46)]
    outer_lips = [(48, 54), (49, 53), (50, 52), (55, 59), (56, 58)]
    inner_lips = [(60, 64), (61, 63), (65, 67)]
    table = np.arange(LANDMARK_COUNT)
    right, left = np.array([*jaw, *brows, *nostrils, *eyes, *outer_lips, *inner_lips]).T
    table[right] = left
    table[left] = right
    return table


MIRRORED_LANDMARKS = _mirror_table()  # number of the landmark on the other side of the face


@dataclass(frozen=True)
class LandmarkPoint:
    """A point of the LEFT half of the face: a mix of landmarks plus an offset [mm].

    The offset is lateral, up, forward.
    """

    mix: tuple[tuple[int, float], ...]
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def position(self, landmarks: Floats64, side: Side) -> Floats64:
        """Position [mm, standard space], shape (3,), on a head with these landmarks (68, 3).

        A point of the right side is the mirror image of its position in the rig.
        """
        mirrored = side is Side.RIGHT
        point = np.zeros(3)
        for number, weight in self.mix:
            point += weight * landmarks[MIRRORED_LANDMARKS[number] if mirrored else number]
        return point + np.array(self.offset) * (side.sign, 1.0, 1.0)


def mouth_line(landmarks: Floats64) -> Floats64:
    """The line between the inner lips, from corner to corner, (5, 3); landmarks: (68, 3)."""
    line: Floats64 = (landmarks[list(UPPER_INNER_LIP)] + landmarks[list(LOWER_INNER_LIP)]) / 2.0
    return line
