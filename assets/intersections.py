"""Places where a surface cuts through itself."""

import numpy as np

from risorius.geometry.near_pairs import near_pairs
from risorius.geometry.rays import PARALLEL, crossings

from ..geometry.arrays import Flags
from .smooth import Points
from .topology import Faces


def self_intersections(vertices: Points, faces: Faces) -> Faces:
    """Pairs of faces without a common vertex that cut through each other, shape (k, 2)."""
    corner = np.asarray(vertices, dtype=np.float64)[faces]
    pairs = near_pairs(corner)
    first = pairs[:, 0]
    second = pairs[:, 1]
    apart = (faces[first][:, :, None] != faces[second][:, None, :]).all(axis=(1, 2))
    pairs = pairs[apart]
    hit = np.zeros(len(pairs), dtype=bool)
    for one, other in ((0, 1), (1, 0)):
        for k in range(3):
            start = corner[pairs[:, one], k]
            end = corner[pairs[:, one], (k + 1) % 3]
            hit |= _segment_cuts(start, end, corner[pairs[:, other]])
    return np.asarray(pairs[hit], np.int32)


def _segment_cuts(start: Points, end: Points, triangle: Points) -> Flags:
    """Flags of segments that cut triangles, row by row."""
    volume, u, v, along = crossings(start, end - start, triangle)
    margin = 1e-6  # relative; contact at a corner or an edge is no intersection
    in_triangle = (u > margin) & (v > margin) & (u + v < 1 - margin)
    return np.asarray(
        in_triangle & (along > margin) & (along < 1 - margin) & (np.abs(volume) > PARALLEL)
    )
