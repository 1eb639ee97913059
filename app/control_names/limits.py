"""Limits of controls; no other module cuts values off at their limits.

Tracks add to poses, gains multiply recorded values, and trackers overshoot. Only the final sum is
cut off, when it becomes the value of a control: in a key from a recording, or in the
`ControlValues` of a scene. `sim` refuses values beyond the limits. `Script.check` refuses absurd
values in a file.

This module also converts names to indices. A script or a stream has the same names in each frame,
so a cache keeps the indices.
"""

from __future__ import annotations

import functools
from collections.abc import ItemsView, Iterator, Mapping

import numpy as np
import numpy.typing as npt

from risorius.geometry.arrays import Floats64

from ..errors import UserError

Places = npt.NDArray[np.intp]  # indices of controls among all N of a scene


class Limits(dict[str, tuple[float, float]]):
    """The lowest and the highest value of each control of a scene, by its name."""

    def __init__(self, limits: Mapping[str, tuple[float, float]]) -> None:
        super().__init__(limits)
        self.place = {name: place for place, name in enumerate(limits)}
        self._low, self._high = np.array([*limits.values()], np.float64).reshape(-1, 2).T
        self.places = functools.lru_cache(256)(self._places)  # keeps this many sets of names

    def _places(self, names: tuple[str, ...]) -> Places:
        """Return the indices of controls, shape (n,). Raises UserError for an unknown name."""
        for name in names:
            if name not in self:
                raise UserError(f"there is no control called '{name}'")
        return np.array([self.place[name] for name in names], np.intp)

    def cut_off(self, sums: Floats64, places: Places) -> Floats64:
        """Cut sums off at the limits of controls; shape (n,), or (T,) for one control."""
        return np.asarray(np.minimum(np.maximum(sums, self._low[places]), self._high[places]))

    def pose(self, sums: Mapping[str, float], over: ControlValues | None = None) -> ControlValues:
        """Return values of all controls within limits; missing ones are taken from `over`, or 0.

        Raises UserError for an unknown name.
        """
        return self.posed(self.places(tuple(sums)), np.array([*sums.values()], np.float64), over)

    def posed(
        self, places: Places, sums: Floats64, over: ControlValues | None = None
    ) -> ControlValues:
        """Return the result of `pose` for indices instead of names; places, sums: shape (n,)."""
        numbers = np.zeros(len(self)) if over is None else over.numbers.copy()
        numbers[places] = self.cut_off(sums, places)
        return ControlValues(self, numbers)


class ControlValues(Mapping[str, float]):
    """A value for each control of a scene, within its limits: by name, or as `numbers` (N,)."""

    def __init__(self, limits: Limits, numbers: Floats64) -> None:
        """numbers: values within the limits, shape (N,); the array becomes read-only."""
        numbers.flags.writeable = False
        self.limits = limits
        self.numbers = numbers

    def __getitem__(self, name: str) -> float:
        return self.numbers.item(self.limits.place[name])

    def __iter__(self) -> Iterator[str]:
        return iter(self.limits)

    def __len__(self) -> int:
        return len(self.numbers)

    def items(self) -> ItemsView[str, float]:
        return dict(zip(self.limits, self.numbers.tolist(), strict=True)).items()

    def __eq__(self, other: object) -> bool:
        if isinstance(other, ControlValues):
            return np.array_equal(self.numbers, other.numbers)
        return super().__eq__(other)
