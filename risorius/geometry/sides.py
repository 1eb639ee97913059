"""The sides of triangles as pairs of vertices."""

import numpy as np

from .arrays import Integers


def sides_of(faces: Integers) -> Integers:
    """The directed sides of triangles (F, 3), shape (3 F, 2): first those from corner 0 to 1."""
    return np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
