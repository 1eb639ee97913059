"""Sets of keys in a script, by track and time; they are fast even for half a million keys."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Set
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from risorius.geometry.arrays import Flags

KeyTimes = npt.NDArray[np.float64]  # [s], shape (K,), rising
NO_TIMES: KeyTimes = np.empty(0)


class KeyId(NamedTuple):
    """The track of a key, and its time [s]: both identify the key."""

    track: str
    time: float


class KeySet(Set[KeyId]):
    """An immutable set of keys: the times of its keys in each track."""

    def __init__(self, times: Mapping[str, KeyTimes]) -> None:
        """times: name of the track -> times [s], strictly rising."""
        self.times = {name: each for name, each in times.items() if len(each)}

    @classmethod
    def from_keys(cls, *keys: KeyId) -> KeySet:
        """Make a set of a few keys."""
        times: dict[str, set[float]] = {}
        for track, time in keys:
            times.setdefault(track, set()).add(time)
        return cls({name: np.array(sorted(each)) for name, each in times.items()})

    @classmethod
    def _from_iterable(cls, keys: Iterable[Any]) -> KeySet:  # type: ignore[override]
        return cls.from_keys(*keys)  # for the results of Set's operators

    def __contains__(self, key: object) -> bool:
        return isinstance(key, KeyId) and key.time in self.times.get(key.track, NO_TIMES)

    def __iter__(self) -> Iterator[KeyId]:
        return (KeyId(name, time) for name, each in self.times.items() for time in each.tolist())

    def __len__(self) -> int:
        return sum(map(len, self.times.values()))

    @property
    def first(self) -> float:
        """The earliest time [s]; the set must not be empty."""
        return min(float(each[0]) for each in self.times.values())

    def latest_in(self, edges: KeyTimes, names: Iterable[str]) -> KeyTimes:
        """Return the latest key time [s] in each interval of `edges`; omit intervals without keys.

        names: tracks whose keys count.
        """
        latest = np.full(len(edges) - 1, -np.inf)
        for times in (self.times[name] for name in names if name in self.times):
            first = np.searchsorted(times, edges)  # the first key at or after each edge
            has_key = first[1:] > first[:-1]
            latest[has_key] = np.maximum(latest[has_key], times[first[1:][has_key] - 1])
        found: KeyTimes = latest[np.isfinite(latest)]
        return found

    def nearest(self, time: float, reach: float) -> KeySet:
        """Return the keys at the key time nearest to `time`, if it is within `reach` [s]."""
        around = self.between(time - reach, time + reach).times
        times = [float(each[np.abs(each - time).argmin()]) for each in around.values()]
        nearest = min(times, key=lambda each: abs(each - time), default=time)
        return self.between(nearest, nearest)

    def between(self, first: float, last: float) -> KeySet:
        """Return the keys from one time to another [s]."""
        return KeySet(
            {
                name: each[np.searchsorted(each, first) : np.searchsorted(each, last, "right")]
                for name, each in self.times.items()
            }
        )

    def __or__(self, other: Set[Any]) -> KeySet:
        return self._combined(other, np.union1d)

    def __and__(self, other: Set[Any]) -> KeySet:
        return self._combined(other, np.intersect1d)

    def __sub__(self, other: Set[Any]) -> KeySet:
        return self._combined(other, np.setdiff1d)

    def _combined(
        self, other: Set[Any], combine: Callable[[KeyTimes, KeyTimes], KeyTimes]
    ) -> KeySet:
        second = other if isinstance(other, KeySet) else KeySet.from_keys(*other)
        other_times = second.times
        return KeySet(
            {
                name: combine(self.times.get(name, NO_TIMES), other_times.get(name, NO_TIMES))
                for name in (self.times | other_times)
            }
        )

    def __le__(self, other: Set[Any]) -> bool:
        return len(self & other) == len(self)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Set) and len(self) == len(other) and self <= other

    __hash__ = None  # type: ignore[assignment]


NO_KEYS = KeySet({})


def is_any_of(times: KeyTimes, others: KeyTimes, reach: float = 0.0) -> Flags:
    """Return which times are within `reach` [s] of one of the others."""
    if not len(others):
        return np.zeros(len(times), np.bool_)
    first = np.minimum(np.searchsorted(others, times - reach), len(others) - 1)
    is_near: Flags = np.abs(others[first] - times) <= reach
    return is_near
