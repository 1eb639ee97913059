"""Numbers of things among some of them."""

import numpy as np

from .arrays import Integers, Integers32


def places_among(chosen: Integers, count: int) -> Integers32:
    """Return the place of each of `count` things in the list `chosen` (n,), -1 for none, (count,).

    So `places_among(vertices, V)[faces]` has the corners of faces as rows of `vertices`.
    """
    places = np.full(count, -1, np.int32)
    places[chosen] = np.arange(len(chosen), dtype=np.int32)
    return places
