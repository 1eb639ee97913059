r"""The criterion `border`: how far the border of the mesh turns otherwise than at rest.

A mouth that is shut is a slit with two straight sides. It may open in the surface that it lies in:
nothing bends, no normal turns, no other criterion sees it; but a straight line becomes an arc.
Kähler, Haber, Seidel 2003, section 5, on Fig. 10: "improving the silhouette of the opened mouth".

           v          The turn at a vertex a of a border p, a, q (mesh/borders.py), with u and v the
       a------>q      directions of its edges and n the normal at a, is three numbers:
      ^
    u |                   along  u . v        aside  n . (u x v)        up  n . (v - u)
      p
                      Their distance from those at rest is near the angle [rad] by which the border
                      turns otherwise, in the surface (aside) and out of it (up). They are smooth
                      wherever edges have a length, even where the border folds back.

    measure of a border edge = mean of the turns at its ends: the angle between the tangents there

The border itself is seldom seen: it may lie inside the lips, and the eye sees a line that runs
beside it. So vertices around take over the mean turn of their neighbours that are nearer to the
border, less with every ring, until REACH_RINGS. And an edge there counts as far as it runs along
the border, by the squared cosine between both: across it nothing turns, and long, thin triangles
along the lips are wanted (section 5, Fig. 8).

A corner stays one, so the border has no turn there.
"""

from typing import NamedTuple

import numpy as np

from ...geometry.arrays import Floats32, Floats64, Integers32, Integers64, Unsigned32
from ...jit import njit
from ..kahler.criterion import find_undefined_normals
from ..mesh.borders import border_neighbours
from ..mesh.connectivity import Connectivity
from ..mesh.vectors import (
    ONE,
    TINY,
    ZERO,
    Vector,
    between,
    cross,
    dot,
    less,
    row_of,
    unit,
    write_row,
)
from .measuring import Measuring

REACH_RINGS = 5
"""Rings of edges around the border, the first in which a turn no longer counts. Chosen by the
outlines of five opened mouths of the built-in head, whose border lies three rings inside the lips:
two more took 12 % more triangles for 3 % of the error."""


class Nearby(NamedTuple):
    """The vertices and edges on and beside the borders of a mesh; compiled code takes it."""

    curves: Unsigned32
    """The vertices p, a, q of every turn, shape (T, 3)."""
    rest_turns: Floats32
    """Along, aside and up at rest, shape (T, 3)."""
    spread: Unsigned32
    """Vertices that turns spread to and from, those nearer to the border first, shape (S, 2)."""
    spread_shares: Floats32
    """How much of a turn spreads, shape (S,)."""
    edges: Unsigned32
    """The edges on and beside the border, shape (N,)."""
    edge_shares: Floats32
    """How much of the sum of the turns at its ends is the measure of an edge, shape (N,)."""


class BorderTurn(Measuring):
    """Borders that turn otherwise than at rest, such as that of a mouth that opens."""

    def __init__(self, once: float = 0.03, twice: float = 0.12) -> None:
        """`once`, `twice`: angles between the tangents at both ends of an edge [rad]."""
        super().__init__(once, twice, "angles in radians")

    def bind(
        self, connectivity: Connectivity, rest_positions: Floats64, rest_normals: Floats32
    ) -> None:
        """Find what lies on borders and beside them, and how borders turn at rest."""
        super().bind(connectivity, rest_positions, rest_normals)
        self._turns = np.zeros(connectivity.vertex_count, dtype=np.float32)
        self._nearby = find_nearby(connectivity, rest_positions)
        write_turns(rest_positions, rest_normals, self._nearby.curves, self._nearby.rest_turns)

    def measure(self, positions: Floats64, normals: Floats32, metric: Floats32) -> None:
        """Write the refinement metric of every edge, shape (E,)."""
        measure_turns(positions, normals, self._edges, self._nearby, self._turns, metric)
        self.thresholds.scale(metric)


def find_nearby(mesh: Connectivity, rest_positions: Floats64) -> Nearby:
    """Find the vertices and edges on and beside the borders; turns at rest are still to be written.

    A vertex that has no normal at rest, because all triangles around are slivers, has no turn.
    """
    neighbours = border_neighbours(mesh, rest_positions)
    undefined = np.empty(mesh.vertex_count, dtype=np.bool_)
    find_undefined_normals(mesh.faces, rest_positions, undefined)
    vertices = np.flatnonzero((neighbours[:, 0] != neighbours[:, 1]) & ~undefined)
    curves = np.column_stack([neighbours[vertices, 0], vertices, neighbours[vertices, 1]])
    directions = np.diff(rest_positions[mesh.edges], axis=1)[:, 0]
    directions /= np.maximum(np.linalg.norm(directions, axis=1, keepdims=True), TINY)
    ring = rings_from_border(mesh)
    spread, spread_shares = ways_inward(mesh, ring)

    # The direction of the border beside a vertex has no sign, so it is kept as a square, d d^T.
    squares = np.zeros((mesh.vertex_count, 3, 3))
    is_border = ~mesh.around.is_interior
    along = directions[is_border]
    for end in mesh.edges[is_border].T:
        np.add.at(squares, end, 0.5 * along[:, :, None] * along[:, None, :])
    for (end, start), means in zip(spread, spread_shares, strict=True):
        np.add.at(squares, end, means[:, None, None] * squares[start])

    is_near = (ring[mesh.edges] < REACH_RINGS).any(axis=1)
    near = squares[mesh.edges[is_near]].mean(axis=1)
    cosines = np.einsum("ei,eij,ej->e", directions[is_near], near, directions[is_near])
    faded = [
        means * (REACH_RINGS - k) / (REACH_RINGS - k + 1)
        for k, means in enumerate(spread_shares, 1)
    ]
    return Nearby(
        curves=curves.astype(np.uint32),
        rest_turns=np.zeros((len(curves), 3), dtype=np.float32),
        spread=np.concatenate(spread, axis=1).T.astype(np.uint32),
        spread_shares=np.concatenate(faded).astype(np.float32),
        edges=np.flatnonzero(is_near).astype(np.uint32),
        edge_shares=(0.5 * np.where(is_border[is_near], 1.0, cosines)).astype(np.float32),
    )


def rings_from_border(mesh: Connectivity) -> Integers64:
    """How many edges each vertex is away from the border, REACH_RINGS at most, shape (V,)."""
    ring = np.full(mesh.vertex_count, REACH_RINGS)
    ring[mesh.edges[~mesh.around.is_interior]] = 0
    for k in range(1, REACH_RINGS):
        is_beside = (ring[mesh.edges] == k - 1).any(axis=1)
        beside = mesh.edges[is_beside]
        ring[beside] = np.minimum(ring[beside], k)
    return ring


def ways_inward(mesh: Connectivity, ring: Integers64) -> tuple[list[Integers32], list[Floats64]]:
    """For each ring but the first, the ways along edges to its vertices from the ring before.

    Returns their ends and starts, shape (2, S), and the share of each in the mean of all ways that
    end there, shape (S,).
    """
    ways = []
    shares = []
    both_ways = np.concatenate([mesh.edges, mesh.edges[:, ::-1]])
    start_ring, end_ring = ring[both_ways].T
    for k in range(1, REACH_RINGS):
        start, end = both_ways[(start_ring == k - 1) & (end_ring == k)].T
        ways.append(np.stack([end, start]))
        shares.append(1.0 / np.bincount(end, minlength=mesh.vertex_count)[end])
    return ways, shares


@njit
def turn_at(
    positions: Floats64, normal: Vector, p: np.uint32, a: np.uint32, q: np.uint32
) -> Vector:
    """Along, aside and up of the turn of a border p, a, q."""
    u = unit(between(positions, p, a))
    v = unit(between(positions, a, q))
    return dot(u, v), dot(normal, cross(u, v)), dot(normal, less(v, ONE, u))


@njit
def write_turns(
    positions: Floats64, normals: Floats32, curves: Unsigned32, turns: Floats32
) -> None:
    """Write along, aside and up of every turn, shape (T, 3)."""
    for k in range(curves.shape[0]):
        p = curves[k, 0]
        a = curves[k, 1]
        q = curves[k, 2]
        write_row(turns, k, turn_at(positions, row_of(normals, a), p, a, q))


@njit
def measure_turns(
    positions: Floats64,
    normals: Floats32,
    edges: Unsigned32,
    nearby: Nearby,
    turns: Floats32,
    measures: Floats32,
) -> None:
    """Write the turn of every vertex since rest, shape (V,), and the measure of every edge, (E,).

    `edges`: end points, shape (E, 2).
    """
    turns[:] = ZERO
    for k in range(nearby.curves.shape[0]):
        p = nearby.curves[k, 0]
        a = nearby.curves[k, 1]
        q = nearby.curves[k, 2]
        now = turn_at(positions, row_of(normals, a), p, a, q)
        change = less(now, ONE, row_of(nearby.rest_turns, k))
        turns[a] = np.sqrt(dot(change, change))
    for k in range(nearby.spread.shape[0]):
        turns[nearby.spread[k, 0]] += nearby.spread_shares[k] * turns[nearby.spread[k, 1]]
    measures[:] = ZERO
    for k in range(nearby.edges.shape[0]):
        e = nearby.edges[k]
        both_ends = turns[edges[e, 0]] + turns[edges[e, 1]]
        measures[e] = nearby.edge_shares[k] * both_ends
