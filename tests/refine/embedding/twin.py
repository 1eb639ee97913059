"""Recompute `Embedding.evaluate` for closed meshes in plain numpy, slowly, from its documentation.

Vlachos, Peters, Boyd, Mitchell 2001, "Curved PN triangles", with tangents and offsets that are
carried along (refine/embedding/patches.py and frames.py).
"""

from dataclasses import dataclass

import numpy as np
from numpy.linalg import norm
from scipy.spatial.transform import Rotation

from risorius.geometry.arrays import Floats64, Integers32, Integers64

MOST_CARRIED = 0.5  # largest error of a carried tangent, in lengths of the tangent


def unit(vector: Floats64) -> Floats64:
    """The vector, scaled to length one."""
    return np.asarray(vector / norm(vector))


@dataclass
class Fan:
    """Data of the triangles around a vertex at rest.

    numbers: corners of each triangle, the vertex first, (k, 3). weights: of their cross products.
    areas: shares of the triangles, (k,). edges: at rest, (k, 3, 2). directions: two perpendicular
    to the normal, (3, 2).
    """

    numbers: Integers64
    weights: Floats64
    areas: Floats64
    edges: Floats64
    directions: Floats64


def edges_of(points: Floats64, numbers: Integers64) -> Floats64:
    """Both edges of triangles from their first corner, as columns, shape (k, 3, 2)."""
    corners = points[numbers]
    return np.asarray(np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2))


class Twin:
    """A closed coarse mesh at rest, and the embedding's surface over it."""

    def __init__(self, faces: Integers32, rest: Floats64) -> None:
        self.faces = faces
        turns = np.concatenate([np.roll(faces, -corner, axis=1) for corner in range(3)])
        self.fans = [self._fan(turns[turns[:, 0] == v], rest) for v in range(len(rest))]
        self.rest_axes = [self._axes(fan, rest) for fan in self.fans]
        self.slopes = {}  # each edge's tangent at rest: weights of both directions
        for a, b in np.concatenate([turns[:, [0, 1]], turns[:, [0, 2]]]):
            self.slopes[a, b] = self._slope(a, b, rest)

    @staticmethod
    def _fan(numbers: Integers64, rest: Floats64) -> Fan:
        edges = edges_of(rest, numbers)
        crosses = np.cross(edges[:, :, 0], edges[:, :, 1])
        doubled = norm(crosses, axis=1)
        angles = np.arctan2(doubled, (edges[:, :, 0] * edges[:, :, 1]).sum(axis=1))
        weights = np.sqrt(angles / doubled)
        normal = unit(weights @ crosses)
        first = unit(np.cross(normal, np.eye(3)[np.abs(normal).argmin()]))
        directions = np.stack([first, np.cross(normal, first)], axis=1)
        return Fan(numbers, weights, doubled / doubled.sum(), edges, directions)

    @staticmethod
    def _axes(fan: Fan, points: Floats64) -> tuple[Floats64, Floats64]:
        """Return the vertex's normal, and its tangents at rest, moved by the triangles, (3, 2)."""
        edges = edges_of(points, fan.numbers)
        normal = unit(fan.weights @ np.cross(edges[:, :, 0], edges[:, :, 1]))
        moves = edges @ np.linalg.pinv(fan.edges)  # linear maps of the triangles' planes
        carried = np.einsum("k,kij->ij", fan.areas, moves) @ fan.directions
        return normal, carried - np.outer(normal, normal @ carried)

    def _slope(self, a: int, b: int, rest: Floats64) -> Floats64:
        normal, directions = self.rest_axes[a]
        edge = rest[b] - rest[a]
        flat = edge - (edge @ normal) * normal
        return np.asarray(np.linalg.lstsq(directions, flat, rcond=None)[0])

    @staticmethod
    def _frame(axes: tuple[Floats64, Floats64]) -> Floats64:
        """A right-handed frame in columns; polar decomposition prefers no direction."""
        normal, directions = axes
        along = unit(directions[:, 0] + np.cross(directions[:, 1], normal))
        return np.stack([normal, along, np.cross(normal, along)], axis=1)

    def evaluate(
        self,
        points: Floats64,
        triangles: Integers64,
        weights: Floats64,
        offsets: Floats64,
    ) -> Floats64:
        """Positions for weights (N, 3) in `triangles`, (N,), with offsets, (N, 3)."""
        axes = [self._axes(fan, points) for fan in self.fans]
        quaternions = [
            Rotation.from_matrix(self._frame(now) @ self._frame(rest).T).as_quat()
            for now, rest in zip(axes, self.rest_axes, strict=True)
        ]
        found = []
        for triangle, shares, offset in zip(triangles, weights, offsets, strict=True):
            corners = self.faces[triangle]
            turns = np.array([quaternions[corner] for corner in corners])
            turns[turns @ turns[0] < 0.0] *= -1.0
            turn = Rotation.from_quat(shares @ turns)
            found.append(self._place(points, axes, corners, shares) + offset @ turn.as_matrix().T)
        return np.array(found)

    def _place(
        self,
        points: Floats64,
        axes: list[tuple[Floats64, Floats64]],
        corners: Integers32,
        shares: Floats64,
    ) -> Floats64:
        """A point on the cubic patch over a triangle."""
        place = shares**3 @ points[corners]
        nears = np.zeros(3)
        for i in range(3):
            for j in range(3):
                if i != j:
                    near = self._tangent(points, axes, corners[i], corners[j]) / 3.0
                    nears += near
                    control_point = points[corners[i]] + near
                    place += 3.0 * shares[i] ** 2 * shares[j] * control_point
        middle = points[corners].mean(axis=0) + 0.25 * nears
        return np.asarray(place + 6.0 * shares.prod() * middle)

    def _tangent(
        self, points: Floats64, axes: list[tuple[Floats64, Floats64]], a: int, b: int
    ) -> Floats64:
        normal, directions = axes[a]
        edge = points[b] - points[a]
        now = edge - (edge @ normal) * normal
        change = directions @ self.slopes[a, b] - now
        most = MOST_CARRIED * norm(now)
        length = norm(change)
        return np.asarray(now + (change if length <= most else change * most / length))
