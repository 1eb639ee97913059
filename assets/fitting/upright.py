"""Which way up the mesh of a head is, by its shape alone, before anything is marked on it.

The built-in face is laid on the mesh in each of the 24 ways in which axes can point, at several
sizes, since nobody knows how much of neck and shoulders hangs on the mesh. The way in which the
mesh is nearest to it wins.
"""

from __future__ import annotations

import itertools

import numpy as np
import scipy

from ..loading import load
from ..model import FloatArray
from .warp import Similarity

SHARES = (1.0, 0.85, 0.7, 0.55, 0.4)  # of the mesh's height that the built-in head may be
MOST_POINTS = 1500  # of the mesh, that are looked at


def upright(vertices: FloatArray, radius: float) -> Similarity:
    """What brings a mesh (V, 3) into the middle, `radius` large, and most likely upright."""
    middle = 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
    size = max(float(np.linalg.norm(vertices - middle, axis=1).max()), 1e-12)
    scale = radius / size
    some = vertices[:: max(len(vertices) // MOST_POINTS, 1)]
    head = load("head")
    face = head.vertices[head.vertices[:, 1] > head.vertices[head.landmarks[8], 1] - 10.0]
    best = min(axes_turned(), key=lambda turn: _off(scale * (some - middle) @ turn.T, face))
    return Similarity(scale, best, -scale * best @ middle)


def axes_turned() -> list[FloatArray]:
    """The 24 rotations that take axes to axes, the one that leaves them alone first."""
    turns = []
    for order in itertools.permutations(range(3)):
        for signs in itertools.product((1.0, -1.0), repeat=3):
            turn = np.zeros((3, 3))
            turn[range(3), order] = signs
            if np.linalg.det(turn) > 0.0:
                turns.append(turn)
    return turns


def _off(points: FloatArray, face: FloatArray) -> float:
    """How far a face is from points at the best of SHARES, as a share of its height."""
    tree, height = scipy.spatial.cKDTree(points), float(np.ptp(face[:, 1]))
    top, low = float(points[:, 1].max()), float(points[:, 1].min())
    found = []
    for share in SHARES:
        scale = share * (top - low) / height
        laid = scale * (face - (0.0, face[:, 1].max(), face[:, 2].mean()))
        upper = points[points[:, 1] > top - share * (top - low)]
        laid += (upper[:, 0].mean(), top, upper[:, 2].mean())
        found.append(float(tree.query(laid)[0].mean() / (scale * height)))
    return min(found)
