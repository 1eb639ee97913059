"""Fit split points to a finer mesh, so that the triangles between them lie on it and not only they.

The closest points on the finer mesh are a start; but where it bends between them, flat triangles
cut its corners off. So every vertex of the finer mesh pulls at the triangle that it is closest to,
and the points of all split edges and the middles of all triangles give way, while the vertices of
the coarse mesh stay: linear least squares, solved by conjugate gradients, a few times over because
after each time other triangles are the closest.
"""

import numpy as np
import numpy.typing as npt

from .closest import Surface
from .connectivity import Connectivity
from .patterns import FANS

Doubles = npt.NDArray[np.float64]
Wide = npt.NDArray[np.int64]

ROUNDS = 4
"""Times that closest triangles are found anew; more gave less than 1 % (measured, a scanned face).
"""
STEPS = 20
"""Steps of conjugate gradients in each round."""
STIFFNESS = 0.02
"""Pull back to where a point was, against 1 of a vertex of the finer mesh. Chosen by measurement:
less fits the vertices better and what lies between them worse."""
TOO_FAR = 1.0
"""A finer vertex farther away than this, in edge lengths, belongs nowhere on the coarse mesh."""


def fitted(
    surface: Surface, mesh: Connectivity, positions: Doubles, points: Doubles, centres: Doubles
) -> tuple[Doubles, Doubles]:
    """Return points of edges, shape (E, 3, 3), and of triangles, shape (F, 3), that fit better.

    `surface`: the finer mesh; `positions`: of the coarse mesh at rest, shape (V, 3); `points` and
    `centres`: where to begin.
    """
    vertex_count, edge_count = len(positions), len(points)
    triangles = _all_split(mesh, vertex_count, edge_count)
    lengths = np.linalg.norm(np.diff(positions[mesh.edges], axis=1)[:, 0], axis=1)
    reach = TOO_FAR * float(lengths.mean()) if edge_count else 0.0
    everything = np.concatenate([positions, points.reshape(-1, 3), centres])
    for _ in range(ROUNDS if len(triangles) else 0):
        refined = Surface(everything, triangles.astype(np.uint32))
        hit, weights = refined.closest(surface.positions, surface.normals.astype(np.float64))
        pull = surface.positions - refined.at(everything, hit, weights)
        weights[np.linalg.norm(pull, axis=1) > reach] = 0.0
        everything[vertex_count:] += _solved(
            triangles[hit] - vertex_count, weights, pull, len(everything) - vertex_count
        )
    new_points = everything[vertex_count : vertex_count + 3 * edge_count]
    return new_points.reshape(-1, 3, 3), everything[vertex_count + 3 * edge_count :]


def _all_split(mesh: Connectivity, vertex_count: int, edge_count: int) -> Wide:
    """The triangles of a mesh whose edges are all split twice, into fans, shape (12 F, 3)."""
    proper = np.flatnonzero(~mesh.is_degenerate)
    edges = mesh.triangle_edges[proper].astype(np.int64)
    is_against = mesh.edges[edges][..., 0] != mesh.faces[proper]
    local = np.empty((len(proper), 13), dtype=np.int64)
    local[:, :3] = mesh.faces[proper]
    first = vertex_count + 3 * edges
    local[:, 3:12:3] = first + 1
    local[:, 4:12:3] = first + 2 * is_against
    local[:, 5:12:3] = first + 2 - 2 * is_against
    local[:, 12] = vertex_count + 3 * edge_count + proper
    return local[:, FANS.subtriangles[26]].reshape(-1, 3)


def _solved(corners: Wide, weights: Doubles, pull: Doubles, count: int) -> Doubles:
    """Return how far each of `count` points moves, shape (count, 3).

    Each pull is answered by the corners, shape (N, 3), of its triangle with their weights; negative
    numbers are vertices that stay.
    """
    weights = np.where(corners >= 0, weights, 0.0)
    corners = np.maximum(corners, 0)

    def gathered(residuals: Doubles) -> Doubles:
        shares = (weights[..., None] * residuals[:, None]).reshape(-1, 3)
        columns = [np.bincount(corners.ravel(), shares[:, i], count) for i in range(3)]
        return np.stack(columns, axis=1)

    def applied(moves: Doubles) -> Doubles:
        answers: Doubles = np.einsum("nk,nki->ni", weights, moves[corners])
        return gathered(answers) + STIFFNESS * moves

    moves = np.zeros((count, 3))
    residual = gathered(pull)
    direction, square = residual.copy(), float((residual**2).sum())
    for _ in range(STEPS):
        if square < 1e-20:
            break
        image = applied(direction)
        step = square / float((direction * image).sum())
        moves += step * direction
        residual -= step * image
        previous, square = square, float((residual**2).sum())
        direction = residual + square / previous * direction
    return moves
