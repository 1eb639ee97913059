"""The 68 landmarks as people mark them: where each is so far, what it is called, what is next."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from risorius.assets.fitting.guess import FIRST
from risorius.sim.landmarks import LANDMARK_COUNT, MIRRORED

Place = tuple[float, float, float]  # in the mesh's own coordinates
Colour = tuple[float, float, float]  # sRGB


@dataclass(frozen=True)
class Group:
    """Landmarks that follow each other.

    lines: of numbers, as they are joined. zoom, yaw: from where they are shown best; a group of
    both sides is shown from the point's own side [degrees].
    """

    title: str
    colour: Colour
    lines: tuple[tuple[int, ...], ...]
    zoom: float
    yaw: float = 0.0

    @property
    def numbers(self) -> tuple[int, ...]:
        """Its landmarks, each once, in the order of marking."""
        return tuple(dict.fromkeys(number for line in self.lines for number in line))


def _row(first: int, last: int, *more: int) -> tuple[int, ...]:
    return (*range(first, last + 1), *more)


GROUPS = (  # in the order of marking
    Group("eyes", (0.96, 0.55, 0.08), (_row(36, 41, 36), _row(42, 47, 42)), 4.2, 25.0),
    Group("outer lips", (0.86, 0.18, 0.26), (_row(48, 59, 48),), 3.6),
    Group("inner lips", (0.93, 0.76, 0.20), (_row(60, 67, 60),), 3.6),
    Group("nose", (0.10, 0.62, 0.42), (_row(27, 30), _row(31, 35)), 3.2, 20.0),
    Group("brows", (0.58, 0.36, 0.84), (_row(17, 21), _row(22, 26)), 3.2),
    Group("jaw line", (0.16, 0.48, 0.88), (_row(0, 16),), 1.5, 50.0),
)
GROUP_OF = {number: group for group in GROUPS for number in group.numbers}
ORDER = tuple(GROUP_OF)

_ONE_SIDE = {  # those of the right side, and in the middle
    0: "right jaw line, beside the ear",
    **{n: f"right jaw line, {n} eighths of the way from the ear to the chin" for n in range(1, 8)},
    8: "lowest point of the chin",
    17: "outer end of the right brow",
    18: "right brow, a quarter of its length from the outer end",
    19: "middle of the right brow",
    20: "right brow, a quarter of its length from the inner end",
    21: "inner end of the right brow",
    27: "bridge of the nose, between the eyes",
    28: "bridge of the nose, a third of the way down",
    29: "bridge of the nose, two thirds of the way down",
    30: "tip of the nose",
    31: "right wing of the nose, where it meets the lip",
    32: "under the right nostril, where nose and lip meet",
    33: "under the middle of the nose, where it meets the lip",
    36: "outer corner of the right eye",
    37: "upper lid of the right eye, outer third",
    38: "upper lid of the right eye, inner third",
    39: "inner corner of the right eye",
    40: "lower lid of the right eye, inner third",
    41: "lower lid of the right eye, outer third",
    48: "right corner of the mouth",
    49: "upper edge of the red, halfway from the right corner to the peak",
    50: "right peak of the upper lip",
    51: "dip in the middle of the upper lip",
    57: "lower edge of the red, in the middle",
    58: "lower edge of the red, a third of the way to the right corner",
    59: "lower edge of the red, two thirds of the way to the right corner",
    60: "right corner of the mouth, where the lips meet",
    61: "where the upper lip ends inside, toward the right corner",
    62: "where the upper lip ends inside, in the middle",
    66: "where the lower lip ends inside, in the middle",
    67: "where the lower lip ends inside, toward the right corner",
}
_SIDES = {
    "right": "the person's right: on your left as the face looks at you",
    "left": "the person's left: on your right as the face looks at you",
}


def name_of(number: int) -> str:
    """What a landmark is called, in plain words."""
    known = _ONE_SIDE.get(number)
    return known or _ONE_SIDE[int(MIRRORED[number])].replace("right", "left")


def side_of(number: int) -> str:
    """On which side it is, as one sees it; "" in the middle."""
    return next((words for side, words in _SIDES.items() if side in name_of(number)), "")


@dataclass(frozen=True)
class Marks:
    """Where landmarks are, as far as they are placed; `guessed` are those that nobody moved."""

    places: Mapping[int, Place]
    guessed: frozenset[int] = frozenset()

    def placed(self, number: int, place: npt.ArrayLike) -> Marks:
        """The same with one that was placed by hand."""
        x, y, z = np.asarray(place, np.float64).tolist()
        return Marks({**self.places, number: (x, y, z)}, self.guessed - {number})

    def with_guessed(self, found: npt.NDArray[np.float64]) -> Marks:
        """The same with all 68 (68, 3) where they were guessed, but those placed by hand."""
        guessed = {n: (x, y, z) for n, (x, y, z) in enumerate(found.tolist())}
        return Marks({**guessed, **self.by_hand}, frozenset(guessed.keys() - self.by_hand.keys()))

    @property
    def by_hand(self) -> dict[int, Place]:
        """Those that were not guessed."""
        return {n: place for n, place in self.places.items() if n not in self.guessed}

    @property
    def is_complete(self) -> bool:
        """Whether all 68 are there."""
        return len(self.places) == LANDMARK_COUNT

    @property
    def asked(self) -> int | None:
        """The first point that must be marked next; None where the rest can be guessed."""
        return next((number for number in FIRST if number not in self.places), None)
