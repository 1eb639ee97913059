"""Where lines meet triangles.

Source: Möller, Trumbore 1997, "Fast, minimum storage ray/triangle intersection", Journal of
Graphics Tools 2:21-28.
"""

import numpy as np

from .normals import Doubles

PARALLEL = 1e-12  # below it a triangle is seen from its edge, and nothing is met


def crossings(origins: Doubles, directions: Doubles, corners: Doubles) -> tuple[Doubles, ...]:
    """Of each line `origin + t direction` and its triangle: volume, weights u and v, and t.

    origins, directions: (n, 3) or (3,). corners: (n, 3, 3). volume: six times that of direction
    and triangle, above 0 where the line comes from outside; the rest is 0 where it is PARALLEL.
    The triangle is met where u, v and 1 - u - v are not negative. Four arrays (n,).
    """
    a, ab, ac = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    across, from_a = np.cross(directions, ac), origins - a
    turned, volume = np.cross(from_a, ab), (ab * across).sum(axis=1)
    is_met = np.abs(volume) > PARALLEL
    share = np.divide(1.0, volume, out=np.zeros_like(volume), where=is_met)
    u, v = (from_a * across).sum(axis=1), (turned * directions).sum(axis=1)
    return volume, u * share, v * share, (ac * turned).sum(axis=1) * share
