"""Points moved by matrices, and the angles of rotations."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from .arrays import Floats64


def moved_points(matrix: npt.NDArray[Any], points: npt.NDArray[Any]) -> Floats64:
    """Points, shape (n, 3), moved by a matrix (4, 4) for column vectors."""
    return np.asarray(points @ matrix[:3, :3].T + matrix[:3, 3])


def angles_of(rotation: npt.NDArray[Any]) -> tuple[float, float, float]:
    """Return yaw, pitch and roll [degrees] of a rotation (3, 3), of any uniform scale.

    The rotation is that of a head with the axes left, up and ahead. Angles grow as it turns to its
    left, up, and to its left shoulder. Roll is applied first and yaw last, as in
    `sim.skull.turn_head`.
    """
    length = float(np.linalg.norm(rotation[:, 2])) or 1.0
    yaw = math.atan2(rotation[0, 2], rotation[2, 2])
    pitch = math.asin(min(max(rotation[1, 2] / length, -1.0), 1.0))
    roll = math.atan2(-rotation[1, 0], rotation[1, 1])
    return math.degrees(yaw), math.degrees(pitch), math.degrees(roll)
