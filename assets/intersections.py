"""Places where a surface cuts through itself."""

import numpy as np

from risorius.geometry.near_pairs import near_pairs
from risorius.geometry.rays import cutting

from .smooth import Points
from .topology import Faces


def self_intersections(vertices: Points, faces: Faces) -> Faces:
    """Pairs of faces without a common vertex that cut through each other, shape (k, 2)."""
    corners = np.asarray(vertices, dtype=np.float64)[faces]
    pairs = near_pairs(corners)
    return np.asarray(pairs[cutting(corners, faces, pairs)], np.int32)
