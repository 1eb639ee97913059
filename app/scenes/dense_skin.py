"""A skin of more triangles than can be simulated in time: it follows a simplified mesh.

Its vertices are bound to that mesh at rest (refine.Embedding). No triangle is split for it: the
embedding evaluates the smooth surface at each vertex.
"""

from __future__ import annotations

import copy

import numpy as np

from risorius import sim
from risorius.geometry.arrays import Floats64, Integers32
from risorius.geometry.normals import vertex_normals
from risorius.geometry.read_only import read_only


class DenseSkin:
    """The vertices of a skin that a simulation with fewer vertices carries.

    rest_positions: those at rest [mm], shape (V, 3), read only.
    """

    def __init__(self, vertices: Floats64, faces: Integers32, simulation: sim.Simulation) -> None:
        """Bind vertices (V, 3) of triangles (F, 3), at rest, to the mesh of `simulation`."""
        from risorius.refine import Embedding  # few heads need it

        self.rest_positions = vertices
        # Normals keep vertices of the upper lip with the upper lip.
        normals = _smooth_normals(vertices, faces)
        self._embedding = Embedding(
            simulation.faces, simulation.rest_positions, vertices, normals=normals
        )
        self._positions = vertices.copy()
        self._shown = read_only(self._positions)
        self._wanted: Floats64 | None = None  # simulated vertices that are not yet followed

    def follow(self, simulated: Floats64) -> None:
        """Follow simulated vertices, shape (K, 3), when `positions` is read next.

        A frame has several steps of the simulation, and positions are read only after the last.
        """
        self._wanted = simulated

    @property
    def positions(self) -> Floats64:
        """Present positions [mm], shape (V, 3), read only; always the same view."""
        if self._wanted is not None:
            moved = self._embedding.evaluate(self._wanted, with_normals=False).positions
            self._positions[:] = moved
            self._wanted = None
        return self._shown

    def carry(self, values: Floats64) -> Floats64:
        """Carry values of simulated vertices, shape (K,), to those of the skin, shape (V,)."""
        return self._embedding.carry(values)

    def clone(self) -> DenseSkin:
        """A copy of the skin, which moves independently."""
        twin = copy.copy(self)
        twin._embedding = copy.deepcopy(self._embedding)
        twin._positions = self._positions.copy()
        twin._shown = read_only(twin._positions)
        return twin


def _smooth_normals(vertices: Floats64, faces: Integers32) -> Floats64:
    """Sums of unit normals around vertices, shape (V, 3).

    A scan has folds of single triangles, where the normal of one vertex points into the face.
    """
    normals = vertex_normals(vertices, faces)
    corners = faces.ravel()
    rounds = 2  # each includes one more ring of neighbours
    for _ in range(rounds):
        sums = np.repeat(normals[faces].sum(axis=1), 3, axis=0)
        columns = [np.bincount(corners, each, len(vertices)) for each in sums.T]
        normals = np.stack(columns, axis=1)
    return normals
