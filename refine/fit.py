"""Fit split points to a finer mesh, so that the triangles between them lie on it and not only they.

Positions: the closest points on the finer mesh are a start; but where it bends between them, flat
triangles cut its corners off. So every vertex of the finer mesh pulls at the triangle that it is
closest to, and the points of all split edges and the middles of all triangles give way, while the
vertices of the coarse mesh stay: linear least squares, solved by conjugate gradients, a few times
over because after each time other triangles are the closest.

Normals: in the folds of lips and lids, where the vertices of a decimated face often lie, the normal
of one place says nothing about the triangles around it. So the normals that are shown are fitted
too, at vertices and points at once, to those of all finer vertices; once with no edge split and
once with all of them, because a frame shows something between the two.
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
STIFFNESS = 0.005
"""Pull back to where a point was, against 1 of a vertex of the finer mesh. Chosen by measurement:
less fits the vertices better and what lies between them worse."""
NORMAL_STIFFNESS, CORNER_STIFFNESS = 0.1, 1.0
"""The same for normals of points, and of vertices, which are there whatever is split around them.
Chosen by measurement on two heads."""
UNSPLIT = 0.3
"""How much the unsplit mesh counts in the fit of normals, against 1 of the split one. Chosen by
measurement, flat from 0.1 to 1."""
TOO_FAR = 1.0
"""A finer vertex farther away than this, in edge lengths, belongs nowhere on the coarse mesh."""
LOST = 0.05
"""Length of a fitted normal below which those that pulled at it have cancelled each other."""


def fitted(
    surface: Surface, mesh: Connectivity, positions: Doubles, points: Doubles, centres: Doubles
) -> tuple[Doubles, Doubles]:
    """Return points of edges, shape (E, 3, 3), and of triangles, shape (F, 3), that fit better.

    `surface`: the finer mesh; `positions`: of the coarse mesh at rest, shape (V, 3); `points` and
    `centres`: where to begin.
    """
    vertex_count, edge_count = len(positions), len(points)
    triangles = _all_split(mesh, vertex_count, edge_count)
    reach = _reach(mesh, positions)
    everything = np.concatenate([positions, points.reshape(-1, 3), centres])
    for _ in range(ROUNDS if len(triangles) else 0):
        corners, weights = _held(surface, everything, triangles, reach)
        pull = surface.positions - np.einsum("nk,nki->ni", weights, everything[corners])
        everything[vertex_count:] += _solved(
            corners - vertex_count, weights, pull, len(everything) - vertex_count, STIFFNESS
        )
    new_points = everything[vertex_count : vertex_count + 3 * edge_count]
    return new_points.reshape(-1, 3, 3), everything[vertex_count + 3 * edge_count :]


def fitted_normals(
    surface: Surface, mesh: Connectivity, everything: Doubles, normals: Doubles
) -> Doubles:
    """Return unit normals of vertices, points and centres that fit better, all of shape (N, 3).

    `everything`: where they are, in this order; `normals`: where to begin.
    """
    vertex_count, edge_count = mesh.vertex_count, len(mesh.edges)
    split = _all_split(mesh, vertex_count, edge_count)
    if len(split) == 0:
        return normals
    whole = mesh.faces[~mesh.is_degenerate].astype(np.int64)
    reach = _reach(mesh, everything[:vertex_count])
    terms = []
    for triangles, share in ((split, 1.0), (whole, UNSPLIT)):
        corners, weights = _held(surface, everything, triangles, reach)
        is_near = weights.any(axis=1, keepdims=True)
        pull = is_near * surface.normals - np.einsum("nk,nki->ni", weights, normals[corners])
        terms.append((corners, np.sqrt(share) * weights, np.sqrt(share) * pull))
    corners, weights, pull = (np.concatenate(part) for part in zip(*terms, strict=True))
    stiffness = np.full((len(normals), 1), NORMAL_STIFFNESS)
    stiffness[:vertex_count] = CORNER_STIFFNESS
    turned = normals + _solved(corners, weights, pull, len(normals), stiffness)
    lengths = np.linalg.norm(turned, axis=1, keepdims=True)
    return np.where(lengths > LOST, turned / np.maximum(lengths, LOST), normals)


def _reach(mesh: Connectivity, positions: Doubles) -> float:
    """How far a finer vertex may be away."""
    lengths = np.linalg.norm(np.diff(positions[mesh.edges], axis=1)[:, 0], axis=1)
    return TOO_FAR * float(lengths.mean()) if len(lengths) else 0.0


def _held(
    surface: Surface, positions: Doubles, triangles: Wide, reach: float
) -> tuple[Wide, Doubles]:
    """The triangle that is closest to each finer vertex: its corners and their weights, (N, 3)."""
    refined = Surface(positions, triangles.astype(np.uint32))
    hit, weights = refined.closest(surface.positions, surface.normals.astype(np.float64))
    away = surface.positions - refined.at(positions, hit, weights)
    weights[np.linalg.norm(away, axis=1) > reach] = 0.0
    return triangles[hit], weights


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


def _solved(
    corners: Wide, weights: Doubles, pull: Doubles, count: int, stiffness: float | Doubles
) -> Doubles:
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
        return gathered(answers) + stiffness * moves

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
