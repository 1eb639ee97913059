"""The skin as a triangle mesh: edges, areas, smoothed normals, distances along it, smooth fields.

Everything here is computed once when a simulation is built; nothing runs per frame. Coordinates
are the standard space of coordinates.py in millimetres.

Source: Van Gelder 1998 for edge stiffness from triangle areas; Kähler et al. 2001 for one mass
per vertex and one spring per edge.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
import scipy
from scipy.sparse import csgraph

from ..geometry.arrays import Floats64, Integers32, Integers64
from ..geometry.mesh_graph import path_to
from ..geometry.normals import cross_products, vertex_areas, vertex_normals
from ..geometry.sides import side_lengths
from .skin_graph import SkinGraph, graph_of


@dataclass(frozen=True)
class SkinSurface:
    """A triangle mesh at rest, with the lengths and areas that the springs need."""

    positions: Floats64  # (V, 3) mm
    faces: Integers32  # (F, 3)
    graph: SkinGraph
    lengths: Floats64  # (E,) mm
    edge_stiffness: Floats64  # (E,) sum of adjacent triangle areas / length2, dimensionless
    areas: Floats64  # (V,) mm2
    normals: Floats64  # (V, 3) unit, smoothed

    @property
    def edges(self) -> Integers32:
        """The ends of each edge, shape (E, 2), sorted, the lower vertex first."""
        edges: Integers32 = self.graph.edges
        return edges

    @property
    def vertex_count(self) -> int:
        """Number of vertices."""
        return len(self.positions)

    @property
    def spacing(self) -> Floats64:
        """Mean length of the edges at each vertex [mm], shape (V,); 0 without edges."""
        ends = self.edges.ravel()
        total = np.bincount(ends, np.repeat(self.lengths, 2), self.vertex_count)
        spacing: Floats64 = total / np.maximum(np.bincount(ends, minlength=self.vertex_count), 1)
        return spacing

    @cached_property
    def tree(self) -> scipy.spatial.cKDTree:
        """Search tree for the vertices near a point."""
        return scipy.spatial.cKDTree(self.positions)

    def nearest(self, points: Floats64) -> Integers32:
        """Return the index of the vertex nearest to each point (n, 3)."""
        return np.asarray(self.tree.query(points)[1], dtype=np.int32)

    def distances_from(self, vertices: Integers64) -> Floats64:
        """Lengths of shortest paths along edges from some vertices [mm], (V,); inf without path."""
        graph = self.graph.matrix(self.lengths)
        distance = csgraph.dijkstra(graph, indices=vertices, min_only=True)
        return np.asarray(distance, dtype=np.float64)

    def path_through(self, vertices: npt.ArrayLike, hindrance: Floats64) -> Integers32:
        """Return the vertices of shortest paths along edges between consecutive given vertices.

        hindrance: for each vertex, shape (V,). An edge counts as its length times (1 + the mean
        hindrance of its ends).
        """
        stops = np.asarray(vertices, dtype=np.int64)
        i, j = self.edges.T
        graph = self.graph.matrix(self.lengths * (1.0 + (hindrance[i] + hindrance[j]) / 2.0))
        apart = np.linalg.norm(np.diff(self.positions[stops], axis=0), axis=1)
        # Reach of the search [mm]: a larger reach takes longer, and is seldom needed.
        near = 5.0 * float(apart.max(initial=0.0))
        for limit in (near, np.inf):
            costs, before = csgraph.dijkstra(
                graph, indices=stops, return_predecessors=True, limit=limit
            )
            if np.isfinite(costs[np.arange(len(stops) - 1), stops[1:]]).all():
                break
        way = [int(stops[0])]
        for end, steps in zip(stops[1:], before[:-1], strict=True):
            way += path_to(end, steps)[1:]
        return np.array(way, dtype=np.int32)

    def smoother(self, extent: float) -> Callable[[Floats64], Floats64]:
        """Return a function that removes details below sqrt(`extent`) [mm2] from fields (V,)."""
        return _diffusion_step(self.graph, self.edge_stiffness, self.areas, extent)

    def harmonic(
        self, vertices: npt.ArrayLike, values: npt.ArrayLike, *, hold: float = 1e4
    ) -> Floats64:
        """Return the smoothest field, shape (V,), with `values` at the seed `vertices`."""
        seeds = np.asarray(vertices, dtype=np.int64)
        weight = hold * np.bincount(seeds, minlength=self.vertex_count)
        held = hold * np.asarray(values, dtype=np.float64)
        right = np.asarray(np.bincount(seeds, held, self.vertex_count), np.float64)
        # This term makes components without a seed zero instead of undefined.
        seed_floor = 1e-6
        diagonal = weight + seed_floor * self.areas
        field: Floats64 = self.graph.solver(self.edge_stiffness, diagonal)(right)
        return field


def build_surface(positions: Floats64, faces: Integers32) -> SkinSurface:
    """Edges, areas, stiffness and smoothed normals of a triangle mesh [mm]."""
    count = len(positions)
    face_areas = np.linalg.norm(cross_products(positions, faces), axis=1) / 2.0
    least_area = 0.01  # mm2 per vertex: keeps isolated vertices and slivers from having no mass
    areas: Floats64 = np.maximum(vertex_areas(positions, faces), least_area)

    graph = graph_of(faces, count)
    lengths = side_lengths(positions, graph.edges)
    # In mm per edge: bounds the stiffness of collapsed edges (Van Gelder's is 1/l2).
    least_length = 0.05
    lengths = np.maximum(lengths, least_length)
    areas_beside = np.bincount(graph.edge_of_side, np.tile(face_areas, 3), minlength=len(lengths))
    stiffness = areas_beside / lengths**2

    normal_smoothing = 25.0  # mm2: tissue direction is the normal of the surface at some 5 mm scale
    smooth = _diffusion_step(graph, stiffness, areas, normal_smoothing)(
        vertex_normals(positions, faces)
    )
    length = np.linalg.norm(smooth, axis=1, keepdims=True)
    directions = np.where(length > 1e-9, smooth / np.maximum(length, 1e-9), [0.0, 0.0, 1.0])
    return SkinSurface(
        positions=positions,
        faces=faces,
        graph=graph,
        lengths=lengths,
        edge_stiffness=stiffness,
        areas=areas,
        normals=directions,
    )


def _diffusion_step(
    graph: SkinGraph, stiffness: Floats64, areas: Floats64, extent: float
) -> Callable[[Floats64], Floats64]:
    """One implicit diffusion step: details much smaller than sqrt(`extent`) [mm2] vanish."""
    solve = graph.solver(extent * stiffness, areas)
    return lambda field: solve(areas.reshape(-1, *[1] * (field.ndim - 1)) * field)
