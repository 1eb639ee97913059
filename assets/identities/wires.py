"""Make wires and sheets for clothes: frames of glasses, masks, ear loops, collars."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy

from ...geometry.arrays import Floats64, Integers32
from ...geometry.directions import unit_vectors
from ...geometry.normals import vertex_normals
from ..topology import grid_faces

Colour = tuple[float, float, float]


def beside_head(skin: Floats64, start: Floats64, end: Floats64, radius: float) -> Floats64:
    """Lay a wire along the side of the head to an end above or below the ear; the path is (24, 3).

    The wire is taut, and does not touch the skin. skin: vertices [mm], (V, 3). start, end: [mm],
    (3,). radius: radius of the wire [mm].
    """
    side = np.sign(start[0])
    fraction = np.linspace(0.0, 1.0, 24)[:, None]
    straight = start + fraction * (end - start)
    head = skin[skin[:, 2] > end[2] + 10.0]  # without the ear
    tree = scipy.spatial.cKDTree(head[:, 1:])
    near = tree.query_ball_point(straight[:, 1:], 6.0)
    widest = np.array([(side * head[found, 0]).max(initial=0.0) for found in near])
    least = np.maximum(side * straight[:, 0], widest + radius + 1.8)
    least[0] = side * straight[0, 0]
    wanted = least.copy()
    for _ in range(200):  # until it is taut
        mean_of_neighbours = 0.5 * (wanted[:-2] + wanted[2:])
        wanted[1:-1] = np.maximum(least[1:-1], mean_of_neighbours)
    straight[:, 0] = side * wanted
    return straight


class Tube(NamedTuple):
    """A wire or a sheet: points [mm] (n, 3), unit normals (n, 3), and triangles (m, 3)."""

    points: Floats64
    normals: Floats64
    faces: Integers32


def joined(pieces: Sequence[Tube]) -> Tube:
    """Join wires and sheets to one surface."""
    points = np.vstack([each.points for each in pieces])
    normals = np.vstack([each.normals for each in pieces])
    faces = []
    first = 0  # number of the piece's first point
    for each in pieces:
        faces.append(each.faces + first)
        first += len(each.points)
    return Tube(points, normals, np.vstack(faces).astype(np.int32))


def tube(path: Floats64, thickness: float, *, closed: bool) -> Tube:
    """Make a round tube along a path (n, 3); thickness: diameter [mm]."""
    corners = 8
    if closed:
        along = np.roll(path, -1, axis=0) - np.roll(path, 1, axis=0)
    else:
        along = np.gradient(path, axis=0)
    along = unit_vectors(along)
    first = unit_vectors(np.cross(along, [0.31, 0.52, 0.79]))
    second = np.cross(along, first)
    angle = np.linspace(0.0, 2.0 * np.pi, corners, endpoint=False)[:, None, None]
    normals = np.cos(angle) * first + np.sin(angle) * second  # (corners, n, 3)
    points = path + 0.5 * thickness * normals
    numbers = np.arange(points.shape[0] * points.shape[1]).reshape(points.shape[:2])
    around = np.vstack([numbers, numbers[:1]])
    faces = grid_faces(around, closed=closed)
    return Tube(points.reshape(-1, 3), normals.reshape(-1, 3), faces)


def sheet(outer: Floats64, inner: Floats64) -> Tube:
    """Make a sheet with two sides and a closed edge.

    outer, inner: points of both sides [mm], (r, c, 3), in rows from the upper edge down.
    """
    numbers = np.arange(outer[..., 0].size).reshape(outer.shape[:2])
    count = numbers.size
    upper = numbers[0]
    right = numbers[1:, -1]
    lower = numbers[-1, -2::-1]
    left = numbers[-2:0:-1, 0]
    edge = np.concatenate([upper, right, lower, left])
    rim = grid_faces(np.stack([edge + count, edge]), closed=True)
    outside = grid_faces(numbers)
    inside = outside[:, ::-1] + count
    points = np.vstack([outer.reshape(-1, 3), inner.reshape(-1, 3)])
    faces = np.vstack([outside, inside, rim]).astype(np.int32)
    return Tube(points, vertex_normals(points, faces), faces)
