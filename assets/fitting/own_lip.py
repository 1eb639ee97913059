"""Find the nearest points on the warped built-in skin, for vertices of a lip on the same lip.

Full lips overlap: one lip may lie in front of the other lip's edge. There the warped lips cross, so
the nearest point may belong to the other lip.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...geometry.arrays import Flags, Floats64, Integers32
from ...geometry.closest import SurfacePoints
from ...geometry.mesh_graph import path_lengths
from ..model import Head
from .mesh_validation import SkinPiece
from .warp import nearest_on


def nearest_own(known: Head, warped: Floats64, skin: SkinPiece, normals: Floats64) -> SurfacePoints:
    """Find, as `nearest_on` does, the nearest points on the warped built-in skin.

    No vertex of one lip gets a point of the other lip. warped: vertices of the built-in skin, (V,
    3). normals: unit normals of the skin's vertices.
    """
    found = nearest_on(skin.vertices, normals, warped, known.faces)
    own = lip_sides(skin.vertices, skin.faces, skin.landmarks)
    sides = lip_sides(known.vertices, known.faces, known.landmarks)
    for side in (1, -1):
        is_other_lip = (sides == -side)[known.faces].any(axis=1)
        is_wrong = (own == side) & is_other_lip[found.triangles]
        allowed = np.flatnonzero(~is_other_lip)
        points = skin.vertices[is_wrong]
        better = nearest_on(points, normals[is_wrong], warped, known.faces[allowed])
        found = _replaced(found, is_wrong, replace(better, triangles=allowed[better.triangles]))
    return found


def lip_sides(vertices: Floats64, faces: Integers32, landmarks: Integers32) -> Integers32:
    """Return 1 for vertices of the upper lip, -1 for vertices of the lower lip, else 0; (V,)."""
    edges_of_lips = (slice(61, 64), slice(65, 68))
    paths = [path_lengths(vertices, faces, landmarks[edge]).min(axis=0) for edge in edges_of_lips]
    upper, lower = paths
    lip_reach = 20.0  # [mm] along the skin from the inner edge of a lip
    between = 4.0  # [mm]; least difference between the paths to both lips
    sides = np.zeros(len(vertices), np.int32)
    sides[(upper < lip_reach) & (upper + between < lower)] = 1
    sides[(lower < lip_reach) & (lower + between < upper)] = -1
    return sides


def _replaced(points: SurfacePoints, where: Flags, others: SurfacePoints) -> SurfacePoints:
    """Replace those points where a flag of `where` (n,) is set."""
    places = {}
    for name in ("distances", "triangles", "corners", "weights"):
        values = getattr(points, name).copy()
        values[where] = getattr(others, name)
        places[name] = values
    return SurfacePoints(**places)
