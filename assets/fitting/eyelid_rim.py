"""What closes an eye of another head behind its lids: a rim from their edge to the eyeball.

The built-in lids reach behind the front of the ball, and flesh fills their corners. A mesh that is
brought ends anywhere: between its edge and the ball one would look into the empty head.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from risorius.geometry.normals import vertex_normals

from ..model import Eye, FloatArray, IndexArray, Part
from ..topology import boundary_loops, quads_between

FLESH = "eye_corners"  # the part that rims belong to: they have its colour
FARTHEST = 1.6  # radii of the ball from its centre: the edge around an eye is nearer
ROWS = 8  # of vertices, from the lids' edge backward
BEHIND = 3.0  # [mm] behind the equator of the ball: there a rim ends
TUCKED, SUNK = 0.2, 0.3  # [mm] that it begins within the lids and ends within the ball
DARKEST = 0.6  # of the light at its end: it lies in the shade


def with_eyelid_rims(
    parts: Sequence[Part], vertices: FloatArray, faces: IndexArray, eyes: Sequence[Eye]
) -> tuple[Part, ...]:
    """The parts of a head, its flesh with a rim for each eye whose skin ends around it.

    vertices: of the skin [mm], shape (V, 3); faces: its triangles, shape (F, 3).
    """
    loops = [(eye, _edge_around(eye, vertices, faces)) for eye in eyes]
    return tuple(
        _joined(part, [_rim_of(eye, vertices[loop]) for eye, loop in loops if loop])
        if part.name == FLESH
        else part
        for part in parts
    )


def _edge_around(eye: Eye, vertices: FloatArray, faces: IndexArray) -> list[int]:
    """The edge of the skin around an eye, in the direction of its faces; [] in a closed socket."""
    reach = FARTHEST * eye.radius
    away = np.linalg.norm(vertices - eye.centre, axis=1)
    near = faces[(away[faces] < 2.0 * reach).any(axis=1)]  # all would take a second
    loops = boundary_loops(near)
    return next((loop for loop in loops if away[loop].max() < reach), [])


def _rim_of(eye: Eye, edge: FloatArray) -> tuple[FloatArray, IndexArray]:
    """Vertices (ROWS n, 3), row by row, and faces that are seen from the front.

    edge: where the skin ends, shape (n, 3), in the direction of its faces. From each of its points
    a row runs backward around the ball and comes nearer to it.
    """
    away = edge - eye.centre
    length = np.linalg.norm(away, axis=1)
    beside = away * [1.0, 1.0, 0.0]
    beside /= np.maximum(np.linalg.norm(beside, axis=1, keepdims=True), 1e-9)
    start = np.arccos(away[:, 2] / length)
    end = np.maximum(0.5 * np.pi + np.arcsin(BEHIND / eye.radius), start)
    share = np.linspace(0.0, 1.0, ROWS)[:, None]
    angle = (1.0 - share) * start + share * end
    reach = (1.0 - share) * (length + TUCKED) + share * (eye.radius - SUNK)
    ahead = np.sin(angle)[..., None] * beside + np.cos(angle)[..., None] * [0.0, 0.0, 1.0]
    points = eye.centre + (reach[..., None] * ahead).reshape(-1, 3)
    rows = np.arange(ROWS * len(edge)).reshape(ROWS, -1)
    a, b, c, d = np.array(quads_between(rows.tolist(), closed=True), np.int32).T
    faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    return points, faces


def _joined(part: Part, rims: Sequence[tuple[FloatArray, IndexArray]]) -> Part:
    """A part with rims of its colour, which darken backward."""
    colour = part.colours.mean(axis=0)
    for points, faces in rims:
        light = np.repeat(np.linspace(1.0, DARKEST, ROWS), len(points) // ROWS)
        part = replace(
            part,
            faces=np.concatenate([part.faces, faces + np.int32(len(part.vertices))]),
            vertices=np.concatenate([part.vertices, points], dtype=np.float32),
            normals=np.concatenate([part.normals, vertex_normals(points, faces)], dtype=np.float32),
            colours=np.concatenate([part.colours, light[:, None] * colour], dtype=np.float32),
        )
    return part
