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
    """The vertices of a skin as a simulation of fewer carries them.

    rest_positions: at rest [mm], shape (V, 3), read only for others.
    """

    def __init__(self, vertices: Floats64, faces: Integers32, simulation: sim.Simulation) -> None:
        """Bind vertices (V, 3) of triangles (F, 3), at rest, to the mesh of `simulation`."""
        from risorius.refine import Embedding  # which few heads need

        self.rest_positions = vertices
        # By its normal an upper lip's vertex stays with the upper lip.
        normals = _smooth_normals(vertices, faces)
        self._embedding = Embedding(
            simulation.faces, simulation.rest_positions, vertices, normals=normals
        )
        self._positions = vertices.copy()
        self._shown = read_only(self._positions)
        self._wanted: Floats64 | None = None  # where the simulated vertices are, if not followed

    def follow(self, simulated: Floats64) -> None:
        """Go where the simulated vertices are, shape (K, 3), as soon as somebody looks.

        A frame has several steps of the simulation, and only after the last of them one looks.
        """
        self._wanted = simulated

    @property
    def positions(self) -> Floats64:
        """Now [mm], shape (V, 3), read only for others; a view that stays the same."""
        if self._wanted is not None:
            moved = self._embedding.evaluate(self._wanted, with_normals=False).positions
            self._positions[:] = moved
            self._wanted = None
        return self._shown

    def carry(self, values: Floats64) -> Floats64:
        """Values of simulated vertices, shape (K,), at those of the skin, shape (V,)."""
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

    A scan has folds of single triangles, where a vertex looks into the face: its neighbours do not.
    """
    normals = vertex_normals(vertices, faces)
    corners = faces.ravel()
    rounds = 2  # each takes the neighbours of neighbours in
    for _ in range(rounds):
        sums = np.repeat(normals[faces].sum(axis=1), 3, axis=0)
        columns = [np.bincount(corners, each, len(vertices)) for each in sums.T]
        normals = np.stack(columns, axis=1)
    return normals
