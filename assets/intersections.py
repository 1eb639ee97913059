"""Where a surface cuts through itself."""

import numpy as np
import scipy

from risorius.geometry.rays import PARALLEL, crossings

from ..geometry.arrays import Flags, Integers64
from .smooth import Points
from .topology import Faces


def self_intersections(vertices: Points, faces: Faces) -> Faces:
    """Pairs of faces without a common vertex that cut through each other, shape (k, 2)."""
    corner = vertices[faces]
    pairs = _near_pairs(corner)
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


def _near_pairs(corner: Points) -> Integers64:
    """Pairs of triangles whose surrounding balls meet, each pair once, shape (k, 2)."""
    centre = corner.mean(axis=1)
    radius = np.linalg.norm(corner - centre[:, None], axis=2).max(axis=1)
    near = scipy.spatial.cKDTree(centre).query_ball_point(centre, 2.0 * radius)  # of the larger one
    second = np.concatenate(near).astype(np.int64)
    first = np.repeat(np.arange(len(near)), [len(each) for each in near])
    rank = np.argsort(np.argsort(radius))
    pairs = np.sort(np.column_stack([first, second])[rank[first] > rank[second]], axis=1)
    distance = np.linalg.norm(centre[pairs[:, 0]] - centre[pairs[:, 1]], axis=1)
    return np.asarray(pairs[distance < radius[pairs].sum(axis=1)])


def _segment_cuts(start: Points, end: Points, triangle: Points) -> Flags:
    """Whether segments cut triangles, row by row."""
    volume, u, v, along = crossings(start, end - start, triangle)
    margin = 1e-6  # relative; touching at a corner or an edge does not count as intersecting
    in_triangle = (u > margin) & (v > margin) & (u + v < 1 - margin)
    return np.asarray(
        in_triangle & (along > margin) & (along < 1 - margin) & (np.abs(volume) > PARALLEL)
    )
