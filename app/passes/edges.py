"""The edges of lips and lids as a camera sees them: 14 of the landmarks.

Annotators mark the line between a lip and the mouth's inside, or between two shut lips; the edge of
a lid, or the line between shut lids. Lips and lids are round, and one may cover the other. So this
line is at a different place of the skin in each picture.
"""

from __future__ import annotations

import numpy as np

from risorius.assets.annotation import EDGE_LANDMARKS, NEAR_STEPS
from risorius.geometry.arrays import Flags, Floats64

from ..scenes import Face
from .camera import CameraLabels

FACING = ((61, 67), (62, 66), (63, 65), (37, 41), (38, 40), (43, 47), (44, 46))  # upper and lower


def edge_points(
    face: Face, camera: CameraLabels, positions: Floats64, normals: Floats64
) -> Floats64:
    """Return the landmarks EDGE_LANDMARKS in a picture [mm], shape (14, 3).

    positions, normals: of the skin's vertices, (V, 3) each.

    Each is the first place on a path from the edge of the lip or lid outward that neither this
    edge nor the facing one covers. If a lip is rolled in and wholly covered, its edge is the edge
    of the other lip.
    """
    paths = face.annotation.edge_paths(positions, normals)
    head_up = face.bone_transforms()["cranium"][:3, 1]
    up_in_picture = (camera.rotation @ head_up)[:2]
    points = np.empty((len(paths), 3))
    for landmarks in FACING:
        rows = [EDGE_LANDMARKS.index(landmark) for landmark in landmarks]
        heights = np.array([camera.project(path) @ up_in_picture for path in paths[rows]])
        depths = np.array([camera.to_camera(path)[:, 2] for path in paths[rows]])
        is_free = ~_is_covered(heights, depths)[:, :NEAR_STEPS]
        edges = paths[rows, is_free.argmax(axis=1)]
        for side, opposite in ((0, 1), (1, 0)):
            if not is_free[side].any():
                edges[side] = edges[opposite]
        points[rows] = edges
    return points


def _is_covered(heights: Floats64, depths: Floats64) -> Flags:
    """Return which places of two facing paths have a nearer place before them, (2, n).

    heights: of the places in the picture [pixels], (2, n). depths: from the camera [mm], (2, n).
    """
    least_distance = 0.2  # [mm] between a place and another one that covers it
    start = heights[:, :-1].ravel()
    rise = np.diff(heights).ravel()
    is_level = np.abs(rise) < 1e-9
    fraction = (heights[:, :, None] - start) / np.where(is_level, 1.0, rise)
    is_beside = ~is_level & (fraction >= 0.0) & (fraction <= 1.0)
    crossed_depths = depths[:, :-1].ravel() + fraction * np.diff(depths).ravel()
    is_nearer = crossed_depths < depths[:, :, None] - least_distance
    return np.asarray((is_beside & is_nearer).any(axis=2))
