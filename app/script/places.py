"""Sets of keys in a script, by track and time; they are fast even for half a million keys."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Set
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from risorius.geometry.arrays import Flags

Times = npt.NDArray[np.float64]  # [s], shape (K,), rising
NOTHING: Times = np.empty(0)


class KeyPlace(NamedTuple):
    """The track of a key, and its time [s]."""

    track: str
    time: float


class Places(Set[KeyPlace]):
    """An immutable set of keys: their times in each track."""

    def __init__(self, times: Mapping[str, Times]) -> None:
        """times: name of the track -> times [s], strictly rising."""
        self.times = {name: each for name, each in times.items() if len(each)}

    @classmethod
    def of(cls, *places: KeyPlace) -> Places:
        """Make a set of a few keys."""
        times: dict[str, set[float]] = {}
        for track, time in places:
            times.setdefault(track, set()).add(time)
        return cls({name: np.array(sorted(each)) for name, each in times.items()})

    @classmethod
    def _from_iterable(cls, places: Iterable[Any]) -> Places:  # type: ignore[override]
        return cls.of(*places)  # for the results of Set's operators

    def __contains__(self, place: object) -> bool:
        return isinstance(place, KeyPlace) and place.time in self.times.get(place.track, NOTHING)

    def __iter__(self) -> Iterator[KeyPlace]:
        return (KeyPlace(name, time) for name, each in self.times.items() for time in each.tolist())

    def __len__(self) -> int:
        return sum(map(len, self.times.values()))

    @property
    def first(self) -> float:
        """The earliest time [s]; the set must not be empty."""
        return min(float(each[0]) for each in self.times.values())

    def latest_in(self, edges: Times, names: Iterable[str]) -> Times:
        """Return the latest key time [s] in each interval of `edges`; omit intervals without keys.

        names: tracks whose keys count.
        """
        latest = np.full(len(edges) - 1, -np.inf)
        for times in (self.times[name] for name in names if name in self.times):
            after = np.searchsorted(times, edges)
            is_there = after[1:] > after[:-1]
            latest[is_there] = np.maximum(latest[is_there], times[after[1:][is_there] - 1])
        found: Times = latest[np.isfinite(latest)]
        return found

    def near(self, time: float, reach: float) -> Places:
        """Return the keys at the key time nearest to `time`, if it is within `reach` [s]."""
        around = self.between(time - reach, time + reach).times
        nearest = min(
            (float(each[np.abs(each - time).argmin()]) for each in around.values()),
            key=lambda each: abs(each - time),
            default=time,
        )
        return self.between(nearest, nearest)

    def between(self, first: float, last: float) -> Places:
        """Return the keys from one time to another [s]."""
        return Places(
            {
                name: each[np.searchsorted(each, first) : np.searchsorted(each, last, "right")]
                for name, each in self.times.items()
            }
        )

    def __or__(self, other: Set[Any]) -> Places:
        return self._joined(other, np.union1d)

    def __and__(self, other: Set[Any]) -> Places:
        return self._joined(other, np.intersect1d)

    def __sub__(self, other: Set[Any]) -> Places:
        return self._joined(other, np.setdiff1d)

    def _joined(self, other: Set[Any], join: Callable[[Times, Times], Times]) -> Places:
        theirs = (other if isinstance(other, Places) else Places.of(*other)).times
        return Places(
            {
                name: join(self.times.get(name, NOTHING), theirs.get(name, NOTHING))
                for name in (self.times | theirs)
            }
        )

    def __le__(self, other: Set[Any]) -> bool:
        return len(self & other) == len(self)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Set) and len(self) == len(other) and self <= other

    __hash__ = None  # type: ignore[assignment]


NOWHERE = Places({})


def among(times: Times, others: Times, reach: float = 0.0) -> Flags:
    """Return which times are within `reach` [s] of one of the others."""
    if not len(others):
        return np.zeros(len(times), np.bool_)
    after = np.minimum(np.searchsorted(others, times - reach), len(others) - 1)
    is_among: Flags = np.abs(others[after] - times) <= reach
    return is_among
