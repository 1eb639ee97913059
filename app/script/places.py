"""Places of keys in a script: sets of them, which a take of half a million keys makes no slower."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Set
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

Times = npt.NDArray[np.float64]  # [s], shape (K,), rising


class KeyPlace(NamedTuple):
    """Where a key is: the track, and the time [s] in it."""

    track: str
    time: float


class Places(Set[KeyPlace]):
    """A set of places that never changes: of each track that is in it, the times of its keys."""

    _columns: tuple[float, float, int] = (0.0, 0.0, 0)  # for which is remembered ...
    _latest: dict[tuple[str, ...], Times]  # ... what is in them, by the tracks that were asked for

    def __init__(self, times: Mapping[str, Times]) -> None:
        """times: by the name of the track; rising, each time once."""
        self.times = {name: each for name, each in times.items() if len(each)}

    @classmethod
    def of(cls, *places: KeyPlace) -> Places:
        """The set of a few places."""
        return cls._from_iterable(places)

    @classmethod
    def _from_iterable(cls, places: Iterable[Any]) -> Places:  # type: ignore[override]
        times: dict[str, set[float]] = {}
        for track, time in places:
            times.setdefault(track, set()).add(time)
        return cls({name: np.array(sorted(each)) for name, each in times.items()})

    def __contains__(self, place: object) -> bool:
        if not isinstance(place, KeyPlace) or place.track not in self.times:
            return False
        return bool(among(np.array([place.time]), self.times[place.track])[0])

    def __iter__(self) -> Iterator[KeyPlace]:
        return (KeyPlace(name, time) for name, each in self.times.items() for time in each.tolist())

    def __len__(self) -> int:
        return sum(map(len, self.times.values()))

    @property
    def first(self) -> float:
        """The earliest time [s]; of a set that is not empty."""
        return min(float(each[0]) for each in self.times.values())

    def latest_in(self, edges: Times, names: Iterable[str]) -> Times:
        """The latest time between each two of the times `edges` that has any in these tracks [s].

        Remembered as long as the edges stay, since it is asked for in each frame.
        """
        columns = float(edges[0]), float(edges[-1]), len(edges)
        if columns != self._columns:
            self._columns, self._latest = columns, {}
        tracks = tuple(names)
        if tracks not in self._latest:
            latest = np.full(len(edges) - 1, -np.inf)
            for times in (self.times[name] for name in tracks if name in self.times):
                after = np.searchsorted(times, edges)
                is_there = after[1:] > after[:-1]
                latest[is_there] = np.maximum(latest[is_there], times[after[1:][is_there] - 1])
            self._latest[tracks] = latest[np.isfinite(latest)]
        return self._latest[tracks]

    def near(self, time: float, reach: float) -> Places:
        """Those at the time nearest to this one, none if that is further than `reach` [s]."""
        times = {name: _nearest(each, time) for name, each in self.times.items()}
        nearest = min(times.values(), key=lambda each: abs(each - time), default=np.inf)
        if abs(nearest - time) > reach:
            return NOWHERE
        return Places({name: np.array([each]) for name, each in times.items() if each == nearest})

    def between(self, first: float, last: float) -> Places:
        """Those from one time to another [s]."""
        return Places(
            {
                name: each[np.searchsorted(each, first) : np.searchsorted(each, last, "right")]
                for name, each in self.times.items()
            }
        )

    def __or__(self, other: Set[Any]) -> Places:
        theirs = _places(other).times
        joined = {
            name: each if name not in theirs else np.union1d(each, theirs[name])
            for name, each in self.times.items()
        }
        return Places(theirs | joined)

    def __and__(self, other: Set[Any]) -> Places:
        return self._filtered(_places(other), are_kept=True)

    def __sub__(self, other: Set[Any]) -> Places:
        return self._filtered(_places(other), are_kept=False)

    def __le__(self, other: Set[Any]) -> bool:
        return len(self & other) == len(self)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Set) and len(self) == len(other) and self <= other

    __hash__ = None  # type: ignore[assignment]

    def _filtered(self, other: Places, *, are_kept: bool) -> Places:
        """What is in the other set as well, or what is not."""
        nothing = np.empty(0)
        return Places(
            {
                name: each[among(each, other.times.get(name, nothing)) == are_kept]
                for name, each in self.times.items()
            }
        )


NOWHERE = Places({})


def among(times: Times, others: Times, reach: float = 0.0) -> npt.NDArray[np.bool_]:
    """Which of the times are one of the others, or no further from one than `reach` [s]."""
    is_among = np.zeros(len(times), np.bool_)
    if len(others):
        begin = np.searchsorted(times, others[0] - reach)
        stretch = slice(begin, np.searchsorted(times, others[-1] + reach, "right"))
        inner = times[stretch]
        if np.array_equal(inner, others):  # as a box selects them
            is_among[stretch] = True
        else:
            after = np.searchsorted(others, inner - reach)
            is_among[stretch] = others[np.minimum(after, len(others) - 1)] <= inner + reach
    return is_among


def _nearest(times: Times, time: float) -> float:
    after = int(np.searchsorted(times, time))
    around = times[max(after - 1, 0) : after + 1].tolist()
    return float(min(around, key=lambda each: abs(each - time)))


def _places(others: Set[Any]) -> Places:
    return others if isinstance(others, Places) else Places._from_iterable(others)
