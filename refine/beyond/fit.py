"""Fit split points to a finer mesh, so that the triangles between them lie on it and not only they.

Positions: the closest points on the finer mesh are a start; but where it bends between them, flat
triangles cut its corners off. So every vertex of the finer mesh pulls at the triangle that it is
closest to, and the points of all split edges and the middles of all triangles give way, while the
vertices of the coarse mesh stay: linear least squares, solved by conjugate gradients, a few times
over because after each time other triangles are the closest.

Triangles around an edge that is split once are twice as long as around one that is split twice, and
cut more off: the middle of an edge has one place for each, and so has the middle of a triangle.

The middles of triangles are fitted twice: with all else where the edges meet half way, because an
unblended frame has none of them; then alone, where they slide to (axes.py).
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ...geometry.closest import closest_points
from ..kahler.table import CENTRE, CONFIGURATIONS, Patterns
from ..mesh.arrays import Doubles, Floats, Wide
from ..mesh.connectivity import Connectivity
from .blending import FANS

ROUNDS, ONCE_ROUNDS = 4, 2
"""Times that closest triangles are found anew, for all points and for those of edges split once;
more gave less than 1 % (measured, a scanned face)."""
STEPS = 20
"""Steps of conjugate gradients in each round."""
STIFFNESS = 0.05
"""Pull back to where a point was, against 1 of a vertex of the finer mesh. Chosen by measurement:
less fits the vertices better and what lies between them worse, and lets points leap far out where
the finer mesh is hardly finer."""
TWICE = (FANS, 26)
ONCE = ((FANS, 13), (CONFIGURATIONS, 13))
"""Tables and rows (kahler/table.py) that points are fitted to: all edges split twice, and once;
blended and not, because the middle of a triangle is there only in one of them."""
START, MIDDLE, END, ALONE = 0, 1, 2, 3
"""Points of an edge: two quarters and the middle if it is split twice, the middle if once."""
TOO_FAR = 1.0
"""A finer vertex farther away than this, in edge lengths, belongs nowhere on the coarse mesh."""
WRONG_SIDE = 10.0
"""How much farther away, in edge lengths, a surface seems that looks the other way: lips that touch
at rest do not take each other's points."""


class FinerSurface(NamedTuple):
    """The finer mesh at rest."""

    positions: Doubles
    """Shape (V, 3)."""
    normals: Doubles
    """Of its vertices, shape (V, 3)."""
    faces: Wide
    """Shape (F, 3)."""


class Points(NamedTuple):
    """A place, or a way to it, for each point that splitting may make."""

    of_edges: Doubles
    """START, MIDDLE, END of edges split twice, ALONE of those split once, shape (E, 4, 3)."""
    of_triangles: Doubles
    """The middle, with all edges split twice, and once, shape (F, 2, 3)."""

    def stacked(self, vertices: npt.NDArray[np.floating]) -> Doubles:
        """One list, shape (N, 3): those of vertices first."""
        return np.concatenate([vertices, *(part.reshape(-1, 3) for part in self)])

    @staticmethod
    def unstacked(rows: Doubles, mesh: Connectivity) -> "Points":
        """Take the list apart again."""
        first = mesh.vertex_count + 4 * len(mesh.edges)
        of_edges, of_triangles = rows[mesh.vertex_count : first], rows[first:]
        return Points(of_edges.reshape(-1, 4, 3), of_triangles.reshape(-1, 2, 3))


def fit(
    surface: FinerSurface, mesh: Connectivity, positions: Doubles, normals: Floats,
    edges: tuple[Doubles, Doubles], middles: tuple[Doubles, Doubles],
) -> Points:  # fmt: skip
    """Fit everything to the finer mesh `surface`.

    `positions`, `normals`: of the coarse mesh at rest, shape (V, 3); `edges`: points of edges to
    begin with and normals there, shape (E, 4, 3); `middles`: where in triangles their middle points
    lie, as shares of the corners, and normals there, shape (F, 3).
    """
    shares, middle_ups = middles[0], np.repeat(middles[1][:, None], 2, axis=1)
    away = WRONG_SIDE * _mean_length(mesh, positions)
    of_edges = closest_places(surface, *edges, away)
    corner_ups = np.repeat(normals[mesh.faces].sum(axis=1)[:, None], 2, axis=1)
    centres = middles_of(of_edges, mesh, positions, np.full_like(shares, 1.0 / 3.0))
    start = Points(of_edges, closest_places(surface, centres, corner_ups, away))
    places = fitted(surface, mesh, positions, start, mesh.vertex_count)
    first_middle = mesh.vertex_count + 4 * len(mesh.edges)
    centres = middles_of(places.of_edges, mesh, positions, shares)
    start = Points(places.of_edges, closest_places(surface, centres, middle_ups, away))
    return fitted(surface, mesh, positions, start, first_middle)


def middles_of(
    of_edges: Doubles, mesh: Connectivity, positions: Doubles, shares: Doubles
) -> Doubles:
    """Middles of triangles whose edges are all split, twice and once, shape (F, 2, 3).

    `of_edges`: places of the points of edges; `shares`: where in the triangles, shape (F, 3).
    """
    displacements = of_edges[:, [MIDDLE, ALONE]] - positions[mesh.edges].mean(axis=1)[:, None]
    displacements = np.concatenate(
        [displacements, np.zeros((1, 2, 3))]
    )  # found at -1, where there is no edge
    weights = 4.0 * shares * np.roll(shares, -1, axis=1)
    flat = np.einsum("fi,fij->fj", shares, positions[mesh.faces])
    middles: Doubles = flat[:, None] + np.einsum(
        "fi,fikj->fkj", weights, displacements[mesh.triangle_edges]
    )
    return middles


def closest_places(
    surface: FinerSurface, points: Doubles, normals: Doubles, wrong_side: float
) -> Doubles:
    """Closest points on the finer mesh that look the way of `normals`, in the shape of `points`."""
    queries, ways = points.reshape(-1, 3), normals.reshape(-1, 3)
    found = closest_points(queries, surface.positions, surface.faces, ways, wrong_side)
    return found.interpolate(surface.positions).reshape(points.shape)


def fitted(
    surface: FinerSurface, mesh: Connectivity, positions: Doubles, points: Points, first: int
) -> Points:
    """Return points that fit better.

    `points`: where to begin; `first`: the first that may move, of vertices and points stacked.
    """
    length = _mean_length(mesh, positions)
    places = points.stacked(positions)
    shapes = [split_everywhere(mesh, *row) for row in (TWICE, *ONCE)]
    for k in range(ROUNDS if len(shapes[0]) else 0):
        if k == ONCE_ROUNDS:
            shapes = shapes[:1]
        corners, weights, residuals = _residuals(surface, places, shapes, length)
        places[first:] += _solved(corners - first, weights, residuals, len(places) - first)
    return Points.unstacked(places, mesh)


def split_everywhere(mesh: Connectivity, patterns: Patterns, row: int) -> Wide:
    """All triangles cut like one row of a table, of stacked points, shape (K, 3)."""
    proper = np.flatnonzero(~mesh.is_degenerate)
    edges = mesh.triangle_edges[proper].astype(np.int64)
    is_against = mesh.edges[edges][..., 0] != mesh.faces[proper]
    is_twice = row == TWICE[1]
    local = np.empty((len(proper), CENTRE + 1), dtype=np.int64)
    local[:, :3] = mesh.faces[proper]
    first = mesh.vertex_count + 4 * edges
    local[:, 3:12:3] = first + (MIDDLE if is_twice else ALONE)
    local[:, 4:12:3] = first + np.where(is_against, END, START)
    local[:, 5:12:3] = first + np.where(is_against, START, END)
    local[:, CENTRE] = mesh.vertex_count + 4 * len(mesh.edges) + 2 * proper + (not is_twice)
    return local[:, patterns.subtriangles[row, : patterns.counts[row]]].reshape(-1, 3)


def _mean_length(mesh: Connectivity, positions: Doubles) -> float:
    """Mean length of the edges of the coarse mesh; 0 if there are none."""
    lengths = np.linalg.norm(np.diff(positions[mesh.edges], axis=1)[:, 0], axis=1)
    return float(lengths.mean()) if len(lengths) else 0.0


def _residuals(
    surface: FinerSurface, places: Doubles, shapes: list[Wide], length: float
) -> tuple[Wide, Doubles, Doubles]:
    """What the finer vertices want of the triangles that they are closest to, in every shape.

    `places`: shape (P, 3); `shapes`: triangles of them, shape (K, 3) each. Returns corners and
    weights, shape (N, 3), and the way from there to the finer vertices, shape (N, 3).
    """
    terms = []
    for triangles in shapes:
        found = closest_points(
            surface.positions, places, triangles, surface.normals, WRONG_SIDE * length
        )
        away = surface.positions - found.interpolate(places)
        is_near = found.distances[:, None] <= TOO_FAR * length
        terms.append((found.corners, is_near * found.weights, is_near * away))
    corners, weights, residuals = (np.concatenate(part) for part in zip(*terms, strict=True))
    return corners, weights, residuals


def _solved(corners: Wide, weights: Doubles, residuals: Doubles, count: int) -> Doubles:
    """Return how far each of `count` points moves, shape (count, 3).

    Each residual is answered by the corners, shape (N, 3), of its triangle with their weights;
    negative numbers are vertices that stay.
    """
    weights = np.where(corners >= 0, weights, 0.0)
    corners = np.maximum(corners, 0)

    def gathered(errors: Doubles) -> Doubles:
        shares = (weights[..., None] * errors[:, None]).reshape(-1, 3)
        columns = [np.bincount(corners.ravel(), shares[:, i], count) for i in range(3)]
        return np.stack(columns, axis=1)

    def applied(moves: Doubles) -> Doubles:
        answers: Doubles = np.einsum("nk,nki->ni", weights, moves[corners])
        return gathered(answers) + STIFFNESS * moves

    moves = np.zeros((count, 3))
    left = gathered(residuals)
    direction, square = left.copy(), float((left**2).sum())
    for _ in range(STEPS):
        if square < 1e-20:
            break
        image = applied(direction)
        step = square / float((direction * image).sum())
        moves += step * direction
        left -= step * image
        previous, square = square, float((left**2).sum())
        direction = left + square / previous * direction
    return moves
