"""Points moved by matrices."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from .arrays import Floats64


def moved_points(matrix: npt.NDArray[Any], points: npt.NDArray[Any]) -> Floats64:
    """Points, shape (n, 3), moved by a matrix (4, 4) for column vectors."""
    return np.asarray(points @ matrix[:3, :3].T + matrix[:3, 3])
