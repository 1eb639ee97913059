r"""A criterion of our own for Fig. 10: how much the mesh's borders turn since rest.

It only uses the public names of `refine`, like a criterion of any other package.

A shut mouth is a slit with two straight sides. If it opens within its surface, nothing bends and no
normal turns, so other criteria measure no change; but the straight sides become arcs. Kähler,
Haber, Seidel 2003, section 5, on Fig. 10: "improving the silhouette of the opened mouth".

           v          The turn at a vertex a of a border p, a, q, with u and v the
       a------>q      directions of its edges and n the normal at a, is three numbers:
      ^
    u |                   along  u . v        aside  n . (u x v)        up  n . (v - u)
      p
                      The distance between these numbers and their values at rest approximates the
                      angle [rad] by which the turn has changed, in the surface (aside) and out of
                      it (up). The numbers are smooth wherever edges have a length, even where the
                      border folds back.

    measure of a border edge = mean of the turns at its ends: the angle between the tangents there

The border itself is rarely visible: it may lie inside the lips, and a viewer sees a line beside it.
So a vertex near the border takes over the mean turn of its neighbours nearer to the border, reduced
with every ring, up to REACH_RINGS. The measure of an edge there is multiplied by the squared cosine
between the edge and the border. Across the border there is no turn, and long, thin triangles along
the lips are desired (section 5, Fig. 8).

At a corner of the mesh the border has no turn, because a corner stays a corner.
"""

from typing import Annotated, NamedTuple

import numpy as np

from risorius import refine
from risorius.geometry.arrays import Floats32, Floats64, Integers32, Integers64
from risorius.refine import port

Once = Annotated[float, refine.Option("an edge splits once where borders turn more", least=0.0)]
Twice = Annotated[float, refine.Option("the same for splitting twice", least=0.0)]
REACH_RINGS = 5
"""The first ring of edges around the border in which a turn no longer counts. Chosen by the
outlines of five open mouths of the built-in head, whose border lies three rings inside the lips:
two more rings took 12 % more triangles for 3 % of the error.
"""


class Nearby(NamedTuple):
    """The vertices and edges on and beside the borders of a mesh."""

    curves: Integers64
    """The vertices p, a, q of every turn, shape (T, 3)."""
    steps: list[Integers32]
    """For each ring except the first, the vertices to and from which turns spread, (2, S)."""
    step_weights: list[Floats64]
    """Weight of a turn that spreads along each pair, shape (S,)."""
    edges: Integers64
    """The edges on and beside the border, shape (N,)."""
    edge_factors: Floats64
    """Factor on the sum of the turns at an edge's ends, for its measure, shape (N,)."""


class BorderTurn(refine.Criterion):
    """Splits edges at borders whose turns change since rest, such as those of an opening mouth."""

    def __init__(self, once: Once = 0.03, twice: Twice = 0.12) -> None:
        """`once`, `twice`: thresholds for the angle between tangents at an edge's ends [rad]."""
        self.thresholds = refine.Thresholds(once, twice, "angles in radians")

    def bind(
        self, connectivity: refine.Connectivity, rest_positions: Floats64, rest_normals: Floats32
    ) -> None:
        """Find vertices and edges on and beside borders, and the turns of borders at rest."""
        self._mesh = connectivity
        self._nearby = find_nearby(connectivity, rest_positions)
        self._rest_turns = turns_of(rest_positions, rest_normals, self._nearby.curves)

    def measure(self, positions: Floats64, normals: Floats32, metric: Floats32) -> None:
        """Write the refinement metric of every edge, shape (E,)."""
        nearby = self._nearby
        change = turns_of(positions, normals, nearby.curves) - self._rest_turns
        turns = np.zeros(self._mesh.vertex_count)
        turns[nearby.curves[:, 1]] = np.linalg.norm(change, axis=1)
        for (end, start), weights in zip(nearby.steps, nearby.step_weights, strict=True):
            np.add.at(turns, end, weights * turns[start])
        metric[:] = 0.0
        ends = self._mesh.edges[nearby.edges]
        metric[nearby.edges] = nearby.edge_factors * turns[ends].sum(axis=1)
        self.thresholds.scale(metric)


def turns_of(positions: Floats64, normals: Floats32, curves: Integers64) -> Floats64:
    """The numbers along, aside and up of each turn of `curves` (p, a, q), shape (T, 3)."""
    p, a, q = curves.T
    u = _units(positions[a] - positions[p])
    v = _units(positions[q] - positions[a])
    n = normals[a].astype(np.float64)
    along = (u * v).sum(axis=1)
    aside = (n * np.cross(u, v)).sum(axis=1)
    up = (n * (v - u)).sum(axis=1)
    return np.stack([along, aside, up], axis=1)


def _units(vectors: Floats64) -> Floats64:
    """Unit vectors, shape (.., 3); zero vectors stay zero."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / np.where(lengths > 0.0, lengths, 1.0)


def find_nearby(mesh: refine.Connectivity, rest_positions: Floats64) -> Nearby:
    """Find the vertices and edges on and beside the borders.

    A vertex surrounded by slivers has no normal at rest, and therefore no turn.
    """
    before, after = port.border_neighbours(mesh, rest_positions).T
    undefined = np.empty(mesh.vertex_count, dtype=np.bool_)
    port.find_undefined_normals(mesh.faces, rest_positions, undefined)
    vertices = np.flatnonzero((before != after) & ~undefined)
    curves = np.column_stack([before[vertices], vertices, after[vertices]])
    directions = _units(np.diff(rest_positions[mesh.edges], axis=1)[:, 0])
    ring = rings_from_border(mesh)
    steps, weights = edges_inward(mesh, ring)

    # The direction of the border beside a vertex has no sign, so it is stored as a square, d d^T.
    squares = np.zeros((mesh.vertex_count, 3, 3))
    is_border = ~mesh.around.is_interior
    along = directions[is_border]
    halves = 0.5 * along[:, :, None] * along[:, None, :]
    for end in mesh.edges[is_border].T:
        np.add.at(squares, end, halves)
    for (end, start), means in zip(steps, weights, strict=True):
        parts = means[:, None, None] * squares[start]
        np.add.at(squares, end, parts)

    is_near = (ring[mesh.edges] < REACH_RINGS).any(axis=1)
    near = squares[mesh.edges[is_near]].mean(axis=1)
    across = directions[is_near]
    cosines = np.einsum("ei,eij,ej->e", across, near, across)
    faded = []
    for rings_left, means in zip(range(REACH_RINGS, 0, -1), weights, strict=False):
        faded.append(means * (rings_left - 1) / rings_left)
    edge_factors = 0.5 * np.where(is_border[is_near], 1.0, cosines)
    return Nearby(curves.astype(np.int64), steps, faded, np.flatnonzero(is_near), edge_factors)


def rings_from_border(mesh: refine.Connectivity) -> Integers64:
    """Distance of each vertex from the border in edges, at most REACH_RINGS, shape (V,)."""
    ring = np.full(mesh.vertex_count, REACH_RINGS)
    ring[mesh.edges[~mesh.around.is_interior]] = 0
    for k in range(1, REACH_RINGS):
        is_beside = (ring[mesh.edges] == k - 1).any(axis=1)
        beside = mesh.edges[is_beside]
        ring[beside] = np.minimum(ring[beside], k)
    return ring


def edges_inward(
    mesh: refine.Connectivity, ring: Integers64
) -> tuple[list[Integers32], list[Floats64]]:
    """For each ring except the first, the edges that lead to its vertices from the previous ring.

    Returns for each ring the ends and starts of these edges, shape (2, S), and the weight of each
    edge in the mean over all edges with the same end, shape (S,).
    """
    steps = []
    weights = []
    directed_edges = np.concatenate([mesh.edges, mesh.edges[:, ::-1]])
    start_ring, end_ring = ring[directed_edges].T
    for k in range(1, REACH_RINGS):
        start, end = directed_edges[(start_ring == k - 1) & (end_ring == k)].T
        steps.append(np.stack([end, start]))
        weights.append(1.0 / np.bincount(end, minlength=mesh.vertex_count)[end])
    return steps, weights
