"""Fade the skin above the edge of a mesh that is cut off at the neck."""

import numpy as np

from ...geometry.arrays import Floats32, Floats64, Integers32, Integers64
from ..topology import boundary_loops


def neck_fade(vertices: Floats64, faces: Integers32, landmarks: Integers32) -> Floats32 | None:
    """Compute opacity of the skin, and distance in front of the neck, at each vertex, (V, 2).

    The first column is the opacity: up to 0 along the neck's edge, and 1 or more from 25 mm (or
    less) above it. The second column is the smaller of two distances [mm]: in front of the neck,
    and below the brows. Above the chin, the first distance may also be measured from the hind end
    of the cheeks, which may lie behind the front of the neck. Where the column is negative, the
    inner side of the skin is hidden, because it could only be seen through the neck, not through
    the mouth. Both columns belong to vertices, so a chin that moves down beside a short neck stays
    visible.

    vertices: at rest [mm], (V, 3). landmarks: vertex indices, (68,). Returns None if the mesh has
    no edge at the neck.
    """
    chin_landmark = 8
    chin = vertices[landmarks[chin_landmark]]
    eye_landmarks = slice(36, 48)
    eyes = vertices[landmarks[eye_landmarks], 1].mean()
    edges = [vertices[loop] for loop in boundary_loops(faces)]
    edges = [edge for edge in edges if edge[:, 1].max() < eyes]  # without the edge of a mask
    if not edges:
        return None
    points = np.vstack(edges)
    steps = np.vstack([np.roll(edge, -1, axis=0) - edge for edge in edges])
    # Without the upright edges of half heads.
    is_level = np.abs(steps[:, 1]) < 0.5 * np.linalg.norm(steps, axis=1)
    points = points[is_level & (points[:, 1] < chin[1])]
    if len(points) < 3:
        return None
    _, _, axes = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)
    up = axes[2]  # normal of the plane through the edge
    is_tilted = abs(up[1]) <= 0.5
    up = np.array([0.0, 1.0, 0.0]) if is_tilted else up * np.sign(up[1])
    bottom = float((points @ up).max())
    to_chin = float(chin @ up) - bottom
    full_height = 25.0  # [mm] above the neck's edge, at most half of the distance to the chin
    height = min(full_height, 0.5 * to_chin)
    if height <= 0.0:
        return None
    opacity = (vertices @ up - bottom) / height
    mouth_corners = [48, 54]
    cheek_depth = 65.0  # [mm] behind the corners, where cheeks are seen past the mouth's walls
    cheeks = vertices[landmarks[mouth_corners], 2].min() - cheek_depth
    neck_front = vertices[opacity < 1.0, 2].max()
    is_above_chin = vertices[:, 1] > chin[1]
    ahead = vertices[:, 2] - np.where(is_above_chin, min(neck_front, cheeks), neck_front)
    brow_landmarks = slice(17, 27)
    below = vertices[landmarks[brow_landmarks], 1].max() - vertices[:, 1]
    return np.stack([opacity, np.minimum(ahead, below)], axis=1).astype(np.float32)


def fading_last(vertices: Floats64, faces: Integers32, landmarks: Integers32) -> Integers64:
    """Return the order of triangles, (F,), with all fading triangles last.

    Skin is blended in this order, so that a chin behind a fading neck shows through.
    """
    fade = neck_fade(vertices, faces, landmarks)
    if fade is None:
        return np.arange(len(faces))
    is_fading = (fade[faces, 0] < 1.0).any(axis=1)
    return np.argsort(is_fading, kind="stable")
