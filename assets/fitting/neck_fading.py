"""How a head ends whose mesh is cut off at the neck: in pictures its skin fades there."""

import numpy as np

from ...geometry.arrays import Floats64, Integers32
from ..topology import boundary_loops

Plane = tuple[float, float, float, float]  # (a, b, c, d): a x + b y + c z + d


def neck_fade(
    vertices: Floats64, faces: Integers32, landmarks: Integers32
) -> tuple[Plane, Plane] | None:
    """Planes of which the larger value of a x + b y + c z + d is the share of skin that shows.

    The first is 0 along the neck's edge, and 1 up to 25 mm above. The second grows from 0 ahead of
    all skin that fades at rest: a chin that goes down there stays whole. vertices: [mm], (V, 3).
    landmarks: vertices, (68,). None: the mesh has no edge at the neck.
    """
    chin_landmark = 8
    chin = vertices[landmarks[chin_landmark]]
    eye_landmarks = slice(36, 48)
    eyes = vertices[landmarks[eye_landmarks], 1].mean()
    edges = [vertices[loop] for loop in boundary_loops(faces)]
    edges = [edge for edge in edges if edge[:, 1].max() < eyes]  # that of a mask goes around it
    ways = [np.roll(edge, -1, axis=0) - edge for edge in edges]
    points, along = (np.vstack([np.empty((0, 3)), *each]) for each in (edges, ways))
    is_level = np.abs(along[:, 1]) < 0.5 * np.linalg.norm(along, axis=1)  # not of a half head
    points = points[is_level & (points[:, 1] < chin[1])]
    if len(points) < 3:
        return None
    up = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2][2]
    up = up * np.sign(up[1]) if abs(up[1]) > 0.5 else np.array([0.0, 1.0, 0.0])
    bottom = float((points @ up).max())
    full_height = 25.0  # [mm] above a neck's edge, at most half the way to the chin
    height = min(full_height, 0.5 * (float(chin @ up) - bottom))
    a, b, c = (up / max(height, 1e-9)).tolist()
    if height <= 0.0:
        return None
    neck = (a, b, c, -bottom / height)
    share = vertices @ np.array(neck[:3]) + neck[3]
    front = float(vertices[share < 1.0, 2].max())
    soft_depth = 8.0  # [mm]
    return neck, (0.0, 0.0, 1.0 / soft_depth, -front / soft_depth)
