"""The skin as a triangle mesh: edges, areas, smoothed normals, distances along it, smooth fields.

Everything here is computed once when a simulation is built; nothing runs per frame. Coordinates
are the standard space of coordinates.py in millimetres.

Source: Van Gelder 1998 for edge stiffness from triangle areas; Kähler et al. 2001 for one mass
per vertex and one spring per edge.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
import numpy.typing as npt
import scipy
from scipy import sparse
from scipy.sparse import csgraph
from scipy.sparse import linalg as sparse_linalg

from ..geometry.arrays import Floats64, Integers32, Integers64
from ..geometry.normals import cross_products, vertex_areas, vertex_normals
from ..geometry.read_only import read_only
from ..geometry.sides import different_pairs, sides_of


@dataclass(frozen=True)
class SkinSurface:
    """A triangle mesh at rest, with the lengths and areas that the springs need."""

    positions: Floats64  # (V, 3) mm
    faces: Integers32  # (F, 3)
    edges: Integers32  # (E, 2), sorted, the lower vertex first
    lengths: Floats64  # (E,) mm
    edge_stiffness: Floats64  # (E,) sum of adjacent triangle areas / length2, dimensionless
    areas: Floats64  # (V,) mm2
    normals: Floats64  # (V, 3) unit, smoothed
    laplacian: sparse.csc_array  # (V, V) of edge_stiffness

    @property
    def vertex_count(self) -> int:
        """Number of vertices."""
        return len(self.positions)

    @cached_property
    def tree(self) -> scipy.spatial.cKDTree:
        """Search tree that finds the vertices near a point."""
        return scipy.spatial.cKDTree(self.positions)

    def nearest(self, points: Floats64) -> Integers32:
        """Number of the vertex nearest to each point (n, 3)."""
        return np.asarray(self.tree.query(points)[1], dtype=np.int32)

    def distances_from(self, vertices: Integers64) -> Floats64:
        """Shortest way along edges [mm] from some vertices, shape (V,); inf on other components."""
        i, j = self.edges.T
        graph = sparse.csr_array((self.lengths, (i, j)), shape=(self.vertex_count,) * 2)
        distance = csgraph.dijkstra(graph, directed=False, indices=vertices, min_only=True)
        return np.asarray(distance, dtype=np.float64)

    def way_through(self, vertices: npt.ArrayLike, hindrance: Floats64) -> Integers32:
        """Numbers of the vertices on the shortest way along edges from each vertex to the next.

        hindrance: a number for each vertex, shape (V,). An edge costs its length times 1 + the mean
        hindrance of its ends.
        """
        stops = np.asarray(vertices, dtype=np.int64)
        i, j = self.edges.T
        lengths = self.lengths * (1.0 + (hindrance[i] + hindrance[j]) / 2.0)
        shape = (self.vertex_count, self.vertex_count)
        graph = sparse.csr_array((lengths, (i, j)), shape=shape)
        _, before = csgraph.dijkstra(graph, directed=False, indices=stops, return_predecessors=True)
        way = [int(stops[0])]
        for start, end, steps in zip(stops[:-1], stops[1:], before[:-1], strict=True):
            back = [int(end)]
            while back[-1] != start and steps[back[-1]] >= 0:
                back.append(int(steps[back[-1]]))
            forward = back[::-1]
            way += forward[1:]
        return np.array(way, dtype=np.int32)

    def smoothed(self, field: Floats64, extent: float) -> Floats64:
        """A field (V,) without details smaller than about sqrt(`extent`); `extent` is in mm2."""
        return _smooth(field, extent, self.areas, self.laplacian)

    def harmonic(
        self, vertices: npt.ArrayLike, values: npt.ArrayLike, *, hold: float = 1e4
    ) -> Floats64:
        """Smoothest field, shape (V,), that takes `values` at the seed `vertices`."""
        weight = np.zeros(self.vertex_count)
        right = np.zeros(self.vertex_count)
        seeds = np.asarray(vertices, dtype=np.int64)
        np.add.at(weight, seeds, hold)
        np.add.at(right, seeds, hold * np.asarray(values, dtype=np.float64))
        # Pulls components without a seed to zero instead of leaving them undefined.
        seed_floor = 1e-6
        system = (self.laplacian + sparse.diags_array(weight + seed_floor * self.areas)).tocsc()
        field: Floats64 = sparse_linalg.spsolve(system, right)
        return field


def build_surface(positions: Floats64, faces: Integers32) -> SkinSurface:
    """Edges, areas, stiffness and smoothed normals of a triangle mesh [mm]."""
    count = len(positions)
    face_areas = np.linalg.norm(cross_products(positions, faces), axis=1) / 2.0
    least_area = 0.01  # mm2 per vertex: keeps isolated vertices and slivers from having no mass
    areas: Floats64 = np.maximum(vertex_areas(positions, faces), least_area)

    edges, edge_of_side = _edges_of(faces.tobytes())
    i, j = edges.T
    lengths = np.linalg.norm(positions[j] - positions[i], axis=1)
    # In mm per edge: bounds the stiffness of collapsed edges (Van Gelder's is 1/l2).
    least_length = 0.05
    lengths = np.maximum(lengths, least_length)
    areas_beside = np.bincount(edge_of_side, np.tile(face_areas, 3), minlength=len(edges))
    stiffness = areas_beside / lengths**2

    both = (np.concatenate([i, j]), np.concatenate([j, i]))
    weights = sparse.coo_array((np.tile(stiffness, 2), both), shape=(count, count)).tocsr()
    degree = np.asarray(weights.sum(axis=1)).ravel()
    laplacian = (sparse.diags_array(degree) - weights).tocsc()
    normal_smoothing = 25.0  # mm2: tissue direction is the normal of the surface at some 5 mm scale
    smooth = _smooth(vertex_normals(positions, faces), normal_smoothing, areas, laplacian)
    length = np.linalg.norm(smooth, axis=1, keepdims=True)
    directions = np.where(length > 1e-9, smooth / np.maximum(length, 1e-9), [0.0, 0.0, 1.0])
    return SkinSurface(positions, faces, edges, lengths, stiffness, areas, directions, laplacian)


@lru_cache(maxsize=4)
def _edges_of(faces: bytes) -> tuple[Integers32, Integers64]:
    """Edges (E, 2), sorted, and the edge of each side of `sides_of`; persons share their faces."""
    sides = np.sort(sides_of(np.frombuffer(faces, np.int32).reshape(-1, 3)), axis=1)
    pairs, edge_of_side = different_pairs(sides)
    edges: Integers32 = pairs.astype(np.int32)
    return read_only(edges), read_only(edge_of_side)


def _smooth(
    field: Floats64, extent: float, areas: Floats64, laplacian: sparse.csc_array
) -> Floats64:
    """One implicit diffusion step: details much smaller than sqrt(`extent`) [mm2] vanish."""
    system = (sparse.diags_array(areas) + extent * laplacian).tocsc()
    right = areas.reshape(-1, *[1] * (field.ndim - 1)) * field
    result: Floats64 = sparse_linalg.splu(system).solve(right)
    return result
