"""Find smooth paths along edges of a mesh, beside a line: where lips are cut and eyes are opened.

The shortest path beside a line jumps from side to side of it, and an opened mouth then has teeth
like a saw. So a path pays for turns, too. Turns belong to pairs of edges, so the graph of the
search has a node for each direction of each edge.

Source: Caldwell 1961, "On finding minimum routes in a network with turn penalties" (edges as the
nodes of the graph).
"""

from __future__ import annotations

import numpy as np
import scipy
from scipy.sparse import csgraph

from ...geometry.arrays import Floats64, Integers, Integers32
from ...geometry.directions import unit_vectors
from ...geometry.mesh_graph import path_to
from ...geometry.sides import edges_of, side_lengths


def smooth_path(vertices: Floats64, faces: Integers32, line: Floats64) -> Integers | None:
    """Find a path of edges along a line (n, 3): vertex indices; None if no path joins its ends.

    vertices: in the unit of the line, (V, 3). faces: triangles that the path may use, (F, 3).
    """
    used = np.unique(faces)
    _, nearest = scipy.spatial.cKDTree(vertices[used]).query(line[[0, -1]])
    start, end = used[nearest]
    edges = edges_of(faces)
    off = distances_from(vertices[edges].mean(axis=1), line)
    line_length = float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum())
    reach = 0.15  # greatest distance of an edge from the line, relative to the line's length
    is_near = off < reach * line_length
    edges = edges[is_near]
    if not len(edges):
        return None
    lengths = np.maximum(side_lengths(vertices, edges), 1e-12 * line_length)
    usual = float(np.median(lengths))
    # An edge that lies off the line by a usual length counts as twice as long.
    costs = np.tile(lengths * (1.0 + (off[is_near] / usual) ** 2), 2)
    steps = np.concatenate([edges, edges[:, ::-1]])
    first, then = _pairs(steps)
    directions = unit_vectors(vertices[steps[:, 1]] - vertices[steps[:, 0]])
    # A turn by a right angle costs as much as an edge of usual length.
    turns = usual * (1.0 - (directions[first] * directions[then]).sum(axis=1))
    leaving = np.flatnonzero(steps[:, 0] == start)
    root = len(steps)  # a node before all steps from the start
    graph = scipy.sparse.csr_array(
        (
            np.concatenate([costs[then] + turns, costs[leaving]]),
            (
                np.concatenate([first, np.full(len(leaving), root)]),
                np.concatenate([then, leaving]),
            ),
        ),
        shape=(root + 1, root + 1),
    )
    totals, before = csgraph.dijkstra(graph, indices=root, return_predecessors=True)
    arriving = np.flatnonzero(steps[:, 1] == end)
    if not np.isfinite(totals[arriving]).any():
        return None
    last = int(arriving[np.argmin(totals[arriving])])
    taken = path_to(last, before)[1:]
    return np.concatenate([[start], steps[taken, 1]])


def _pairs(steps: Integers) -> tuple[Integers, Integers]:
    """Return all pairs of consecutive steps, without those that go back: indices, (n,) each."""
    order = np.argsort(steps[:, 0], kind="stable")
    starts = steps[order, 0]
    low = np.searchsorted(starts, steps[:, 1], side="left")
    counts = np.searchsorted(starts, steps[:, 1], side="right") - low
    first = np.repeat(np.arange(len(steps)), counts)
    within = np.arange(len(first)) - np.repeat(np.cumsum(counts) - counts, counts)
    then = order[np.repeat(low, counts) + within]
    goes_on = steps[then, 1] != steps[first, 0]
    return first[goes_on], then[goes_on]


def distances_from(points: Floats64, line: Floats64) -> Floats64:
    """Return distances (n,) of points (n, 3) from a polyline (m, 3)."""
    place_count = 33  # points on each segment of the line
    steps = np.linspace(0.0, 1.0, place_count)[:, None, None]
    samples = (line[:-1] + steps * np.diff(line, axis=0)).reshape(-1, 3)
    return np.asarray(scipy.spatial.cKDTree(samples).query(points)[0])
