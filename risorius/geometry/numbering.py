"""Numbers of things: of chosen ones, and of equal ones."""

from typing import Any

import numpy as np
import numpy.typing as npt

from .arrays import Integers, Integers32, Integers64


def places_among(chosen: Integers, count: int) -> Integers32:
    """Return the place of each of `count` things in the list `chosen` (n,), -1 for none, (count,).

    So `places_among(vertices, V)[faces]` has the corners of faces as rows of `vertices`.
    """
    places = np.full(count, -1, np.int32)
    places[chosen] = np.arange(len(chosen), dtype=np.int32)
    return places


def numbered_by_first_use(things: npt.NDArray[Any]) -> tuple[Integers64, Integers64]:
    """Give equal numbers (n,), or equal rows (n, k), one index, in the order of their first use.

    Returns the place of the first use of each index, (m,), and the index of each thing, (n,). In
    this order neighbours in a mesh are near each other in memory.
    """
    axis = 0 if things.ndim > 1 else None
    _, first, sorted_index = np.unique(things, axis=axis, return_index=True, return_inverse=True)
    order = np.argsort(first)
    index = np.empty(len(order), np.int64)
    index[order] = np.arange(len(order))
    return first[order].astype(np.int64), index[sorted_index.reshape(-1)]
