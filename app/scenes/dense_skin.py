"""A skin with too many triangles to simulate in real time; it follows a simplified mesh.

The vertices of the skin are bound to the simplified mesh at rest (refine.Embedding). No triangle is
split, because the embedding evaluates the smooth surface at each vertex.
"""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING

import numpy as np

from risorius import sim
from risorius.geometry.arrays import Floats64, Integers32
from risorius.geometry.normals import vertex_normals
from risorius.geometry.read_only import read_only

if TYPE_CHECKING:
    from risorius.refine import Embedding


class DenseSkin:
    """The vertices of a skin that a simulation with fewer vertices moves.

    rest_positions: vertices at rest [mm], shape (V, 3), read only.
    """

    def __init__(
        self,
        vertices: Floats64,
        faces: Integers32,
        simulation: sim.Simulation,
        lips: tuple[Integers32, Integers32] | None = None,
    ) -> None:
        """Bind vertices at rest (V, 3), with triangles (F, 3), to the mesh of `simulation`.

        lips: the lip of each vertex, and of each simulated vertex: 1 the upper, -1 the lower, 0
        none; shapes (V,) and (K,).
        """
        self.rest_positions = vertices
        # Normals prevent that vertices of the upper lip are bound to the lower lip.
        normals = _smooth_normals(vertices, faces)
        self._embedding = _embedded(vertices, normals, simulation, lips)
        self._positions = vertices.copy()
        self._shown = read_only(self._positions)
        self._wanted: Floats64 | None = None  # simulated vertices to follow at the next read

    def follow(self, simulated: Floats64) -> None:
        """Follow simulated vertices, shape (K, 3), at the next read of `positions`.

        A frame has several simulation steps, and positions are read only after the last step.
        """
        self._wanted = simulated

    @property
    def positions(self) -> Floats64:
        """Current positions [mm], shape (V, 3), read only; always the same view."""
        if self._wanted is not None:
            moved = self._embedding.evaluate(self._wanted, with_normals=False).positions
            self._positions[:] = moved
            self._wanted = None
        return self._shown

    def carry(self, values: Floats64) -> Floats64:
        """Carry values of simulated vertices, shape (K,), to vertices of the skin, shape (V,)."""
        return self._embedding.carry(values)

    def clone(self) -> DenseSkin:
        """Return a copy of the skin, which moves independently."""
        twin = copy.copy(self)
        twin._embedding = copy.deepcopy(self._embedding)
        twin._positions = self._positions.copy()
        twin._shown = read_only(twin._positions)
        return twin


def _embedded(
    vertices: Floats64,
    normals: Floats64,
    simulation: sim.Simulation,
    lips: tuple[Integers32, Integers32] | None,
) -> Embedding:
    """Bind vertices (V, 3) to the nearest simulated triangles that are not on the other lip.

    Lips that were sealed face the same way, so their normals do not distinguish them.
    """
    from risorius.refine import Binding, Embedding  # few heads need it

    coarse = (simulation.faces, simulation.rest_positions)
    found = Embedding(*coarse, vertices, binding=Binding(normals=normals))
    if lips is None:
        return found
    own, simulated = lips
    triangles = found.triangles.copy()
    weights = found.weights.copy()
    for side in (1, -1):
        is_other_lip = (simulated == -side)[simulation.faces].any(axis=1)
        wrong = np.flatnonzero((own == side) & is_other_lip[triangles])
        if len(wrong):
            better = Embedding(
                *coarse,
                vertices[wrong],
                binding=Binding(
                    normals=normals[wrong],
                    labels=(np.zeros(len(wrong), np.int32), is_other_lip.astype(np.int32)),
                ),
            )
            triangles[wrong] = better.triangles
            weights[wrong] = better.weights
    if np.array_equal(triangles, found.triangles):
        return found
    corrected = Binding(normals=normals, places=(triangles, weights))
    return Embedding(*coarse, vertices, binding=corrected)


def _smooth_normals(vertices: Floats64, faces: Integers32) -> Floats64:
    """Return sums of unit normals around vertices, shape (V, 3).

    In a scan, single triangles can be folded, and the normal of one vertex then points inward.
    """
    normals = vertex_normals(vertices, faces)
    corners = faces.ravel()
    rounds = 2  # each round includes one more ring of neighbours
    for _ in range(rounds):
        sums = np.repeat(normals[faces].sum(axis=1), 3, axis=0)
        columns = [np.bincount(corners, each, len(vertices)) for each in sums.T]
        normals = np.stack(columns, axis=1)
    return normals
