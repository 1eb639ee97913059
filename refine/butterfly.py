r"""Modified butterfly subdivision: the scheme named `butterfly`.

Zorin, Schröder, Sweldens 1996, "Interpolating subdivision for meshes with arbitrary topology". The
middle of an edge is worked out from the ring around each of its ends; b is number 0 of the ring of
a, and j runs around it:

    valence 6     1/2 a + 1/2 r0 + 1/8 (r1 + r5) - 1/8 (r2 + r4)     both ends: the butterfly
    valence 5, 7..  3/4 a + sum of (1/4 + cos(2 pi j/n) + 1/2 cos(4 pi j/n)) / n  rj
    valence 4     3/4 a + 3/8 r0 - 1/8 r2
    valence 3     3/4 a + 5/12 r0 - 1/12 (r1 + r2)
    border edge   9/16 (a + b) - 1/16 (the next ones along the border)

An end of valence 6 steps back where the other one has another valence; two of a kind are averaged.
An end on a border, or where surfaces meet, has no ring and steps back always; without any ring the
middle is that of the straight edge.

Quarter points are those of the next level: the same rules for the half-edges, with the middles of
the edges around in place of the ring, split or not, as if the whole mesh had been subdivided.

Differs from the authors' rules: theirs for inner edges at a border need the ring of the border.
Here the quarter points of a border edge lie on the parabola through a, m and b.
"""

import numpy as np
import numpy.typing as npt

from .connectivity import Connectivity
from .cubic import follow_borders
from .curves import CurveScheme
from .kernels import kernel
from .schemes import Frame

Floats = npt.NDArray[np.float32]
Doubles = npt.NDArray[np.float64]
Unsigned = npt.NDArray[np.uint32]
Flags = npt.NDArray[np.bool_]

MOST_RING = 64
"""Valence up to which rings have weights; larger ones step back like borders."""
REGULAR = 6
MIDDLE, NEAR_START, NEAR_END = 1, 0, 2
"""Points of an edge in an array of bulges (curves.py)."""


def ring_weights() -> Floats:
    """Weights by valence n and place in the ring, shape (65, 65); the last column is the own one.

    Rows without weights (valence 0 to 2) are zero.
    """
    weights = np.zeros((MOST_RING + 1, MOST_RING + 1))
    for n in range(3, MOST_RING + 1):
        turn = 2.0 * np.pi * np.arange(n) / n
        weights[n, :n] = (0.25 + np.cos(turn) + 0.5 * np.cos(2.0 * turn)) / n
    weights[3, :3] = 5 / 12, -1 / 12, -1 / 12
    weights[4, :4] = 3 / 8, 0.0, -1 / 8, 0.0
    weights[REGULAR, :6] = 1 / 2, 1 / 8, -1 / 8, 0.0, -1 / 8, 1 / 8
    weights[3:, MOST_RING] = 1.0 - weights[3:, :MOST_RING].sum(axis=1)
    return weights.astype(np.float32)


class ButterflyScheme(CurveScheme):
    """Points of split edges are those of modified butterfly subdivision."""

    def bind(
        self, connectivity: Connectivity, rest_positions: Doubles, rest_normals: Floats
    ) -> None:
        """Find the vertices that have a ring of inner edges, and follow the borders."""
        super().bind(connectivity, rest_positions, rest_normals)
        edge_count = len(connectivity.edges)
        self._weights = ring_weights()
        self._valence = np.zeros(connectivity.vertex_count, dtype=np.uint8)
        find_rings(
            connectivity.edges,
            connectivity.edge_points,
            connectivity.edge_wings,
            connectivity.is_interior,
            self._valence,
        )
        self._beyond = np.zeros((edge_count, 2), dtype=np.uint32)
        counts = np.zeros((2, connectivity.vertex_count), dtype=np.int64)
        follow_borders(
            connectivity.edges, connectivity.is_interior, counts[0], counts[1], self._beyond
        )
        self._middles = np.zeros((edge_count, 3), dtype=np.float64)
        self._is_known = np.zeros(edge_count, dtype=np.bool_)

    def _bulge(self, frame: Frame, bulges: Floats) -> None:
        mesh = self._connectivity
        self._is_known[:] = False
        find_middles(
            frame.positions,
            mesh.edge_points,
            mesh.edge_wings,
            mesh.is_interior,
            self._beyond,
            self._valence,
            self._weights,
            frame.splits,
            frame.split_once,
            frame.once_count,
            self._is_known,
            self._middles,
        )
        bulge_butterfly(
            frame.positions,
            mesh.edge_points,
            mesh.edge_wings,
            mesh.is_interior,
            self._valence,
            self._weights,
            frame.splits,
            frame.split_once,
            frame.once_count,
            self._middles,
            bulges,
        )


@kernel
def walk_ring(
    start: int,
    vertex: int,
    edge_points: Unsigned,
    edge_wings: Unsigned,
    ring: Unsigned,
) -> int:
    """Write the edges around `vertex` into `ring`, `start` first; return how many.

    All must be inner edges. -1 if it takes more than there is room for.
    """
    edge, previous, count = start, -1, 0
    while count < MOST_RING:
        ring[count] = edge
        count += 1
        at_start = edge_points[edge, 0] == vertex
        one = edge_wings[edge, 0 if at_start else 1]
        other = edge_wings[edge, 2 if at_start else 3]
        following = other if one == previous else one
        previous, edge = edge, following
        if edge == start:
            return count
    return -1


@kernel
def find_rings(
    edges: npt.NDArray[np.int32],
    edge_points: Unsigned,
    edge_wings: Unsigned,
    is_interior: Flags,
    valence: npt.NDArray[np.uint8],
) -> None:
    """Write the valence of every vertex whose edges are one ring of inner edges, 0 for others."""
    degree = np.zeros(valence.shape[0], np.int32)
    some_edge = np.full(valence.shape[0], -1, np.int64)
    for e in range(edges.shape[0]):
        for i in range(2):
            v = edges[e, i]
            if not is_interior[e]:
                degree[v] = -edges.shape[0] - 1  # on a border: never a ring, whatever is added
            degree[v] += 1
            some_edge[v] = e
    ring = np.empty(MOST_RING + 1, np.uint32)
    for v in range(valence.shape[0]):
        valence[v] = 0
        if 3 <= degree[v] <= MOST_RING:
            count = walk_ring(some_edge[v], v, edge_points, edge_wings, ring)
            if count == degree[v]:  # otherwise two fans meet here
                valence[v] = count


@kernel
def place_middle(
    e: int,
    positions: Doubles,
    edge_points: Unsigned,
    edge_wings: Unsigned,
    is_interior: Flags,
    beyond: Unsigned,
    valence: npt.NDArray[np.uint8],
    weights: Floats,
    ring: Unsigned,
    middles: Doubles,
) -> None:
    """Write the point of edge `e` on the next level into `middles`."""
    a, b = edge_points[e, 0], edge_points[e, 1]
    for i in range(3):
        middles[e, i] = 0.5 * (positions[a, i] + positions[b, i])
    if not is_interior[e]:
        p, q = beyond[e, 0], beyond[e, 1]
        if p != a and q != b:
            for i in range(3):
                ends, others = positions[a, i] + positions[b, i], positions[p, i] + positions[q, i]
                middles[e, i] = 0.5625 * ends - 0.0625 * others
        return
    from_a, from_b = valence[a] > 0, valence[b] > 0
    if from_a and from_b and (valence[a] == REGULAR) != (valence[b] == REGULAR):
        from_a, from_b = valence[a] != REGULAR, valence[b] != REGULAR
    if not (from_a or from_b):
        return
    share = 0.5 if from_a and from_b else 1.0
    for i in range(3):
        middles[e, i] = 0.0
    for end in range(2):
        if not (from_a if end == 0 else from_b):
            continue
        v = edge_points[e, end]
        count = walk_ring(e, v, edge_points, edge_wings, ring)
        for i in range(3):
            middles[e, i] += share * weights[count, MOST_RING] * positions[v, i]
        for j in range(count):
            f = ring[j]
            other = edge_points[f, 1] if edge_points[f, 0] == v else edge_points[f, 0]
            for i in range(3):
                middles[e, i] += share * weights[count, j] * positions[other, i]


@kernel
def quarter_point(
    near: int,
    middle: Doubles,
    beside: Doubles,
    count: int,
    around: Unsigned,
    positions: Doubles,
    weights: Floats,
    middles: Doubles,
    point: Doubles,
) -> None:
    """Write the point between `near` and the middle of an inner edge.

    `beside`: the middles p, r, q, s of the neighbour edges, those at `near` first, shape (4, 3);
    `around`: the edges around `near`, `count` of them, none where it has no ring.
    """
    for i in range(3):
        # The middle is a vertex of valence 6 on its level: near, p, q, far, s, r around it.
        from_middle = (
            0.5 * (middle[i] + positions[near, i])
            + 0.125 * (beside[0, i] + beside[1, i])
            - 0.125 * (beside[2, i] + beside[3, i])
        )
        from_near = weights[count, MOST_RING] * positions[near, i]
        for j in range(count):
            from_near += weights[count, j] * middles[around[j], i]
        if count == 0:
            point[i] = from_middle
        elif count == REGULAR:
            point[i] = 0.5 * (from_near + from_middle)
        else:
            point[i] = from_near


@kernel
def find_middles(
    positions: Doubles,
    edge_points: Unsigned,
    edge_wings: Unsigned,
    is_interior: Flags,
    beyond: Unsigned,
    valence: npt.NDArray[np.uint8],
    weights: Floats,
    splits: npt.NDArray[np.uint8],
    split_once: Unsigned,
    once_count: int,
    is_known: Flags,
    middles: Doubles,
) -> None:
    """Write the middles of the split edges, and of all edges that quarter points ask for."""
    ring = np.empty(MOST_RING + 1, np.uint32)
    asked = np.empty(2 * MOST_RING + 8, np.uint32)
    for k in range(once_count):
        asked[0], count = split_once[k], 1
        if splits[asked[0]] == 2 and is_interior[asked[0]]:
            for j in range(4):
                asked[1 + j] = edge_wings[asked[0], j]
            count = 5
            for end in range(2):
                v = edge_points[asked[0], end]
                if valence[v] > 0:
                    walk_ring(asked[0], v, edge_points, edge_wings, ring)
                for j in range(valence[v]):
                    asked[count] = ring[j]
                    count += 1
        for j in range(count):
            e = asked[j]
            if not is_known[e]:
                is_known[e] = True
                place_middle(
                    e, positions, edge_points, edge_wings, is_interior, beyond, valence, weights,
                    ring, middles,
                )  # fmt: skip


@kernel
def bulge_butterfly(
    positions: Doubles,
    edge_points: Unsigned,
    edge_wings: Unsigned,
    is_interior: Flags,
    valence: npt.NDArray[np.uint8],
    weights: Floats,
    splits: npt.NDArray[np.uint8],
    split_once: Unsigned,
    once_count: int,
    middles: Doubles,
    bulges: Floats,
) -> None:
    """Write the bulges of the split edges, whose middles are there already."""
    around = np.empty(MOST_RING + 1, np.uint32)
    point, beside = np.empty(3), np.empty((4, 3))
    for k in range(once_count):
        e = split_once[k]
        for i in range(3):
            straight = 0.5 * (positions[edge_points[e, 0], i] + positions[edge_points[e, 1], i])
            bulges[e, MIDDLE, i] = middles[e, i] - straight
        if splits[e] < 2:
            continue
        for end in range(2):
            near, far = edge_points[e, end], edge_points[e, 1 - end]
            if is_interior[e]:
                if valence[near] > 0:
                    walk_ring(e, near, edge_points, edge_wings, around)
                for i in range(3):
                    beside[0, i] = middles[edge_wings[e, end], i]
                    beside[1, i] = middles[edge_wings[e, 2 + end], i]
                    beside[2, i] = middles[edge_wings[e, 1 - end], i]
                    beside[3, i] = middles[edge_wings[e, 3 - end], i]
                quarter_point(
                    near, middles[e], beside, valence[near], around, positions, weights, middles,
                    point,
                )  # fmt: skip
            else:
                for i in range(3):  # the parabola through near, middle and far
                    ends = 0.375 * positions[near, i] - 0.125 * positions[far, i]
                    point[i] = ends + 0.75 * middles[e, i]
            for i in range(3):
                straight = 0.75 * positions[near, i] + 0.25 * positions[far, i]
                bulges[e, NEAR_START if end == 0 else NEAR_END, i] = point[i] - straight
