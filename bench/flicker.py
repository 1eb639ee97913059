"""How a refined surface moves from frame to frame: what pops and flickers, and what does not.

Rows of a refined mesh come and go, so it is looked at in places that stay: the same PLACES of every
input triangle, which `Refiner.origins` finds again in each frame.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from risorius import refine
from risorius.jit import njit

Array = npt.NDArray[np.float64]

QUARTERS = 4
PLACES: Array = (
    np.array(
        [[QUARTERS - i - j, i, j] for i in range(QUARTERS + 1) for j in range(QUARTERS + 1 - i)]
    )
    / QUARTERS
)
"""Where each triangle is looked at: barycentric coordinates, all points of a net of quarters."""
NEAR = 1e-4
"""Barycentric coordinates may be negative by so much: thirds are rounded."""
SLOW = 0.1
"""Frames in which the input moves less than this share of its largest motion are compared with
that share: a pop counts in slow frames, and rounding does not."""


def largest_jump(
    refiner: refine.Refiner,
    faces: npt.NDArray[np.integer],
    frames: Sequence[Array],
    view: refine.View,
) -> float:
    """How far a surface goes in one frame at most, positions of `frames` of shape (V, 3).

    The largest motion of any place over the largest motion of any input vertex in that frame.
    """
    moved = [
        float(np.linalg.norm(after - before, axis=1).max()) for before, after in pairwise(frames)
    ]
    least = SLOW * max(moved)
    jump = 0.0
    before = at_places(refiner, faces, refiner.refine(frames[0], view=view))
    for frame, motion in zip(frames[1:], moved, strict=True):
        points = at_places(refiner, faces, refiner.refine(frame, view=view))
        distance = np.linalg.norm(points - before, axis=2).max()
        jump = max(jump, float(distance) / max(motion, least))
        before = points
    return jump


def at_places(
    refiner: refine.Refiner, faces: npt.NDArray[np.integer], mesh: refine.RefinedMesh
) -> Array:
    """Points at the PLACES of all input triangles, shape (F, places, 3).

    Call it with the last frame of `refiner`.
    """
    origins = refiner.origins()
    found = np.zeros((len(faces), len(PLACES), 3))
    _find(PLACES, faces, (mesh.positions, mesh.triangles, mesh.source), origins, found)
    return found


@njit
def _find(places, faces, mesh, origins, found):  # type: ignore[no-untyped-def]
    """Write the point at each place, from the triangle of the mesh that it lies in."""
    positions, triangles, source = mesh
    corners = np.empty((3, 3))
    for t in range(triangles.shape[0]):
        face = source[t]
        corners[:] = 0.0
        for c in range(3):
            row = triangles[t, c]
            for k in range(3):
                for i in range(3):
                    if origins.vertices[row, k] == faces[face, i]:
                        corners[c, i] += origins.weights[row, k]
        (_, ax, ay), (_, bx, by), (_, cx, cy) = corners
        area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
        if area < NEAR * NEAR:
            continue  # a triangle that names a vertex twice has no coordinates
        for p in range(places.shape[0]):
            _, x, y = places[p]
            u = ((bx - x) * (cy - y) - (cx - x) * (by - y)) / area
            v = ((cx - x) * (ay - y) - (ax - x) * (cy - y)) / area
            weights = u, v, 1.0 - u - v
            if min(weights) < -NEAR:
                continue
            found[face, p] = 0.0
            for c in range(3):
                row = triangles[t, c]
                for i in range(3):
                    found[face, p, i] += weights[c] * positions[row, i]
