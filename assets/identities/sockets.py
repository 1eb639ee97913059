"""Remove ridges from the steep skin between a person's inner brows and upper lids.

The modes may move neighbouring vertices there in different directions. The triangles of this skin
are long, so a ridge along their edges would look like a wedge, light on one side and dark on the
other.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ...geometry.arrays import Floats64, Integers32
from ...geometry.directions import unit_vectors
from ...geometry.normals import vertex_normals
from ..fitting.organs import EYE_LANDMARK_RANGES
from ..loading import load


class _Sockets(NamedTuple):
    """The skin between upper lids and brows, and its E edges that run down to the lids.

    vertex: indices of its vertices, (n,).
    bends: matrix from all vertices to the vectors of bending at the edges, (E, V).
    outward: unit normals of the skin at the edges, (E, 3).
    pulls: motion of each vertex that flattens an edge [mm/rad], (n, E).
    """

    vertex: Integers32
    bends: Floats64
    outward: Floats64
    pulls: Floats64


def without_ridges(vertices: Floats64) -> Floats64:
    """Remove ridges between inner brow and lid from a face; returns its vertices [mm], (V, 3)."""
    sockets = _sockets()
    x = vertices.copy()
    usual_angle = 0.1  # [rad]; smaller ridges are invisible
    rounds = 3  # repeated, because flattening an edge leaves smaller ridges at its neighbours
    for _ in range(rounds):
        angles = (sockets.bends @ x * sockets.outward).sum(axis=1)
        ridges = np.maximum(angles - usual_angle, 0.0)
        x[sockets.vertex] -= sockets.pulls @ (ridges[:, None] * sockets.outward)
    return x


@lru_cache(maxsize=1)
def _sockets() -> _Sockets:
    """Find the sockets of the built-in head.

    Bending at an edge follows Bergou and others 2006, "A quadratic bending model for inextensible
    surfaces" (SGP). Pulls minimise the sum of squared bends and squared displacements.
    """
    head = load("head")
    inner_count = 6  # points in the inner half of a lid's row; the outer half is a hood
    stiffness = 0.015  # weight of squared displacements [rad²/mm²], chosen by eye
    edges = []
    wings = []
    corners: dict[tuple[int, int], list[int]] = {}  # edge -> opposite corners of its triangles
    for a, b, c in head.faces.tolist():
        for first, second, wing in ((a, b, c), (b, c, a), (c, a, b)):
            corners.setdefault((min(first, second), max(first, second)), []).append(wing)
    for side in EYE_LANDMARK_RANGES:
        rows = [head.rings[f"eye_{row}_{side}"].tolist() for row in range(5)]
        lid = {*rows[4][1:inner_count]}
        around = {vertex for row in rows for vertex in row}
        for edge, two in corners.items():
            if len({*edge} & lid) == 1 and len({*edge} - around) == 1:
                edges.append(edge)
                wings.append(two)
    x = head.vertices
    bends = np.array([_hinge(x, *each) for each in zip(edges, wings, strict=True)])
    normals = vertex_normals(x, head.faces)[np.array(edges)].sum(axis=1)
    free = np.unique(edges)
    near = bends[:, free]
    held = near.T @ near + stiffness * np.eye(len(free))
    return _Sockets(
        vertex=free.astype(np.int32),
        bends=bends,
        outward=unit_vectors(normals),
        pulls=np.linalg.solve(held, near.T),
    )


def _hinge(x: Floats64, edge: tuple[int, int], wings: list[int]) -> Floats64:
    """Return weights of vertices, (V,), that give an angle [rad] times the edge's normal."""
    a, b = edge
    weights = np.zeros(len(x))
    for wing in wings:
        for near, far in ((a, b), (b, a)):
            along = x[far] - x[near]
            off = x[wing] - x[near]
            twice = float(np.linalg.norm(np.cross(along, off)))
            cotangent = along @ off / twice
            weights[far] += cotangent
            weights[wing] -= cotangent
    return np.asarray(weights / np.linalg.norm(x[b] - x[a]))
