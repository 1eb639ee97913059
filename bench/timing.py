"""How things are timed here: interleaved, forwards and backwards in turn.

On a shared machine times drift by a third within a run, so only calls of one run can be compared,
and each round takes them all. Garbage collection is off meanwhile.

A call is as fast as what ran before it left the caches. Of three or more calls each always follows
the same neighbours, so where two are compared closely they are timed as a pair, by themselves.
"""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

WARMING = 2  # untimed calls of each in a pair


def paired(
    first: Callable[[], object], second: Callable[[], object], rounds: int
) -> npt.NDArray[np.float64]:
    """Return the seconds of two calls in each round, shape (rounds, 2).

    The order is first, second, second, first and so on: each follows itself as often as the other.
    """
    for call in (first, second) * WARMING:
        call()
    return interleaved((first, second), rounds)


def interleaved(
    calls: Sequence[Callable[[], object]],
    rounds: int,
    *,
    prepare: Sequence[Callable[[], object]] | None = None,
) -> npt.NDArray[np.float64]:
    """Return the seconds of each call in each round, shape (rounds, len(calls)).

    `prepare`: what is done before each of the calls, and not timed.
    """
    seconds = np.zeros((rounds, len(calls)))
    was_collecting = gc.isenabled()
    gc.disable()
    try:
        for turn in range(rounds):
            order = range(len(calls)) if turn % 2 == 0 else reversed(range(len(calls)))
            for k in order:
                if prepare is not None:
                    prepare[k]()
                start = time.perf_counter()
                calls[k]()
                seconds[turn, k] = time.perf_counter() - start
    finally:
        if was_collecting:
            gc.enable()
    return seconds
