"""Fade the skin above the edge of a mesh that is cut off at the neck."""

import numpy as np

from ...geometry.arrays import Floats32, Floats64, Integers32, Integers64
from ..topology import boundary_loops


def neck_fade(vertices: Floats64, faces: Integers32, landmarks: Integers32) -> Floats32 | None:
    """Visible share of the skin and distance ahead of the neck at each vertex, (V, 2); or None.

    The first column is the visible share: 0 and less along the neck's edge, 1 and more from up to
    25 mm above it. The second is the distance [mm] by which skin lies ahead of the neck or below
    the brows, the smaller of the two. If it is negative, the inner side of the skin could only be
    seen through the neck, not through the mouth, and is not drawn. Both are fixed to vertices, so a
    chin that moves down beside a short neck stays visible. vertices: at rest [mm], (V, 3).
    landmarks: vertices, (68,). None: no edge is at the neck.
    """
    chin_landmark = 8
    chin = vertices[landmarks[chin_landmark]]
    eye_landmarks = slice(36, 48)
    eyes = vertices[landmarks[eye_landmarks], 1].mean()
    edges = [vertices[loop] for loop in boundary_loops(faces)]
    edges = [edge for edge in edges if edge[:, 1].max() < eyes]  # a mask's goes around the face
    ways = [np.roll(edge, -1, axis=0) - edge for edge in edges]
    points, along = (np.vstack([np.empty((0, 3)), *each]) for each in (edges, ways))
    is_level = np.abs(along[:, 1]) < 0.5 * np.linalg.norm(along, axis=1)  # not of a half head
    points = points[is_level & (points[:, 1] < chin[1])]
    if len(points) < 3:
        return None
    up = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2][2]
    up = up * np.sign(up[1]) if abs(up[1]) > 0.5 else np.array([0.0, 1.0, 0.0])
    bottom = float((points @ up).max())
    full_height = 25.0  # [mm] above the neck's edge, at most half the way to the chin
    height = min(full_height, 0.5 * (float(chin @ up) - bottom))
    if height <= 0.0:
        return None
    share = (vertices @ up - bottom) / height
    ahead = vertices[:, 2] - vertices[share < 1.0, 2].max()
    brow_landmarks = slice(17, 27)
    below = vertices[landmarks[brow_landmarks], 1].max() - vertices[:, 1]
    return np.stack([share, np.minimum(ahead, below)], axis=1).astype(np.float32)


def fading_last(vertices: Floats64, faces: Integers32, landmarks: Integers32) -> Integers64:
    """The order of triangles with fading ones last, (F,).

    Skin is blended in this order, so a chin behind a faded neck is visible through it.
    """
    fade = neck_fade(vertices, faces, landmarks)
    if fade is None:
        return np.arange(len(faces))
    return np.argsort((fade[faces, 0] < 1.0).any(axis=1), kind="stable")
